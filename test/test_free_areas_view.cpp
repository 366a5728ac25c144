#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "flight_corridor/view/free_areas_view.hpp"
#include "flight_corridor/view/overlay.hpp"
#include "support/calibrations.hpp"

namespace flight_corridor {
namespace {

using test_support::kVgaGeometry;

class FreeAreasView : public testing::Test {
 protected:
  FreeAreasView() : areas(areaGrid(config)) {
    box.T_M_F = opticalFromForward();
    box.size_m = {4.0, 1.2, 0.4};
  }

  void set(int row, int column, State state) { areas.areas[row * areas.columns + column].verdict.state = state; }

  cv::Mat draw(const std::optional<Eigen::Vector3d>& goal_C = std::nullopt) const {
    cv::Mat out;
    drawFreeAreas(cv::Mat(kVgaGeometry.size(), CV_8UC1, cv::Scalar(100)), kVgaGeometry, box, areas, config.step_rad,
                  goal_C, out);
    return out;
  }

  /// Colour a little beside a tile's middle, where the mark of the best would be.
  cv::Vec3b colourAt(double left_rad, double up_rad) const {
    const Eigen::Vector2d pixel = kVgaGeometry.project(
        box.T_M_F * (4.0 * ahead({left_rad + 0.3 * config.step_rad, up_rad + 0.3 * config.step_rad, {}})));
    return draw().at<cv::Vec3b>(cvRound(pixel.y()), cvRound(pixel.x()));
  }

  FreeAreasConfig config{0.2, 0.1, 0.1};
  AreaGrid areas;
  Box box;
};

TEST_F(FreeAreasView, ATileStandsWhereItsDirectionPointsInTheStatesColour) {
  set(1, 4, State::Free);     // leftmost, level
  set(2, 2, State::Blocked);  // ahead and up
  const cv::Vec3b free = colourAt(0.2, 0.0), blocked = colourAt(0.0, 0.1), unknown = colourAt(-0.2, 0.0);
  EXPECT_GT(free[1], free[2]) << free;
  EXPECT_GT(blocked[2], blocked[1]) << blocked;
  EXPECT_GT(unknown[2], unknown[0]) << unknown;
  EXPECT_GT(unknown[1], unknown[0]) << unknown;
}

TEST_F(FreeAreasView, OutsideOfTheDirectionsThePictureIsAsItWas) {
  const cv::Mat out = draw();
  EXPECT_EQ(out.at<cv::Vec3b>(400, 320), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(out.at<cv::Vec3b>(240, 600), cv::Vec3b(100, 100, 100));
}

TEST_F(FreeAreasView, TheBestAndTheGoalAreMarked) {
  const cv::Mat plain = draw();
  set(1, 2, State::Free);
  const cv::Mat free = draw();
  areas.best = 1 * areas.columns + 2;
  const cv::Mat best = draw();
  EXPECT_EQ(best.at<cv::Vec3b>(240, 320), cv::Vec3b(255, 255, 255));
  EXPECT_GT(cv::norm(best, free, cv::NORM_INF), 0.0);
  const cv::Mat goal = draw(Eigen::Vector3d(0.3, 0.0, 1.0));
  EXPECT_GT(cv::norm(goal.colRange(400, 500), best.colRange(400, 500), cv::NORM_INF), 0.0);
}

TEST_F(FreeAreasView, AGoalOfAnyLengthIsMarkedTheSame) {
  const Eigen::Vector3d goal_C(0.3, 0.0, 1.0);
  for (const double length : {1e-200, 1e200}) {
    EXPECT_EQ(cv::norm(draw(length * goal_C), draw(goal_C), cv::NORM_INF), 0.0) << length;
  }
}

TEST_F(FreeAreasView, AGoalThatIsNoneOrBesideTheCameraHasNoMark) {
  const cv::Mat plain = draw();
  for (const Eigen::Vector3d& none : {Eigen::Vector3d(kNaN, 0.0, 1.0), Eigen::Vector3d(0.0, kInfinity, 1.0),
                                      Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(1.0, 0.0, 1e-310)}) {
    EXPECT_EQ(cv::norm(draw(none), plain, cv::NORM_INF), 0.0) << none.transpose();
  }
}

TEST_F(FreeAreasView, WhatPointsBehindTheCameraIsNotDrawn) {
  box.T_M_F.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  areas.best = 0;
  cv::Mat out = draw(Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_EQ(out.at<cv::Vec3b>(240, 320), cv::Vec3b(100, 100, 100));
}

TEST_F(FreeAreasView, ATileIsAsWideAsItsStepButForAGap) {
  const auto corners = tileOf({0.0, 0.0, {}}, box, 0.1, 2.0);
  ASSERT_EQ(corners.size(), 4u);
  const double width_m = (corners[0] - corners[1]).norm();
  EXPECT_LT(width_m, 2.0 * 0.1);
  EXPECT_GT(width_m, 0.8 * 2.0 * 0.1);
  EXPECT_LT(corners[0].x(), 0.0) << "the first corner is to the left";
  EXPECT_LT(corners[0].y(), 0.0) << "and up";
}

}  // namespace
}  // namespace flight_corridor
