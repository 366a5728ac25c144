#!/usr/bin/python3
"""Of two UAVs on one master each guard obeys its own verdicts and commands only, and comes back when it dies."""

import threading
import time
import unittest

import rosnode
import rospy
import rostest
from flight_corridor.msg import CorridorState, FreeAreas
from geometry_msgs.msg import Twist

STEP_S = 0.05
PATIENCE_S = 30.0  # a loaded machine may need seconds for an answer
NAMES = "uav1", "uav2"


class Uav:
    """What a UAV's guard hears, and what it says."""

    def __init__(self, name):
        self.areas = rospy.Publisher("/%s/flight_corridor/free_areas" % name, FreeAreas, queue_size=1)
        self.corridor = rospy.Publisher("/%s/flight_corridor/corridor" % name, CorridorState, queue_size=1)
        self.commands = rospy.Publisher("/%s/cmd_vel_in" % name, Twist, queue_size=1)
        self.state, self.safe_mps, self.commanded_mps, self.yaw_rate = FreeAreas.FREE, 1.5, 1.0, 0.0
        self.out, self.out_count = None, 0
        rospy.Subscriber("/%s/cmd_vel" % name, Twist, self.keep, queue_size=1)

    def keep(self, twist):
        self.out, self.out_count = twist, self.out_count + 1

    def step(self):
        areas = FreeAreas(rows=1, columns=3, yaw=[-0.1, 0.0, 0.1], pitch=[0.0] * 3, state=[self.state] * 3,
                          clear_distance=[4.0] * 3, safe_speed=[self.safe_mps] * 3, reasons=[0] * 3)
        verdict = CorridorState(state=self.state, safe_speed=self.safe_mps)
        areas.header.stamp = verdict.header.stamp = rospy.Time.now()
        self.areas.publish(areas)
        self.corridor.publish(verdict)
        command = Twist()
        command.linear.x, command.angular.z = self.commanded_mps, self.yaw_rate
        self.commands.publish(command)


class TwoUavs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_two_uavs")
        cls.uavs = [Uav(name) for name in NAMES]
        cls.ended = threading.Event()
        threading.Thread(target=cls.run_uavs, daemon=True).start()

    @classmethod
    def tearDownClass(cls):
        cls.ended.set()

    @classmethod
    def run_uavs(cls):
        while not cls.ended.wait(STEP_S):
            for uav in cls.uavs:
                uav.step()

    def until(self, holds, what):
        end = time.time() + PATIENCE_S
        while time.time() < end:
            time.sleep(STEP_S)
            if all(uav.out for uav in self.uavs) and holds():
                return
        self.fail("%s; the last commands were %s" % (what, [str(uav.out) for uav in self.uavs]))

    def goes_out(self, *speeds_mps):
        self.until(lambda: all(abs(uav.out.linear.x - speed_mps) < 1e-6 for uav, speed_mps in zip(self.uavs, speeds_mps)),
                   "expected %s m/s" % (speeds_mps,))

    def stays(self, *speeds_mps):
        """For half a second: a foreign verdict that is obeyed now and then is seen."""
        self.goes_out(*speeds_mps)
        end = time.time() + 0.5
        while time.time() < end:
            time.sleep(0.01)
            for uav, speed_mps in zip(self.uavs, speeds_mps):
                self.assertLess(uav.out.linear.x, speed_mps + 1e-6)

    def test_1_each_obeys_its_own_verdicts_and_commands(self):
        one, two = self.uavs
        for fast, slow in ((one, two), (two, one)):
            fast.state, fast.commanded_mps, fast.yaw_rate = FreeAreas.FREE, 1.0, 0.0
            slow.state, slow.commanded_mps, slow.yaw_rate = FreeAreas.UNKNOWN, 9.0, 0.3
            self.stays(*((1.0, 0.0) if fast is one else (0.0, 1.0)))
            self.until(lambda slow=slow, fast=fast: (slow.out.angular.z, fast.out.angular.z) == (0.3, 0.0), "turns")

    def test_2_each_flies_as_fast_as_its_own_verdict_allows(self):
        one, two = self.uavs
        one.state = two.state = FreeAreas.FREE
        one.commanded_mps = two.commanded_mps = 9.0
        one.yaw_rate = two.yaw_rate = 0.0
        one.safe_mps, two.safe_mps = 1.5, 0.4
        self.stays(1.5, 0.4)

    def test_3_a_guard_that_ends_comes_back(self):
        one, two = self.uavs
        one.commanded_mps, one.state, one.safe_mps = 1.0, FreeAreas.FREE, 1.5
        two.commanded_mps, two.state = 1.0, FreeAreas.UNKNOWN
        self.stays(1.0, 0.0)
        rosnode.kill_nodes(["/uav1/corridor_guard"])
        one.out = None
        count = one.out_count
        self.until(lambda: one.out_count > count + 20 and abs(one.out.linear.x - 1.0) < 1e-6, "it does not come back")


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "two_uavs", TwoUavs)
