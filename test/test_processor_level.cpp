#include <gtest/gtest.h>
#include <sensor_msgs/Imu.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>

#include "support/processor_test.hpp"

namespace flight_corridor_ros {
namespace {

using namespace flight_corridor;
using namespace test_support;

class ProcessorLevelTest : public ProcessorTest {};

TEST_F(ProcessorLevelTest, ALevelCorridorStaysLevelAndAlongTheHeading) {
  config.core.corridor.level = true;
  Processor level(config, transforms, inbox);
  const auto show = [&](double after_s) {
    StereoInputs inputs(kFar_m, static_cast<std::uint64_t>(1.0 + 10.0 * after_s));
    inputs.stamp(kStart + ros::Duration(after_s));
    return level.process(messages(inputs)).verdict;
  };
  EXPECT_EQ(show(0.0).reasons, kNoPose) << "the direction of up is unknown";
  EXPECT_FALSE(level.products());
  const Eigen::AngleAxisd nose_up(0.3, Eigen::Vector3d::UnitX()), left_wing_up(0.4, Eigen::Vector3d::UnitZ());
  const Eigen::Isometry3d T_C_B = opticalFromForward(), T_W_B(T_C_B.inverse() * nose_up * left_wing_up * T_C_B);
  sensor_msgs::Imu imu;
  imu.header.frame_id = "range_link";  // which sits as the body does
  imu.header.stamp = kStart + ros::Duration(0.1);
  imu.orientation = tf2::toMsg(Eigen::Quaterniond(T_W_B.linear()));
  inbox.put(boost::make_shared<const sensor_msgs::Imu>(imu));
  show(0.1);
  ASSERT_TRUE(level.products());
  const Eigen::Matrix3d R_W_F =
      T_W_B.linear() * T_C_B.linear().transpose() * level.products()->boxInCamera().T_M_F.linear();
  EXPECT_NEAR(R_W_F(2, 0), 0.0, 1e-6) << "level along its axis";
  EXPECT_NEAR(R_W_F(2, 1), 0.0, 1e-6) << "and across";
  EXPECT_GT(R_W_F(2, 2), 0.99);
  EXPECT_NEAR(std::atan2(R_W_F(1, 0), R_W_F(0, 0)), std::atan2(T_W_B(1, 0), T_W_B(0, 0)), 1e-6) << "its heading";
  ASSERT_TRUE(level.level());
  EXPECT_TRUE(level.level()->isApprox(level.products()->boxInCamera().T_M_F.linear(), 1e-6));
}

TEST_F(ProcessorLevelTest, TheScansLevelIsKnownWhereSomebodySaysWhereUpIs) {
  see(kFar_m, kStart, 1);
  ASSERT_TRUE(processor.products());
  EXPECT_FALSE(processor.level());
  mount("odom", 0.0, kStart + ros::Duration(0.1));
  see(kFar_m, kStart + ros::Duration(0.1), 2);
  ASSERT_TRUE(processor.level());
  EXPECT_TRUE(processor.level()->isApprox(opticalFromForward().linear(), 1e-6));
}

}  // namespace
}  // namespace flight_corridor_ros
