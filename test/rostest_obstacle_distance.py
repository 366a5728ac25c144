#!/usr/bin/python3
"""obstacle_distance, read as mavros' plugin obstacle_distance reads it: [cm], 65535 for what is not known."""

import math
import time
import unittest

import rospy
import rostest
import tf2_ros
from sensor_msgs.msg import LaserScan
from wall_rig import CAMERA, DISPARITY_PX, WallRig, attitude, mounting

FAR_PX = 6  # of disparity: 7 m
NOT_KNOWN = 65535
PATIENCE_S = 30.0  # a loaded machine may need seconds for an answer


def distances(scan):
    """Whole centimetres, rounded down; NaN, infinity and negative ranges are not known."""
    return [int(100.0 * reading) if 0.0 <= 100.0 * reading < NOT_KNOWN else NOT_KNOWN for reading in scan.ranges]


class ObstacleDistance(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_obstacle_distance")
        cls.rig = WallRig(with_tf=False)
        cls.frames = tf2_ros.StaticTransformBroadcaster()
        cls.frames.sendTransform([attitude(), mounting()])
        cls.received = []
        rospy.Subscriber("/mavros/obstacle/send", LaserScan, cls.received.append, queue_size=5)

    def until(self, holds):
        del self.received[:]
        end = time.time() + PATIENCE_S
        while time.time() < end:
            for message in list(self.received):
                if holds(distances(message)):
                    return message
            time.sleep(0.02)
        self.fail("no such scan; the last was %s" % (self.received[-1:],))
        return None

    def test_1_its_bins_are_those_of_mavlink(self):
        scan = self.until(lambda _: True)
        self.assertEqual(len(scan.ranges), 72)
        self.assertEqual(scan.angle_min, 0.0)  # angle_offset: the first bin is ahead
        self.assertAlmostEqual(math.degrees(scan.angle_increment), 5.0, places=5)  # increment, clockwise
        self.assertEqual(scan.header.frame_id, CAMERA + "_scan_frd")
        self.assertEqual(int(100.0 * scan.range_max), 400)  # max_distance
        self.assertEqual(int(100.0 * scan.range_min), 10)  # min_distance

    def test_2_a_near_wall(self):
        self.rig.disparity_px = DISPARITY_PX
        ahead = distances(self.until(lambda bins: bins[0] < 400))
        self.assertTrue(185 <= ahead[0] <= 215, ahead)
        for bin_ in range(10, 63):  # out of view
            self.assertEqual(ahead[bin_], NOT_KNOWN, bin_)
        for right in range(1, 5):  # up to 20 degrees: 200 / cos
            for bin_ in (right, 72 - right):
                self.assertTrue(185 <= ahead[bin_] <= 230, (bin_, ahead))

    def test_3_free_is_a_centimetre_more_than_max_distance(self):
        self.rig.disparity_px = FAR_PX
        ahead = distances(self.until(lambda bins: 400 < bins[0] < NOT_KNOWN))
        self.assertEqual(ahead[0], 401)
        self.assertLessEqual(set(ahead), {401, NOT_KNOWN})

    def test_4_when_the_cameras_stop_nothing_is_known(self):
        self.until(lambda _: True)
        self.rig.disparity_px = 0
        self.until(lambda bins: set(bins) == {NOT_KNOWN})


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "obstacle_distance", ObstacleDistance)
