#!/usr/bin/python3
"""Plays a simulated flight at a wall into the node and compares its verdicts with the truth."""

import csv
import math
import os
import subprocess
import tempfile
import time
import unittest

import rospy
import rostest
from flight_corridor.msg import CorridorState
from std_msgs.msg import Bool

LENGTH_M = 4.0  # corridor/length_m
# The verdict may be off by one voxel and 3 % of range; within that of D_min either answer is right.
BAND_M = 0.1 + 0.03 * LENGTH_M
SPEED_M_S = 0.9  # of the slowest flight at the wall: how far beyond the box it is, is not in the truth
RATE = "0.5"  # of playing: leaves a loaded machine time to answer most frames


class Flight(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_flight")
        cls.verdicts, cls.free = {}, None
        rospy.Subscriber("/flight_corridor/corridor", CorridorState, cls.keep, queue_size=100)
        rospy.Subscriber("/flight_corridor/free", Bool, cls.keep_free, queue_size=100)
        with tempfile.TemporaryDirectory() as folder:
            bag, truth = os.path.join(folder, "flight.bag"), os.path.join(folder, "truth.csv")
            subprocess.run(["rosrun", "flight_corridor", "simulate", "--scene", "wall", "--seed", "1", "--out", bag,
                            "--truth", truth], check=True)
            with open(truth, newline="") as table:
                cls.truth = list(csv.DictReader(table))
            subprocess.run(["rosrun", "rosbag", "play", "--clock", "--quiet", "--delay", "3", "--rate", RATE, bag],
                           check=True)
        time.sleep(2.0)  # wall time: the watchdog must speak although /clock stands still
        cls.last, cls.last_free = cls.newest, cls.free

    @classmethod
    def keep(cls, message):
        cls.newest = message
        if not message.reasons & CorridorState.NO_DATA:
            cls.verdicts[message.header.stamp.to_nsec()] = message

    @classmethod
    def keep_free(cls, message):
        cls.free = message.data

    def answers(self, rows):
        """States that the node gave to these frames of the truth."""
        stamps = [rospy.Time(*map(int, row["stamp"].split("."))).to_nsec() for row in rows]
        self.assertTrue(stamps, "the flight has no such frame")
        states = [self.verdicts[stamp].state for stamp in stamps if stamp in self.verdicts]
        self.assertGreaterEqual(len(states), 10, "%d of %d frames answered" % (len(states), len(stamps)))
        return states

    def test_far_from_the_wall_the_corridor_is_free(self):
        reached_s = min(float(row["stamp"]) for row in self.truth if math.isfinite(float(row["clear_inflated"])))
        states = self.answers([row for row in self.truth if float(row["stamp"]) < reached_s - BAND_M / SPEED_M_S])
        self.assertNotIn(CorridorState.BLOCKED, states)
        self.assertGreaterEqual(states.count(CorridorState.FREE), 0.9 * len(states))

    def test_within_the_corridors_length_the_wall_blocks(self):
        states = self.answers([row for row in self.truth if float(row["clear_shrunk"]) < LENGTH_M - BAND_M])
        self.assertNotIn(CorridorState.FREE, states)
        self.assertGreaterEqual(states.count(CorridorState.BLOCKED), 0.9 * len(states))

    def test_after_the_end_nothing_is_known(self):
        self.assertEqual(self.last.state, CorridorState.UNKNOWN)
        self.assertEqual(self.last.reasons, CorridorState.NO_DATA)
        self.assertFalse(self.last_free)


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "flight", Flight)
