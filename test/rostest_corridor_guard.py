#!/usr/bin/python3
"""What corridor_guard lets through: limits, and stops on UNKNOWN, on silence, on a stopped clock; turns; who else sends."""

import math
import subprocess
import time
import unittest

import rospy
import rostest
from flight_corridor.msg import CorridorState, FreeAreas
from geometry_msgs.msg import Quaternion, TransformStamped, Twist, TwistStamped
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import Imu
from tf2_msgs.msg import TFMessage

STEP_S = 0.05
SAFE_MPS = 1.5
PATIENCE_S = 20.0  # a loaded machine may need seconds for an answer


class CorridorGuard(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("rostest_corridor_guard")
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=1)
        cls.areas = rospy.Publisher("/flight_corridor/free_areas", FreeAreas, queue_size=1)
        cls.corridor = rospy.Publisher("/flight_corridor/corridor", CorridorState, queue_size=1)
        cls.commands = rospy.Publisher("/cmd_vel_in", Twist, queue_size=1)
        cls.stamped_commands = rospy.Publisher("/stamped/cmd_vel_in", TwistStamped, queue_size=1)
        cls.imu = rospy.Publisher("/imu", Imu, queue_size=1)
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=1)
        cls.log = []
        rospy.Subscriber("/rosout", Log, lambda message: cls.log.append(message.msg), queue_size=100)
        cls.out, cls.stamped_out, cls.out_count = None, None, 0
        rospy.Subscriber("/cmd_vel", Twist, cls.keep, queue_size=1)
        rospy.Subscriber("/stamped/cmd_vel", TwistStamped, cls.keep_stamped, queue_size=1)
        cls.now_s = 100.0

    def setUp(self):
        self.state, self.ticks, self.commanded = FreeAreas.FREE, True, (1.0, 0.0)
        self.sees = self.commands_on = True
        self.yaw_rate, self.left_mps, self.image_age_s = 0.3, SAFE_MPS, 0.0
        self.heading, self.attitude_by = 0.0, None

    @classmethod
    def keep(cls, twist):
        cls.out, cls.out_count = twist, cls.out_count + 1

    @classmethod
    def keep_stamped(cls, twist):
        cls.stamped_out = twist

    def step(self):
        """Everything that the guard hears in a step of time."""
        cls = type(self)
        if self.ticks:
            cls.now_s += STEP_S
        stamp = rospy.Time(cls.now_s)
        self.clock.publish(Clock(stamp))
        if self.sees:
            areas = FreeAreas(rows=1, columns=3, yaw=[-0.1, 0.0, 0.1], pitch=[0.0] * 3, state=[self.state] * 3,
                              clear_distance=[4.0] * 3, safe_speed=[SAFE_MPS, SAFE_MPS, self.left_mps],
                              reasons=[0] * 3)
            verdict = CorridorState(state=self.state, safe_speed=SAFE_MPS)
            areas.header.stamp = verdict.header.stamp = rospy.Time(cls.now_s - self.image_age_s)
            areas.header.frame_id = "camera"
            self.areas.publish(areas)
            self.corridor.publish(verdict)
        if self.attitude_by:
            self.attitude_by(stamp, Quaternion(0.0, 0.0, math.sin(self.heading / 2.0), math.cos(self.heading / 2.0)))
        if self.commands_on:
            command = Twist()
            command.linear.x, command.linear.y = self.commanded
            command.angular.z = self.yaw_rate
            self.commands.publish(command)
            stamped = TwistStamped(twist=command)
            stamped.header.stamp, stamped.header.frame_id = stamp, "base_link"
            self.stamped_commands.publish(stamped)
        time.sleep(STEP_S)

    def send_imu(self, stamp, orientation):
        imu = Imu(orientation=orientation)
        imu.header.stamp, imu.header.frame_id = stamp, "imu"
        self.imu.publish(imu)

    def send_tf(self, stamp, orientation):
        pose = TransformStamped(child_frame_id="camera")
        pose.header.stamp, pose.header.frame_id, pose.transform.rotation = stamp, "odom", orientation
        self.tf.publish(TFMessage([pose]))

    def until(self, holds):
        end = time.time() + PATIENCE_S
        while time.time() < end:
            self.step()
            if self.out and self.stamped_out and holds(self.out) and holds(self.stamped_out.twist):
                return
        self.fail("the last command was %s, stamped %s" % (self.out, self.stamped_out))

    def flies(self, speed_mps):
        self.until(lambda twist: abs(twist.linear.x - speed_mps) < 1e-6 and twist.angular.z == self.yaw_rate)

    def stops(self):
        self.until(lambda twist: twist.linear.x == 0.0 and twist.linear.y == 0.0)

    def test_1_it_speaks_before_anybody_else(self):
        before = self.out_count
        time.sleep(1.0)
        self.assertGreaterEqual(self.out_count - before, 5)
        self.assertEqual(self.out.linear.x, 0.0)

    def test_2_a_slow_command_goes_through_and_a_fast_one_is_limited(self):
        self.flies(1.0)
        self.commanded = (9.0, 0.0)
        self.flies(SAFE_MPS)
        self.assertEqual(self.stamped_out.header.frame_id, "base_link")

    def test_3_aside_and_backwards_nothing_is_flown(self):
        for commanded in ((0.0, 1.0), (-1.0, 0.0)):
            self.commanded = (1.0, 0.0)
            self.flies(1.0)
            self.commanded = commanded
            self.stops()

    def test_4_unknown_stops(self):
        self.flies(1.0)
        self.state = FreeAreas.UNKNOWN
        self.stops()

    def test_5_a_verdict_that_stays_away_stops(self):
        self.flies(1.0)
        self.sees = False
        self.stops()

    def test_6_a_command_that_stays_away_stops_turning_too(self):
        self.flies(1.0)
        self.commands_on = False
        self.until(lambda twist: twist.linear.x == 0.0 and twist.angular.z == 0.0)

    def test_7_a_stopped_clock_stops_although_all_speak_on(self):
        self.flies(1.0)
        self.ticks = False
        self.stops()
        self.ticks = True
        self.flies(1.0)

    def test_8_the_uavs_own_turn_counts_not_the_commanded_one(self):
        self.yaw_rate, self.left_mps, self.image_age_s = 0.0, 0.2, 2 * STEP_S
        step = self.step
        for self.attitude_by in (self.send_imu, self.send_tf):
            for turn_rate, speed_mps in ((0.0, 1.0), (1.0, 0.2), (0.0, 1.0)):
                def turned(turn_rate=turn_rate):
                    self.heading += turn_rate * STEP_S
                    step()
                self.step = turned
                self.flies(speed_mps)

    def test_other_senders_to_the_autopilot_are_named(self):
        other = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        said = "/cmd_vel is also published by %s: these commands pass by the guard" % rospy.get_name()
        self.until(lambda _: any(said in line for line in self.log))
        other.unregister()

    def test_it_refuses_to_hear_itself(self):
        for remaps in (["cmd_vel_in:=cmd_vel"], ["cmd_vel_in:=/uav/out", "cmd_vel:=uav/out"]):
            done = subprocess.run(["rosrun", "flight_corridor", "corridor_guard", "__name:=looped", *remaps],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE_S,
                                  check=False)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("cmd_vel_in and cmd_vel are one topic, %s: the guard would hear its own commands" %
                          ("/uav/out" if len(remaps) > 1 else "/cmd_vel"), done.stdout)


if __name__ == "__main__":
    rostest.rosrun("flight_corridor", "guarding", CorridorGuard)
