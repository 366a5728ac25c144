#!/usr/bin/python3
"""Which ways are free before a far and a near wall, and how a wish chooses among them."""

import math
import time
import unittest

import rospy
import rostest
from flight_corridor.msg import FreeAreas
from geometry_msgs.msg import Vector3Stamped
from sensor_msgs.msg import Image
from visualization_msgs.msg import Marker, MarkerArray
from wall_rig import CAMERA, DISPARITY_PX, HEIGHT_PX, WALL_M, WIDTH_PX, WallRig, received

NODE = "/flight_corridor/"
FAR_PX = 6  # of disparity: 7 m
STEP_RAD = 0.0873  # free_areas/step_rad
PATIENCE_S = 30.0  # a loaded machine may need seconds for an answer


class FreeAreasTopics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_free_areas")
        cls.rig = WallRig()
        cls.wish = rospy.Publisher("/goal_direction", Vector3Stamped, queue_size=1)
        cls.newest = {}
        for topic, kind in (("free_areas", FreeAreas), ("free_areas/image", Image),
                            ("free_areas/marker", MarkerArray)):
            rospy.Subscriber(NODE + topic, kind, cls.newest.__setitem__, callback_args=topic, queue_size=1)

    def until(self, holds, topic="free_areas"):
        """The first message that comes from now on and meets a condition."""
        kind = {"free_areas": FreeAreas, "free_areas/image": Image}.get(topic, MarkerArray)
        message = received(NODE + topic, kind, holds, PATIENCE_S)
        self.assertIsNotNone(message, "no such message")
        return message

    def show(self, disparity_px):
        self.rig.disparity_px = disparity_px

    def want(self, x, z, frame=CAMERA):
        message = Vector3Stamped()
        message.header.frame_id = frame
        message.vector.x, message.vector.z = x, z
        end = time.time() + PATIENCE_S
        while self.wish.get_num_connections() == 0 and time.time() < end:
            time.sleep(0.05)
        self.wish.publish(message)

    def test_1_before_a_far_wall_straight_ahead_is_best(self):
        self.show(FAR_PX)
        areas = self.until(lambda message: message.best >= 0)
        count = areas.rows * areas.columns
        self.assertEqual((areas.rows, areas.columns), (5, 13))
        for array in (areas.yaw, areas.pitch, areas.direction, areas.state, areas.clear_distance, areas.safe_speed,
                      areas.reasons):
            self.assertEqual(len(array), count)
        self.assertEqual(areas.header.frame_id, CAMERA)
        self.assertEqual((areas.yaw[areas.best], areas.pitch[areas.best]), (0.0, 0.0))
        self.assertEqual(areas.state[areas.best], FreeAreas.FREE)
        self.assertGreater(areas.safe_speed[areas.best], 1.0)
        self.assertAlmostEqual(areas.goal.z, 1.0)

    def test_2_a_wish_chooses_the_way(self):
        self.show(FAR_PX)
        wanted_rad = 2.0 * STEP_RAD
        self.want(-math.sin(wanted_rad), math.cos(wanted_rad))  # left
        areas = self.until(lambda message: message.best >= 0 and message.goal.x < -0.1)
        self.assertAlmostEqual(areas.yaw[areas.best], wanted_rad, delta=0.6 * STEP_RAD)
        self.want(0.0, 0.0)  # no direction: the last one stays
        self.want(1.0, 0.0, frame="")
        time.sleep(0.5)
        areas = self.until(lambda message: message.best >= 0)
        self.assertAlmostEqual(areas.goal.x, -math.sin(wanted_rad))
        self.want(0.0, 1.0)
        areas = self.until(lambda message: message.best >= 0 and message.goal.x > -1e-6)
        self.assertEqual(areas.yaw[areas.best], 0.0)

    def test_3_before_a_near_wall_ahead_is_blocked_and_slow(self):
        self.show(FAR_PX)
        free = self.until(lambda message: message.best >= 0)
        ahead = free.best
        self.show(DISPARITY_PX)
        areas = self.until(lambda message: message.state[ahead] == FreeAreas.BLOCKED)
        self.assertAlmostEqual(areas.clear_distance[ahead], WALL_M, delta=0.15)
        self.assertLess(areas.safe_speed[ahead], free.safe_speed[ahead])
        self.assertNotIn(FreeAreas.FREE, areas.state)
        self.assertEqual(areas.best, -1)

    def test_4_people_see_it_on_the_image_and_in_rviz(self):
        self.show(FAR_PX)
        image = self.until(lambda _: True, "free_areas/image")
        self.assertEqual((image.width, image.height, image.encoding), (WIDTH_PX, HEIGHT_PX, "bgr8"))
        middle = 3 * (HEIGHT_PX // 2 * WIDTH_PX + WIDTH_PX // 2)
        self.assertNotEqual(len(set(image.data[middle - 300:middle + 300:3])), 1)
        markers = self.until(lambda message: message.markers[1].action == Marker.ADD, "free_areas/marker")
        tiles, best = markers.markers[:2]
        self.assertEqual(tiles.type, Marker.TRIANGLE_LIST)
        self.assertEqual(len(tiles.points), len(tiles.colors))
        self.assertEqual(best.type, Marker.ARROW)

    def test_5_when_the_cameras_stop_nothing_is_known(self):
        self.show(FAR_PX)
        self.until(lambda message: message.best >= 0)
        self.show(0)
        areas = self.until(lambda message: message.reasons[0] & 8)  # NO_DATA
        self.assertEqual(areas.best, -1)
        self.assertEqual(set(areas.state), {FreeAreas.UNKNOWN})
        self.assertEqual(set(areas.safe_speed), {0.0})
        markers = self.until(lambda _: True, "free_areas/marker")
        self.assertEqual({marker.action for marker in markers.markers}, {Marker.DELETE})


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "free_areas", FreeAreasTopics)
