#!/usr/bin/python3
"""The doctor calls a healthy system, flown by the guard alone, well; it names a missing frame, and who is not heard."""

import os
import subprocess
import time
import unittest

import rospy
import rostest
from flight_corridor.msg import CorridorState
from geometry_msgs.msg import Twist
from wall_rig import CAMERA, LIDAR, WallRig

PATIENCE_S = 30.0  # a loaded machine may need seconds for a first answer


def examine(*arguments, namespace="/"):
    """Exit code and output of the doctor."""
    done = subprocess.run(["rosrun", "flight_corridor", "doctor", "--seconds", "4", *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False,
                          env={**os.environ, "ROS_NAMESPACE": namespace})
    return done.returncode, done.stdout


class Doctor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_doctor")
        cls.planner = rospy.Publisher("/cmd_vel_in", Twist, queue_size=1)
        cls.autopilot = rospy.Subscriber("/cmd_vel", Twist, lambda _: None)
        cls.rig = WallRig(with_tf=False, period_s=0.2)  # slow enough for a machine with other tests
        end = time.time() + PATIENCE_S
        while time.time() < end:
            if rospy.wait_for_message("/flight_corridor/corridor", CorridorState).state != CorridorState.UNKNOWN:
                return
        raise AssertionError("the node gives no verdict")

    def test_1_a_missing_transform_is_named(self):
        code, output = examine()
        self.assertEqual(code, 1, output)
        self.assertIn("tf does not connect the camera's frame \"%s\" with \"%s\"" % (CAMERA, LIDAR), output)
        self.assertIn("Findings: 1.", output)

    def test_2_a_healthy_system_is_well(self):
        self.rig.publish_mounting()
        code, output = examine()
        self.assertEqual(code, 0, output)
        self.assertIn("All is well.", output)
        for arguments in ([], ["--node", "flight_corridor"]):
            code, output = examine(*arguments, namespace="/uav2")
            self.assertIn("No node publishes a verdict", output)
        code, output = examine("--node", "/flight_corridor", namespace="/uav2")
        self.assertIn("/flight_corridor/corridor ", output)

    def test_3_another_sender_to_the_autopilot_is_named(self):
        other = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        code, output = examine()
        other.unregister()
        self.assertEqual(code, 1, output)
        self.assertIn("/cmd_vel has 2 senders, /corridor_guard, %s" % rospy.get_name(), output)
        self.assertIn("Findings: 1.", output)

    def test_4_a_guard_that_nobody_obeys_is_named(self):
        self.autopilot.unregister()
        code, output = examine()
        self.assertEqual(code, 1, output)
        self.assertIn("Nobody listens to /cmd_vel from /corridor_guard", output)
        self.assertIn("Findings: 1.", output)


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "doctor", Doctor)
