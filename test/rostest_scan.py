#!/usr/bin/python3
"""The level scan of a rig that rolls, and the frame that it is in."""

import math
import time
import unittest

import rospy
import rostest
import tf2_ros
from flight_corridor.msg import CorridorState
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage
from wall_rig import CAMERA, DISPARITY_PX, WALL_M, WallRig, attitude, mounting, received

FAR_PX = 6  # of disparity: 7 m
LENGTH_M = 4.0  # corridor/length_m
ROLL_RAD = 0.2
PATIENCE_S = 30.0  # a loaded machine may need seconds for an answer


class Scan(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_scan")
        cls.rig = WallRig(with_tf=False)
        cls.frames = tf2_ros.StaticTransformBroadcaster()
        cls.broadcast = []
        rospy.Subscriber("/tf", TFMessage, cls.keep_frames, queue_size=10)
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)

    @classmethod
    def keep_frames(cls, message):
        cls.broadcast += [transform.child_frame_id for transform in message.transforms]

    def until(self, holds):
        message = received("/flight_corridor/scan", LaserScan, holds, PATIENCE_S)
        self.assertIsNotNone(message, "no such scan")
        return message

    def broadcast_scans(self):
        return [frame for frame in self.broadcast if "scan" in frame]

    def test_1_nobody_listens_and_nothing_is_broadcast(self):
        time.sleep(2.0)
        self.assertEqual(self.broadcast_scans(), [])

    def test_2_without_an_attitude_nothing_is_known(self):
        self.assertIsNotNone(received("/flight_corridor/corridor", CorridorState,
                                      lambda verdict: verdict.state == CorridorState.BLOCKED, PATIENCE_S))
        scan = self.until(lambda _: True)
        self.assertGreater(len(scan.ranges), 3)
        self.assertTrue(all(math.isnan(reading) for reading in scan.ranges), scan.ranges)
        self.assertEqual(self.broadcast_scans(), [])
        self.frames.sendTransform([attitude(ROLL_RAD), mounting()])

    def test_3_a_far_wall_leaves_the_view_free_and_the_rest_is_none(self):
        self.rig.disparity_px = FAR_PX
        scan = self.until(lambda message: message.ranges[len(message.ranges) // 2] == math.inf)
        self.assertEqual(scan.range_max, LENGTH_M)
        self.assertAlmostEqual(scan.angle_min + (len(scan.ranges) - 1) * scan.angle_increment, scan.angle_max, places=4)
        self.assertAlmostEqual(scan.angle_min, -scan.angle_max, places=4)
        for reading in scan.ranges:
            self.assertTrue(math.isnan(reading) or reading == math.inf, scan.ranges)

    def test_4_a_near_wall_is_as_far_as_it_is(self):
        self.rig.disparity_px = DISPARITY_PX
        scan = self.until(lambda message: math.isfinite(message.ranges[len(message.ranges) // 2]))
        self.assertAlmostEqual(scan.ranges[len(scan.ranges) // 2], WALL_M, delta=0.15)
        for i, reading in enumerate(scan.ranges):
            if math.isfinite(reading):
                yaw = scan.angle_min + i * scan.angle_increment
                # The wall's nearest part within a step that is this wide.
                nearest = WALL_M / math.cos(max(0.0, abs(yaw) - 0.5 * scan.angle_increment))
                self.assertGreater(reading, nearest - 0.35, i)
                self.assertLess(reading, WALL_M / math.cos(yaw) + 0.35, i)

    def test_5_its_frame_is_level_while_the_camera_rolls(self):
        scan = self.until(lambda _: True)
        self.assertEqual(scan.header.frame_id, CAMERA + "_scan")
        for frame, up in ((scan.header.frame_id, 1.0), (scan.header.frame_id + "_frd", -1.0)):
            turn = self.buffer.lookup_transform("odom", frame, scan.header.stamp,
                                                rospy.Duration(PATIENCE_S)).transform.rotation
            self.assertAlmostEqual(1.0 - 2.0 * (turn.x ** 2 + turn.y ** 2), up, places=4)  # z in odom
        turn = self.buffer.lookup_transform("odom", CAMERA, rospy.Time(0)).transform.rotation
        self.assertAlmostEqual(abs(2.0 * (turn.x * turn.z - turn.y * turn.w)), math.sin(ROLL_RAD), places=4)  # its x

    def test_6_when_the_cameras_stop_nothing_is_known(self):
        self.until(lambda _: True)
        self.rig.disparity_px = 0
        scan = self.until(lambda message: all(math.isnan(reading) for reading in message.ranges))
        self.assertGreater(len(scan.ranges), 3)


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "scan", Scan)
