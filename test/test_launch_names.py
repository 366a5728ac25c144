#!/usr/bin/python3
"""In a UAV's namespace every launch file keeps to that namespace; what dies is started again; the projectors' arguments."""

import os
import unittest

import roslaunch
import rosunit

FOLDER = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "launch")
NAMESPACE = "/uav1/"
GLOBAL = {"/use_sim_time"}                                                # roscpp reads it there alone
NEEDED = {"demo": ["bag:=flight.bag"], "range_serial": ["protocol:=tfmini"]}
ALL_PARTS = {"corridor": ["lidar_pose:=0 0 0 0 0 0"],
             "raw_stereo": ["left_calibration:=left.yaml", "right_calibration:=right.yaml"]}
SESSION = {"player", "rviz", "flight_corridor_rviz"}                      # for people: not started again


def load(name, *arguments):
    """A launch file as roslaunch reads it with ROS_NAMESPACE set."""
    loader, config = roslaunch.xmlloader.XmlLoader(), roslaunch.config.ROSLaunchConfig()
    os.environ["ROS_NAMESPACE"] = NAMESPACE
    try:
        loader.load(os.path.join(FOLDER, name + ".launch"), config, verbose=False, argv=list(arguments))
    finally:
        del os.environ["ROS_NAMESPACE"]
    return config


def names_of(node):
    """What a node's names are remapped to, and the manager that it is loaded into."""
    words = node.args.split()
    return [to for _, to in node.remap_args] + (words[2:3] if words[:1] == ["load"] else [])


class LaunchNames(unittest.TestCase):
    def every_file(self):
        names = sorted(entry[:-len(".launch")] for entry in os.listdir(FOLDER))
        self.assertGreater(len(names), 10)
        for name in names:
            yield name, load(name, *NEEDED.get(name, []), *ALL_PARTS.get(name, []))

    def test_every_name_is_in_the_namespace(self):
        for name, config in self.every_file():
            for node in config.nodes:
                self.assertTrue(node.namespace.startswith(NAMESPACE), (name, node.name))
                self.assertEqual([to for to in names_of(node) if to.startswith("/")], [], (name, node.name))
            strangers = {key for key in config.params if not key.startswith(NAMESPACE)}
            self.assertLessEqual(strangers, GLOBAL, name)

    def test_nodelets_are_loaded_from_their_managers_namespace(self):
        nodes = load("raw_stereo", *ALL_PARTS["raw_stereo"]).nodes
        loaders = [node for node in nodes if node.args.startswith("load")]
        self.assertEqual(len(loaders), 7)
        for node in loaders:
            self.assertEqual((node.namespace, node.args.split()[2]), (NAMESPACE, "stereo_manager"), node.name)

    def test_what_dies_is_started_again(self):
        for name, config in self.every_file():
            mortal = {node.name for node in config.nodes if not (node.respawn and node.respawn_delay > 0.0)}
            self.assertLessEqual(mortal, SESSION, name)

    def test_the_simulated_clock_is_everybodys(self):
        for name in ("demo", "euroc"):
            self.assertIs(load(name, *NEEDED.get(name, [])).params["/use_sim_time"].value, True)

    def test_the_guard_listens_to_the_node_beside_it(self):
        for name in ("px4", "ardupilot", "move_base"):
            guard = [node for node in load(name, "name:=mine").nodes if node.type == "corridor_guard"][0]
            self.assertEqual(dict(guard.remap_args)["free_areas"], "mine/free_areas", name)
            self.assertEqual(dict(guard.remap_args)["corridor"], "mine/corridor", name)

    def test_projectors(self):
        def values(name, projector, *keys):
            params = load(name, "projector:=" + projector).params
            return [params[NAMESPACE + key].value for key in keys]
        realsense = ["camera/stereo_module/emitter_enabled", "camera/stereo_module/emitter_on_off"]
        self.assertEqual(values("realsense", "off", *realsense), [0, False])
        self.assertEqual(values("realsense", "on", *realsense), [1, False])
        self.assertEqual(values("realsense", "alternate", *realsense), [1, True])
        self.assertEqual(values("oakd", "off", "oak/camera_i_laser_dot_brightness"), [0])
        self.assertEqual(values("oakd", "on", "oak/camera_i_laser_dot_brightness"), [800])
        for name, projector in (("oakd", "alternate"), ("oakd", "bright"), ("realsense", "bright")):
            with self.assertRaisesRegex(roslaunch.xmlloader.XmlParseException, projector):
                load(name, "projector:=" + projector)
        for name, key in (("realsense", realsense[0]), ("oakd", "oak/camera_i_laser_dot_brightness")):
            self.assertEqual(load(name).params[NAMESPACE + key].value, 0, name)


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "launch_names", LaunchNames)
