#!/usr/bin/python3
"""What changes in flight is effective in the next verdict; what breaks a rule changes nothing."""

import math
import os
import subprocess
import time
import unittest

import rospkg
import rospy
import rostest
import yaml
from dynamic_reconfigure.client import Client
from flight_corridor.msg import CorridorState
from sensor_msgs.msg import LaserScan
from wall_rig import WallRig, received

NODE = "/flight_corridor"
BEYOND_WALL_M, BEFORE_WALL_M = 4.0, 1.5
PATIENCE_S = 30.0  # a loaded machine may need seconds for an answer


def keys(tree, prefix=""):
    if not isinstance(tree, dict):
        return {prefix}
    return {key for name, child in tree.items() for key in keys(child, prefix + "/" + name)}


def dump():
    done = subprocess.run(["rosparam", "dump", "/dev/stdout", NODE], stdout=subprocess.PIPE, text=True, check=True)
    return yaml.safe_load(done.stdout)


class Reconfigure(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_reconfigure")
        cls.rig = WallRig()
        cls.client = Client(NODE, timeout=PATIENCE_S)

    def expect(self, length_m, state):
        """The next verdict is on this box; within corridor/hold_s, and the time of a start, it has this state."""
        end = time.time() + PATIENCE_S
        while time.time() < end:
            verdict = rospy.wait_for_message(NODE + "/corridor", CorridorState, PATIENCE_S)
            self.assertAlmostEqual(verdict.box.x, length_m)
            if verdict.state == state:
                return
        self.fail("no such verdict: %s" % verdict)

    def test_a_change_takes_effect(self):
        self.client.update_configuration({"corridor/length_m": BEYOND_WALL_M})
        self.expect(BEYOND_WALL_M, CorridorState.BLOCKED)
        answer = self.client.update_configuration({"corridor/length_m": BEFORE_WALL_M})
        self.assertEqual(answer["corridor/length_m"], BEFORE_WALL_M)
        self.expect(BEFORE_WALL_M, CorridorState.FREE)
        self.assertEqual(dump()["corridor"]["length_m"], BEFORE_WALL_M)

    def test_a_refused_change_changes_nothing(self):
        self.client.update_configuration({"corridor/length_m": BEYOND_WALL_M})
        before = dump()
        answer = self.client.update_configuration({"corridor/length_m": 3.0, "corridor/hold_s": 99.0})
        self.assertEqual(answer["corridor/length_m"], BEYOND_WALL_M)
        self.assertEqual(dump(), before)
        self.expect(BEYOND_WALL_M, CorridorState.BLOCKED)

    def test_scans_of_nothing_are_as_long_as_the_corridor(self):
        self.client.update_configuration({"corridor/length_m": BEFORE_WALL_M})
        scan = received(NODE + "/scan", LaserScan, lambda message: message.range_max == BEFORE_WALL_M, PATIENCE_S)
        self.assertIsNotNone(scan, "no such scan")
        self.assertTrue(all(map(math.isnan, scan.ranges)), "nobody says where up is")

    def test_the_dump_holds_every_parameter(self):
        path = os.path.join(rospkg.RosPack().get_path("flight_corridor"), "config", "default.yaml")
        with open(path, encoding="utf-8") as file:
            self.assertEqual(keys(dump()), keys(yaml.safe_load(file)))


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "reconfigure", Reconfigure)
