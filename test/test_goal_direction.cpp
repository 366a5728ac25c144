#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <limits>
#include <string>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/goal_direction.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

const ros::Time kNow(100.0);

class GoalDirectionTest : public testing::Test {
 protected:
  GoalDirectionTest() {
    place("base_link", "camera", Eigen::Isometry3d(flight_corridor::opticalFromForward().inverse()), ros::Time());
    camera.frame_id = "camera";
    camera.stamp = kNow;
  }

  void place(const std::string& parent, const std::string& child, const Eigen::Isometry3d& pose,
             const ros::Time& stamp) {
    geometry_msgs::TransformStamped message = tf2::eigenToTransform(pose);
    message.header.stamp = stamp;
    message.header.frame_id = parent;
    message.child_frame_id = child;
    transforms.add(message, stamp.isZero());
  }

  static geometry_msgs::Vector3Stamped wish(const std::string& frame, const Eigen::Vector3d& vector,
                                            const ros::Time& stamp = kNow) {
    geometry_msgs::Vector3Stamped message;
    message.header.frame_id = frame;
    message.header.stamp = stamp;
    tf2::toMsg(vector, message.vector);
    return message;
  }

  /// What the log says when a message is put.
  std::string complaintAbout(const geometry_msgs::Vector3Stamped& message) {
    GoalDirection fresh(transforms);
    testing::internal::CaptureStderr();
    fresh.put(message, kNow);
    EXPECT_EQ(fresh.find(camera).has_value(), false);
    return testing::internal::GetCapturedStderr();
  }

  Transforms transforms;
  GoalDirection goal{transforms};
  std_msgs::Header camera;
};

TEST_F(GoalDirectionTest, WithoutAMessageThereIsNone) { EXPECT_FALSE(goal.find(camera)); }

TEST_F(GoalDirectionTest, IsAUnitVectorInTheCamerasFrame) {
  goal.put(wish("/base_link", {0.0, 5.0, 0.0}), kNow);  // left
  const auto direction_C = goal.find(camera);
  ASSERT_TRUE(direction_C);
  EXPECT_TRUE(direction_C->isApprox(Eigen::Vector3d(-1.0, 0.0, 0.0)));
}

TEST_F(GoalDirectionTest, IsThatOfEveryFiniteVectorHoweverLongOrShort) {
  for (const double length : {1e-320, 1e-200, 1e-7, 1.0, 1e200, 1.7e308}) {
    GoalDirection fresh(transforms);
    fresh.put(wish("base_link", {length, length, 0.0}), kNow);
    const auto direction_C = fresh.find(camera);
    ASSERT_TRUE(direction_C) << length;
    EXPECT_TRUE(direction_C->isApprox(Eigen::Vector3d(-M_SQRT1_2, 0.0, M_SQRT1_2))) << length;
  }
}

TEST_F(GoalDirectionTest, OfAFixedFrameStaysThereWhileTheUavTurns) {
  goal.put(wish("odom", {1.0, 0.0, 0.0}), kNow);
  for (const double left_rad : {0.0, 0.5}) {
    camera.stamp += ros::Duration(0.1);
    place("odom", "base_link", Eigen::Isometry3d(Eigen::AngleAxisd(left_rad, Eigen::Vector3d::UnitZ())), camera.stamp);
    const auto direction_C = goal.find(camera);
    ASSERT_TRUE(direction_C);
    EXPECT_NEAR(direction_C->x(), std::sin(left_rad), 1e-9) << "to the right of a UAV that turned left";
  }
}

TEST_F(GoalDirectionTest, StaysUntilTheNextOne) {
  goal.put(wish("base_link", {1.0, 0.0, 0.0}), kNow);
  camera.stamp += ros::Duration(1000.0);
  EXPECT_TRUE(goal.find(camera));
  goal.put(wish("base_link", {0.0, 0.0, 1.0}, ros::Time(0)), kNow);  // no stamp: now
  EXPECT_TRUE(goal.find(camera)->isApprox(Eigen::Vector3d(0.0, -1.0, 0.0)));
}

TEST_F(GoalDirectionTest, WhatIsNoneIsNamedAndTheLastOneStays) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(contains(complaintAbout(wish("", {1.0, 0.0, 0.0})), "names no frame"));
  EXPECT_TRUE(contains(complaintAbout(wish("/", {1.0, 0.0, 0.0})), "names no frame"));
  for (const Eigen::Vector3d& vector : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(nan, 0, 1),
                                        Eigen::Vector3d(infinity, 0, 0), Eigen::Vector3d(0, -infinity, 0)}) {
    EXPECT_TRUE(contains(complaintAbout(wish("base_link", vector)), "has no direction")) << vector;
  }
  for (const double age_s : {5.0, -5.0}) {
    EXPECT_TRUE(contains(complaintAbout(wish("base_link", {1, 0, 0}, kNow - ros::Duration(age_s))),
                         age_s > 0.0 ? "5.000 s old" : "5.000 s ahead of the clock"));
  }
  goal.put(wish("base_link", {1.0, 0.0, 0.0}), kNow);
  goal.put(wish("base_link", {0.0, 0.0, 0.0}), kNow);
  EXPECT_TRUE(goal.find(camera)->isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_F(GoalDirectionTest, OfAFrameThatTfDoesNotKnowIsWarnedOfAndCountsOnceItDoes) {
  goal.put(wish("odom", {1.0, 0.0, 0.0}), kNow);
  testing::internal::CaptureStderr();
  EXPECT_FALSE(goal.find(camera));
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "tf does not connect \"odom\" (goal_direction)"));
  place("odom", "base_link", Eigen::Isometry3d::Identity(), kNow);
  EXPECT_TRUE(goal.find(camera));
}

TEST_F(GoalDirectionTest, WhereTfIsLateItsNewestPoseCounts) {
  goal.put(wish("odom", {1.0, 0.0, 0.0}), kNow);
  for (const double left_rad : {0.2, 0.5}) {
    camera.stamp += ros::Duration(0.1);
    place("odom", "base_link", Eigen::Isometry3d(Eigen::AngleAxisd(left_rad, Eigen::Vector3d::UnitZ())), camera.stamp);
  }
  EXPECT_NEAR(goal.find(camera)->x(), std::sin(0.5), 1e-9);
  camera.stamp += ros::Duration(0.1);
  testing::internal::CaptureStderr();
  const auto direction_C = goal.find(camera);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_TRUE(direction_C);
  EXPECT_NEAR(direction_C->x(), std::sin(0.5), 1e-9);
  camera.stamp -= ros::Duration(0.2);
  EXPECT_NEAR(goal.find(camera)->x(), std::sin(0.2), 1e-9) << "that of its stamp, where it is there";
}

TEST_F(GoalDirectionTest, WhereTfHasStoppedItIsStraightAheadWithAWarning) {
  goal.put(wish("odom", {1.0, 0.0, 0.0}), kNow);
  place("odom", "base_link", Eigen::Isometry3d::Identity(), camera.stamp);
  camera.stamp += ros::Duration(0.9);
  EXPECT_TRUE(goal.find(camera));
  camera.stamp += ros::Duration(0.2);
  testing::internal::CaptureStderr();
  EXPECT_FALSE(goal.find(camera));
  EXPECT_TRUE(contains(testing::internal::GetCapturedStderr(), "within 1.0 s of the image: straight ahead"));
}

}  // namespace
}  // namespace flight_corridor_ros
