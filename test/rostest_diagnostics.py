#!/usr/bin/python3
"""The node's state comes in four groups, each with a level of its own."""

import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from wall_rig import WallRig

PATIENCE_S = 30.0  # a loaded machine may need seconds for a first answer
GROUPS = {"images", "LiDAR", "corridor", "time"}


class Diagnostics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_diagnostics")
        cls.analyzer = rospy.get_param("/aggregator/analyzers/flight_corridor")

    def wait_for(self, levels):
        """The groups by name, once they have these levels."""
        end = time.time() + PATIENCE_S
        while time.time() < end:
            array = rospy.wait_for_message("/diagnostics", DiagnosticArray, PATIENCE_S)
            groups = {status.name: status for status in array.status}
            prefix = self.analyzer["find_and_remove_prefix"]
            groups = {name[len(prefix):]: status for name, status in groups.items() if name.startswith(prefix)}
            if {name: status.level for name, status in groups.items()} == levels:
                return groups
        self.fail("never so: %s" % groups)

    def test_1_without_images_there_is_an_error_but_not_of_the_lidar(self):
        self.assertEqual(self.analyzer["num_items"], len(GROUPS))
        groups = self.wait_for({"images": DiagnosticStatus.ERROR, "LiDAR": DiagnosticStatus.OK,
                                "corridor": DiagnosticStatus.ERROR, "time": DiagnosticStatus.OK})
        self.assertEqual(groups["images"].message, "no stereo pair")
        self.assertEqual(groups["corridor"].message, "no verdict")

    def test_2_before_a_wall_all_is_well(self):
        rig = WallRig()
        groups = self.wait_for(dict.fromkeys(GROUPS, DiagnosticStatus.OK))
        rig.timer.shutdown()
        self.assertEqual(groups["corridor"].message, "BLOCKED")
        values = {pair.key: float(pair.value) for pair in groups["images"].values}
        self.assertGreater(values["pairs in [Hz]"], 0.0)
        self.assertEqual(values["pairs refused"], 0.0)

    def test_3_when_images_stop_there_is_an_error_again(self):
        self.wait_for({"images": DiagnosticStatus.ERROR, "LiDAR": DiagnosticStatus.WARN,
                       "corridor": DiagnosticStatus.ERROR, "time": DiagnosticStatus.OK})


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "diagnostics", Diagnostics)
