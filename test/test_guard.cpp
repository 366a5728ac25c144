#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "ros/guard.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::CorridorState;
using flight_corridor::FreeAreas;
using flight_corridor::test_support::contains;

constexpr double kStep_rad = 0.1;

class GuardTest : public testing::Test {
 protected:
  GuardTest() {
    areas.rows = 3;
    areas.columns = 5;
    for (int row = -1; row <= 1; ++row) {
      for (int column = -2; column <= 2; ++column) {
        areas.yaw.push_back(column * kStep_rad);
        areas.pitch.push_back(row * kStep_rad);
        areas.state.push_back(FreeAreas::FREE);
        areas.safe_speed.push_back(2.0);
      }
    }
    corridor.state = CorridorState::FREE;
    corridor.safe_speed = 2.0;
    wait(0.0);
    see();
  }

  std::size_t indexOf(int up, int left) const { return static_cast<std::size_t>((up + 1) * 5 + left + 2); }

  void wait(double seconds) {
    time.now += ros::Duration(seconds);
    time.steady_s += seconds;
  }
  void see() {
    areas.header.stamp = corridor.header.stamp = time.now;
    guard.see(areas, time);
    guard.see(corridor, time);
  }

  /// What goes out of a command along a direction.
  geometry_msgs::Twist fly(double speed_mps, double left_rad = 0.0, double up_rad = 0.0) {
    geometry_msgs::TwistStamped command;
    command.twist.linear.x = speed_mps * std::cos(up_rad) * std::cos(left_rad);
    command.twist.linear.y = speed_mps * std::cos(up_rad) * std::sin(left_rad);
    command.twist.linear.z = speed_mps * std::sin(up_rad);
    command.twist.angular.z = 0.7;
    guard.command(command, time);
    return out();
  }
  geometry_msgs::Twist out() {
    const GuardedCommand command = guard.limited(time);
    why = command.why;
    return command.twist;
  }
  static double speedOf(const geometry_msgs::Twist& twist) {
    return std::sqrt(twist.linear.x * twist.linear.x + twist.linear.y * twist.linear.y +
                     twist.linear.z * twist.linear.z);
  }

  FreeAreas areas;
  CorridorState corridor;
  GuardTime time{ros::Time(100.0), 5000.0};
  Guard guard{GuardConfig()};
  std::string why;
};

TEST_F(GuardTest, SlowerThanSafeGoesOutAsItCameIn) {
  const auto twist = fly(1.5, 0.1);
  EXPECT_NEAR(twist.linear.x, 1.5 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(twist.linear.y, 1.5 * std::sin(0.1), 1e-12);
  EXPECT_EQ(twist.angular.z, 0.7);
  EXPECT_EQ(why, "");
}

TEST_F(GuardTest, FasterThanSafeGoesOutSafeInTheSameDirection) {
  const auto twist = fly(9.0, 0.1, 0.1);
  EXPECT_NEAR(speedOf(twist), 2.0, 1e-9);
  EXPECT_NEAR(std::atan2(twist.linear.y, twist.linear.x), 0.1, 1e-9);
  EXPECT_EQ(why, "slowed down: 9.00 m/s 6 deg left, 6 deg up is commanded, 2.00 m/s is safe");
}

TEST_F(GuardTest, TheDirectionOfTheCommandCounts) {
  areas.safe_speed[indexOf(0, 1)] = 0.5;
  areas.state[indexOf(0, -1)] = FreeAreas::UNKNOWN;
  wait(0.1);
  see();
  EXPECT_NEAR(speedOf(fly(1.5, 0.1)), 0.5, 1e-9);
  EXPECT_NEAR(speedOf(fly(1.5, 0.2)), 1.5, 1e-9);
  EXPECT_EQ(speedOf(fly(1.5, -0.1)), 0.0) << "UNKNOWN, whatever its speed says";
  EXPECT_TRUE(contains(why, "stopped: 1.50 m/s 6 deg right, 0 deg up is commanded, 0.00 m/s is safe")) << why;
  EXPECT_NEAR(speedOf(fly(1.5, 0.0)), 1.5, 1e-9);
}

TEST_F(GuardTest, BetweenTwoDirectionsTheSlowerOneRules) {
  areas.safe_speed[indexOf(0, 1)] = 0.5;
  wait(0.1);
  see();
  EXPECT_NEAR(speedOf(fly(1.5, 0.03)), 0.5, 1e-9);
  EXPECT_NEAR(speedOf(fly(1.5, 0.17)), 0.5, 1e-9);
}

TEST_F(GuardTest, StraightAheadTheCorridorsVerdictCountsToo) {
  corridor.safe_speed = 0.8;
  wait(0.1);
  see();
  EXPECT_NEAR(speedOf(fly(1.5)), 0.8, 1e-9);
  EXPECT_NEAR(speedOf(fly(1.5, 0.2)), 1.5, 1e-9);
  corridor.state = CorridorState::UNKNOWN;
  wait(0.1);
  see();
  EXPECT_EQ(speedOf(fly(1.5)), 0.0);
}

TEST_F(GuardTest, WhatPointsBesideTheDirectionsIsNotFlownButTurningIs) {
  for (const auto& [left_rad, up_rad] :
       {std::pair(0.3, 0.0), std::pair(-0.3, 0.0), std::pair(M_PI, 0.0), std::pair(-M_PI_2, 0.0), std::pair(0.0, 0.2),
        std::pair(0.0, -0.2), std::pair(0.0, M_PI_2), std::pair(0.0, -M_PI_2)}) {
    const auto twist = fly(0.1, left_rad, up_rad);
    EXPECT_EQ(speedOf(twist), 0.0) << left_rad << " " << up_rad;
    EXPECT_EQ(twist.angular.z, 0.7);
    EXPECT_TRUE(contains(why, "outside the directions")) << why;
  }
}

TEST_F(GuardTest, ATurnOnTheSpotNeedsNoVerdict) {
  Guard alone{GuardConfig()};
  geometry_msgs::TwistStamped command;
  command.twist.angular.z = -1.0;
  alone.command(command, time);
  EXPECT_EQ(alone.limited(time).twist.angular.z, -1.0);
  command.twist.linear.x = 0.1;
  alone.command(command, time);
  EXPECT_EQ(alone.limited(time).twist.linear.x, 0.0) << "no verdict ever came";
  EXPECT_TRUE(contains(alone.limited(time).why, "stopped: no free_areas has come"));
  EXPECT_EQ(alone.limited(time).twist.angular.z, -1.0);
}

TEST_F(GuardTest, WhileItTurnsTheDirectionsThatItTurnedThroughCount) {
  areas.state[indexOf(0, 2)] = FreeAreas::BLOCKED;
  areas.safe_speed[indexOf(0, 2)] = 0.1;
  wait(0.1);
  see();
  wait(0.15);
  const auto turning = [&](double rate_rad_s) {
    geometry_msgs::TwistStamped command;
    command.twist.linear.x = 1.0;
    command.twist.angular.z = rate_rad_s;
    guard.command(command, time);
    return guard.limited(time).twist.linear.x;
  };
  EXPECT_EQ(turning(0.0), 1.0);
  EXPECT_EQ(turning(-1.0), 1.0) << "to the other side";
  EXPECT_EQ(turning(1.0), 0.1) << "by 0.15 rad to the left";
  EXPECT_EQ(turning(3.0), 0.0) << "beside the grid";
}

/// A turn to the left at 1 rad/s for half a second, an image at its end, then straight ahead at 3 m/s, 0.2 s later.
class GuardAfterATurn : public GuardTest {
 protected:
  GuardAfterATurn() {
    areas.safe_speed[indexOf(0, 2)] = 0.3;
    command(1.0, 0.0);
    wait(0.5);
    see();
    wait(0.19);
  }

  double command(double yaw_rate_rad_s, double speed_mps) {
    geometry_msgs::TwistStamped command;
    command.twist.linear.x = speed_mps;
    command.twist.angular.z = yaw_rate_rad_s;
    guard.command(command, time);
    return out().linear.x;
  }
  Eigen::Quaterniond heading(double left_rad) const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(left_rad, Eigen::Vector3d::UnitZ()));
  }
  ros::Time ago(double seconds) const { return time.now - ros::Duration(seconds); }
};

TEST_F(GuardAfterATurn, WhatTheTurnMayHaveReachedCountsWithoutAnAttitude) {
  EXPECT_EQ(command(0.0, 3.0), 0.3);
  wait(0.5);
  see();
  wait(0.19);
  EXPECT_EQ(command(0.0, 3.0), 2.0) << "the turn is over";
}

TEST_F(GuardAfterATurn, TheMeasuredTurnCountsAlsoWhereNoneIsCommanded) {
  guard.seeImu(ago(0.69), heading(2.0));
  for (double s = 0.25; s > 0.0; s -= 0.05) guard.seeImu(ago(s), heading(2.5 - s));
  EXPECT_EQ(command(0.0, 3.0), 0.3);
}

TEST_F(GuardAfterATurn, AUavThatIsMeasuredNotToTurnFlies) {
  for (double s = 0.65; s > 0.0; s -= 0.05) guard.seeTf(ago(s), heading(2.5));
  guard.seeTf(time.now, heading(2.5));
  EXPECT_EQ(command(0.0, 3.0), 2.0);
}

TEST_F(GuardAfterATurn, AnAttitudeThatStoppedIsContinuedAsCommanded) {
  guard.seeImu(ago(0.25), heading(2.5));
  guard.seeImu(ago(0.18), heading(2.5));
  EXPECT_EQ(command(0.0, 3.0), 0.3);
}

TEST_F(GuardTest, AnOldVerdictStops) {
  EXPECT_GT(speedOf(fly(1.0)), 0.0);
  wait(0.19);
  EXPECT_GT(speedOf(fly(1.0)), 0.0);
  wait(0.02);
  EXPECT_EQ(speedOf(fly(1.0)), 0.0);
  EXPECT_TRUE(contains(why, "free_areas is 0.210 s old, outside +-0.20 s (max_age_s)")) << why;
  see();
  EXPECT_GT(speedOf(fly(1.0)), 0.0);
}

TEST_F(GuardTest, AVerdictWithAnOldOrFutureStampStopsHoweverLateItCame) {
  for (const double age_s : {0.6, -0.6}) {
    areas.header.stamp = corridor.header.stamp = time.now - ros::Duration(age_s);
    guard.see(areas, time);
    guard.see(corridor, time);
    EXPECT_EQ(speedOf(fly(1.0)), 0.0) << age_s;
  }
}

TEST_F(GuardTest, AStoppedClockStopsAlsoWhereMessagesStillCome) {
  for (int i = 0; i < 6; ++i) {
    time.steady_s += 0.06;  // time.now stands still
    see();
    EXPECT_EQ(speedOf(fly(1.0)) > 0.0, i < 3) << i;
  }
}

TEST_F(GuardTest, SilenceOfTheCommandsStopsAllTurningToo) {
  EXPECT_GT(speedOf(fly(1.0)), 0.0);
  wait(0.4);
  see();
  EXPECT_GT(speedOf(out()), 0.0);
  wait(0.2);
  see();
  EXPECT_EQ(speedOf(out()), 0.0);
  EXPECT_EQ(out().angular.z, 0.0);
  EXPECT_TRUE(contains(why, "the command is 0.600 s old, outside +-0.50 s (command_age_s)")) << why;
}

TEST_F(GuardTest, BeforeAnyCommandNothingMovesAndNothingIsSaid) {
  const Guard silent{GuardConfig()};
  EXPECT_EQ(speedOf(silent.limited(time).twist), 0.0);
  EXPECT_EQ(silent.limited(time).why, "");
}

TEST_F(GuardTest, ACommandThatIsNotFiniteIsAStop) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    geometry_msgs::TwistStamped command;
    command.twist.linear.x = 1.0;
    command.twist.linear.z = bad;
    guard.command(command, time);
    EXPECT_EQ(speedOf(out()), 0.0);
    command.twist.linear.z = 0.0;
    command.twist.angular.x = bad;
    guard.command(command, time);
    EXPECT_EQ(speedOf(out()), 0.0);
    EXPECT_EQ(out().angular.x, 0.0);
  }
  EXPECT_NEAR(speedOf(fly(1e300)), 2.0, 1e-9);
}

TEST_F(GuardTest, AVerdictWhoseNumbersAreNoneStops) {
  areas.safe_speed[indexOf(0, 0)] = std::nan("");
  wait(0.1);
  see();
  EXPECT_EQ(speedOf(fly(1.0)), 0.0);
  areas.safe_speed[indexOf(0, 0)] = 2.0;
  const double yaw_rad = std::exchange(areas.yaw[indexOf(0, 1)], std::nan(""));
  wait(0.1);
  see();
  EXPECT_EQ(speedOf(fly(1.0)), 0.0);
  areas.yaw[indexOf(0, 1)] = yaw_rad;
  wait(0.1);
  see();
  EXPECT_GT(speedOf(fly(1.0)), 0.0);
  areas.safe_speed.pop_back();  // arrays of different sizes
  wait(0.1);
  see();
  EXPECT_EQ(speedOf(fly(1.0)), 0.0);
  FreeAreas empty;
  empty.header.stamp = time.now;
  guard.see(empty, time);
  EXPECT_EQ(speedOf(fly(1.0)), 0.0);
  EXPECT_TRUE(contains(why, "free_areas is malformed")) << why;
}

TEST_F(GuardTest, StampedCommandsOfAnotherFrameOrTimeAreRefused) {
  GuardConfig config;
  config.stamped = true;
  Guard stamped{config};
  stamped.see(areas, time);
  stamped.see(corridor, time);
  geometry_msgs::TwistStamped command;
  command.twist.linear.x = 1.0;
  command.header.frame_id = "/base_link";
  command.header.stamp = time.now;
  stamped.command(command, time);
  EXPECT_EQ(stamped.limited(time).twist.linear.x, 1.0);
  command.header.frame_id = "map";
  stamped.command(command, time);
  EXPECT_EQ(stamped.limited(time).twist.linear.x, 0.0);
  EXPECT_TRUE(contains(stamped.limited(time).why, "frame \"map\""));
  command.header.frame_id = "base_link";
  command.header.stamp = time.now - ros::Duration(1.0);
  stamped.command(command, time);
  EXPECT_EQ(stamped.limited(time).twist.linear.x, 0.0);
}

TEST_F(GuardTest, AGridOfOneDirectionIsFlownAlongItAlone) {
  FreeAreas one;
  one.header.stamp = time.now;
  one.rows = one.columns = 1;
  one.yaw = one.pitch = {0.0};
  one.state = {FreeAreas::FREE};
  one.safe_speed = {2.0};
  guard.see(one, time);
  EXPECT_EQ(speedOf(fly(1.0, 0.03)), 1.0);
  EXPECT_EQ(speedOf(fly(1.0, 0.06)), 0.0);
}

TEST(GuardParameters, EveryBrokenRuleIsNamedAtOnce) {
  EXPECT_EQ(makeGuardConfig({{"rate_hz", 50}}).rate_hz, 50.0);
  EXPECT_EQ(makeGuardConfig({{"frame_id", std::string("/base")}}).frame_id, "base");
  try {
    makeGuardConfig({{"rate_hz", 0.0},
                     {"max_age_s", std::nan("")},
                     {"command_age_s", -1.0},
                     {"frame_id", std::string("/")},
                     {"turn_delay_s", 3.0},
                     {"gravity_frame", std::string()},
                     {"stamped", 1},
                     {"speed", 2.0}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const char* key :
         {"rate_hz", "max_age_s", "command_age_s", "frame_id", "turn_delay_s", "gravity_frame", "stamped", "speed"}) {
      EXPECT_TRUE(contains(error.what(), std::string(key) + ": ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace flight_corridor_ros
