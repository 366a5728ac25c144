"""A rig before a wall, for rostests: stereo pair, calibration, LiDAR and tf in wall time."""

import math
import time

import numpy
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped
from sensor_msgs.msg import CameraInfo, Image, Range

WIDTH_PX, HEIGHT_PX, DISPARITY_PX = 640, 480, 21
FOCAL_PX, BASELINE_M = 350.0, 0.12
WALL_M = FOCAL_PX * BASELINE_M / DISPARITY_PX  # 2 m
PERIOD_S = 0.1
CAMERA, LIDAR = "left_camera_optical", "range_link"


class WallRig:
    """self.disparity_px says how far away the wall is: FOCAL_PX * BASELINE_M / disparity; 0 or less: nothing is sent."""

    def __init__(self, with_tf=True, period_s=PERIOD_S):
        self.disparity_px = DISPARITY_PX
        self.publishers = {name: rospy.Publisher(name, kind, queue_size=2) for name, kind in (
            ("/stereo/left/image_rect", Image), ("/stereo/right/image_rect", Image),
            ("/stereo/left/camera_info", CameraInfo), ("/stereo/right/camera_info", CameraInfo), ("/range", Range))}
        self.random = numpy.random.RandomState(1)
        self.frames = tf2_ros.StaticTransformBroadcaster()
        if with_tf:
            self.publish_mounting()
        self.timer = rospy.Timer(rospy.Duration(period_s), self.publish)

    def publish_mounting(self):
        self.frames.sendTransform(mounting())

    def publish(self, _):
        disparity_px = self.disparity_px
        if disparity_px <= 0:
            return
        stamp = rospy.Time.now()
        # Noise of each image: equal ones would be a frozen camera.
        wall = texture(self.random)
        for side, begin_px, baseline_m in (("left", 0, 0.0), ("right", disparity_px, BASELINE_M)):
            pixels = wall[:, begin_px:begin_px + WIDTH_PX]
            self.send("/stereo/%s/image_rect" % side, image(pixels), stamp, CAMERA)
            self.send("/stereo/%s/camera_info" % side, calibration(baseline_m), stamp, CAMERA)
        reading = Range(field_of_view=0.01, min_range=0.2, max_range=40.0, range=FOCAL_PX * BASELINE_M / disparity_px)
        self.send("/range", reading, stamp, LIDAR)

    def send(self, topic, message, stamp, frame):
        message.header.stamp, message.header.frame_id = stamp, frame
        self.publishers[topic].publish(message)


def texture(random):
    return random.randint(0, 256, (HEIGHT_PX, WIDTH_PX + DISPARITY_PX), numpy.uint8)


def image(pixels):
    return Image(height=HEIGHT_PX, width=WIDTH_PX, encoding="mono8", step=WIDTH_PX, data=pixels.tobytes())


def calibration(baseline_m):
    info = CameraInfo(height=HEIGHT_PX, width=WIDTH_PX, distortion_model="plumb_bob", D=[0.0] * 5)
    info.P = [FOCAL_PX, 0, WIDTH_PX / 2 - 0.5, -FOCAL_PX * baseline_m, 0, FOCAL_PX, HEIGHT_PX / 2 - 0.5, 0, 0, 0, 1, 0]
    info.K = [info.P[i] for i in (0, 1, 2, 4, 5, 6, 8, 9, 10)]
    info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    return info


def mounting():
    """The LiDAR in the left camera, its beam (x) along the optical axis (z)."""
    edge = TransformStamped(child_frame_id=LIDAR)
    edge.header.frame_id = CAMERA
    edge.transform.rotation.x, edge.transform.rotation.y = 0.5, -0.5
    edge.transform.rotation.z, edge.transform.rotation.w = 0.5, 0.5
    return edge


def attitude(roll_rad=0.0):
    """The camera in odom: it looks along x, rolled about its optical axis."""
    edge = TransformStamped(child_frame_id=CAMERA)
    edge.header.frame_id = "odom"
    sine, cosine = 0.5 * math.sin(roll_rad / 2.0), 0.5 * math.cos(roll_rad / 2.0)
    edge.transform.rotation = Quaternion(sine - cosine, sine + cosine, sine - cosine, sine + cosine)
    return edge


def received(topic, kind, holds, patience_s):
    """The first message of a topic that fulfils a condition; None if none did in time."""
    messages = []
    subscriber = rospy.Subscriber(topic, kind, messages.append, queue_size=5)
    end = time.time() + patience_s
    try:
        while time.time() < end:
            for message in list(messages):
                if holds(message):
                    return message
            time.sleep(0.02)
        return None
    finally:
        subscriber.unregister()
