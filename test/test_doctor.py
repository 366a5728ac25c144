#!/usr/bin/python3
"""Each finding of the doctor is made where it should be, and not on a healthy system."""

import os
import sys
import unittest
from types import SimpleNamespace

import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "scripts"))
from doctor_findings import Observation, Topic, examine  # noqa: E402

OTHERS = "/free", "/free_areas", "/obstacle_distance", "/scan"
STAMPS = [10.0 + 0.1 * i for i in range(50)]


def heard(name, message, delay_s=0.05, **changes):
    fields = {"publishers": ["/camera"], "listeners": ["/planner"], "stamps": list(STAMPS),
              "arrivals": [stamp + delay_s for stamp in STAMPS], "last": message, **changes}
    return Topic(name, **fields)


def message(frame, **fields):
    return SimpleNamespace(header=SimpleNamespace(frame_id=frame), **fields)


def info(shift):
    return message("left", width=640, height=480, P=[350.0, 0, 319.5, shift, 0, 350.0, 239.5, 0, 0, 0, 1, 0])


def healthy():
    image = message("left", width=640, height=480)
    return Observation(5.0, node="/flight_corridor", left=heard("/left", image), right=heard("/right", image),
                       left_info=heard("/left_info", info(0.0)), right_info=heard("/right_info", info(-42.0)),
                       lidar=heard("/range", message("lidar")), verdict=heard("/corridor", None),
                       others=[Topic(name, ["/flight_corridor"], ["/planner"]) for name in OTHERS], reasons=[("FREE", set())] * 50, ranges=[(4.0, 0.2, 40.0)] * 50,
                       frames=[("base", "left"), ("base", "lidar")])


class Doctor(unittest.TestCase):
    def finds(self, seen, *parts):
        sentences = examine(seen)
        self.assertEqual(len(sentences), 1, sentences)
        for part in parts:
            self.assertIn(part, sentences[0])

    def test_a_healthy_system_has_no_finding(self):
        self.assertEqual(examine(healthy()), [])

    def test_a_system_without_a_lidar_has_no_finding(self):
        seen = healthy()
        seen.lidar, seen.ranges = Topic("/range"), []
        self.assertEqual(examine(seen), [])

    def test_no_node_publishes_a_verdict(self):
        self.finds(Observation(5.0), "No node publishes a verdict")

    def test_nobody_publishes_the_right_image(self):
        seen = healthy()
        seen.right = Topic("/right")
        self.finds(seen, "Nobody publishes /right")

    def test_a_camera_is_silent(self):
        seen = healthy()
        seen.right = Topic("/right", publishers=["/camera"])
        self.finds(seen, "/right is announced by /camera, but nothing came")

    def test_stamps_of_a_pair_differ(self):
        seen = healthy()
        seen.right.stamps = seen.right_info.stamps = [stamp + 0.004 for stamp in STAMPS]
        self.finds(seen, "4.0 ms apart", "ros/approximate_sync")
        seen.parameters = {"ros/approximate_sync": True, "ros/sync_slop_s": 0.01}
        self.assertEqual(examine(seen), [])

    def test_a_camera_info_has_another_stamp_than_its_image(self):
        seen = healthy()
        seen.right_info.stamps = [stamp + 0.02 for stamp in STAMPS]
        self.finds(seen, "/right_info is stamped 20.0 ms from /right", "ros/approximate_sync")
        seen.parameters = {"ros/approximate_sync": True, "ros/sync_slop_s": 0.03}
        self.assertEqual(examine(seen), [])

    def test_a_camera_info_comes_once_in_a_while(self):
        seen = healthy()
        seen.left_info.stamps = [STAMPS[0] - 7.0]
        self.finds(seen, "/left_info is stamped", "from /left")

    def test_a_camera_info_has_no_stamp(self):
        seen = healthy()
        seen.left_info.stamps = [0.0] * len(STAMPS)
        self.finds(seen, "/left_info has no stamp (0)", "raw_stereo.launch")
        seen.parameters = {"ros/approximate_sync": True}
        self.finds(seen, "/left_info has no stamp (0)")

    def test_more_camera_infos_than_images_are_well(self):
        seen = healthy()
        seen.left_info.stamps = sorted(STAMPS + [stamp + 0.05 for stamp in STAMPS])
        self.assertEqual(examine(seen), [])

    def test_a_camera_is_not_calibrated(self):
        seen = healthy()
        seen.left_info.last.P[0] = 0.0
        self.finds(seen, "/left_info has no projection matrix")

    def test_left_and_right_are_exchanged(self):
        seen = healthy()
        seen.left_info.last, seen.right_info.last = seen.right_info.last, seen.left_info.last
        self.finds(seen, "The baseline is not positive")

    def test_image_and_calibration_differ_in_size(self):
        seen = healthy()
        seen.left_info.last.width = 1280
        self.finds(seen, "/left is 640x480 px, /left_info says 1280x480")

    def test_tf_lacks_the_lidars_frame(self):
        seen = healthy()
        seen.frames = [("base", "left")]
        self.finds(seen, "\"left\" with \"lidar\" (the LiDAR's frame)")

    def test_tf_lacks_a_frame_that_the_configuration_names(self):
        for key in ("map/frame_id", "corridor/frame_id"):
            seen = healthy()
            seen.parameters = {key: "odom"}
            self.finds(seen, "\"odom\" (%s)" % key)

    def test_the_simulated_clock_stands_still(self):
        seen = healthy()
        seen.use_sim_time, seen.clock_ticks = True, False
        self.finds(seen, "/clock does not tick")

    def test_images_come_old_or_from_the_future(self):
        for delay_s in (0.8, -0.8):
            seen = healthy()
            seen.left.arrivals = [stamp + delay_s for stamp in STAMPS]
            self.finds(seen, "/left is " + ("0.800 s old" if delay_s > 0.0 else "stamped 0.800 s ahead of the clock"),
                       "synchronise the clocks")

    def test_a_cameras_clock_is_an_hour_ahead(self):
        seen = healthy()
        seen.right.arrivals = [stamp - 3600.0 for stamp in STAMPS]
        self.finds(seen, "/right is stamped 3600.000 s (1.0 h) ahead of the clock")

    def test_images_come_too_seldom(self):
        seen = healthy()
        seen.left.stamps, seen.left.arrivals, seen.reasons = STAMPS[::5], STAMPS[::5], seen.reasons[::5]
        self.finds(seen, "Images come at 2.0 Hz, less than 4.0 Hz")

    def test_the_node_answers_too_few_images(self):
        seen = healthy()
        seen.reasons = seen.reasons[:20]
        self.finds(seen, "answers 20 of 50 images")

    def test_the_lidar_is_silent(self):
        seen = healthy()
        seen.lidar, seen.ranges = Topic("/range", publishers=["/lidar"]), []
        self.finds(seen, "/range is announced by /lidar, but nothing came")

    def test_every_reading_of_the_lidar_is_refused(self):
        seen = healthy()
        seen.ranges = [(4000.0, 0.2, 40.0)] * 50
        self.finds(seen, "Every LiDAR reading is refused", "4000 m")

    def test_nobody_listens_to_the_verdict(self):
        seen = healthy()
        seen.verdict.listeners = []
        for topic in seen.others:
            topic.listeners = []
        self.finds(seen, "Nobody listens to /corridor, /free, /free_areas, /obstacle_distance, /scan: ")
        for topic in seen.others:
            topic.listeners = ["/autopilot"]
            self.assertEqual(examine(seen), [])
            topic.listeners = []

    def test_the_guard_waits_for_commands_or_speaks_to_nobody(self):
        seen = healthy()
        seen.commands_in = [Topic("/cmd_vel_in", ["/planner"], ["/corridor_guard"])]
        seen.commands_out = [Topic("/cmd_vel", ["/corridor_guard"], ["/mavros"])]
        self.assertEqual(examine(seen), [])
        seen.commands_in[0].publishers = []
        self.finds(seen, "Nobody publishes /cmd_vel_in, which /corridor_guard waits for")
        seen.commands_in[0].publishers, seen.commands_out[0].listeners = ["/planner"], []
        self.finds(seen, "Nobody listens to /cmd_vel from /corridor_guard: it stops nobody")

    def test_somebody_else_sends_to_the_autopilot(self):
        seen = healthy()
        seen.commands_out = [Topic("/cmd_vel", ["/corridor_guard", "/joystick"], ["/mavros"])]
        self.finds(seen, "/cmd_vel has 2 senders, /corridor_guard, /joystick: what passes by corridor_guard")

    def test_tf_lacks_the_goals_frame(self):
        seen = healthy()
        seen.goal = heard("/goal_direction", message("odom"))
        self.finds(seen, "goal_direction's frame")

    def test_most_verdicts_are_unknown(self):
        seen = healthy()
        seen.reasons = [("UNKNOWN", {"NO_DISPARITY", "NO_LIDAR"})] * 50
        self.finds(seen, "50 of 50 verdicts are UNKNOWN, 50 with NO_DISPARITY", "texture")


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "doctor_findings", Doctor)
