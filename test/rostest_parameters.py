#!/usr/bin/python3
"""Parameters reach the node typed by way of the parameter server; a wrong one stops it with its name."""

import math
import os
import subprocess
import unittest

import rosparam
import rospkg
import rospy
import rostest

NODE = "/parameters_under_test"
PACKAGE = rospkg.RosPack().get_path("flight_corridor")


def start(parameters):
    """Exit code (None: still running after 3 s) and output of a node with these private parameters."""
    if rospy.has_param(NODE):
        rospy.delete_param(NODE)
    for key, value in parameters.items():
        rospy.set_param(NODE + "/" + key, value)
    command = ["rosrun", "flight_corridor", "corridor_node", "__name:=" + NODE[1:]]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        output, _ = process.communicate(timeout=3)
        return process.returncode, output
    except subprocess.TimeoutExpired:
        process.terminate()
        return None, process.communicate()[0]


class Parameters(unittest.TestCase):
    def test_defaults_start(self):
        code, output = start({})
        self.assertIsNone(code, output)

    def test_shipped_files_start(self):
        for name in ["default.yaml", "paper.yaml"]:
            (tree, _), = rosparam.load_file(os.path.join(PACKAGE, "config", name))
            code, output = start(tree)
            self.assertIsNone(code, output)

    def test_good_values_of_every_type_start(self):
        code, output = start({"corridor/length_m": 3, "map/frame_id": "odom", "scale/enabled": False,
                              "corridor/offset_m": [0.1, 0, 0], "fusion/gate_sigma": math.inf})
        self.assertIsNone(code, output)

    def test_every_wrong_one_is_named(self):
        code, output = start({"corridor/wdith_m": 1.0, "ros/sync_queue": 2.5, "corridor/length_m": -1,
                              "corridor/offset_m": [1, "two", 3]})
        self.assertEqual(code, 1, output)
        self.assertIn("corridor/wdith_m: unknown key (1", output)
        self.assertIn("ros/sync_queue: expects an integer (2.5)", output)
        self.assertIn("corridor/length_m: ", output)
        self.assertIn("corridor/offset_m: expects a list of three numbers", output)

    def test_a_mask_that_is_no_image_is_named(self):
        code, output = start({"stereo/mask": "/nowhere/mask.png"})
        self.assertEqual(code, 1, output)
        self.assertIn("stereo/mask: no readable image (/nowhere/mask.png)", output)


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "parameters", Parameters)
