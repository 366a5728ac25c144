#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/motion/camera_motion.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "sim/simulation.hpp"

namespace flight_corridor {
namespace {

/// What of a simulated flight through a wood is told, and with which calibration it is looked at.
struct Telling {
  std::optional<StereoCalibration> calibration;             ///< Else the announced one.
  cv::Rect view;                                            ///< Part of the images that is shown; empty: all.
  Eigen::Isometry3d T_C_X = Eigen::Isometry3d::Identity();  ///< Error of the camera's mounting.
  double stretched = 1.0;                                   ///< Told way over true way.
};

/// The first two and a half seconds of a flight, matched once.
class CameraMotionTest : public ::testing::Test {
 protected:
  static constexpr double kRate_hz = 10.0;
  static constexpr int kPairs = 26;

  static const sim::Simulation& flight() {
    static const sim::Simulation simulation([] {
      sim::SimulationOptions options;
      options.scene = "forest";
      options.seed = 11;
      options.rate_hz = kRate_hz;
      return options;
    }());
    return simulation;
  }
  struct Pair {
    StereoFrame images;
    cv::Mat disparity_px;
  };
  static const std::vector<Pair>& pairs() {
    static const std::vector<Pair> matched = [] {
      DisparityEstimator estimator(StereoConfig(), StereoGeometry(flight().calibration()), 0.05);
      Disparity disparity;
      std::vector<Pair> all;
      for (int i = 0; i < kPairs; ++i) {
        const StereoFrame images = flight().frame(i);
        estimator.estimate(images, disparity);
        all.push_back({images, disparity.best_px.clone()});
      }
      return all;
    }();
    return matched;
  }
  static Eigen::Isometry3d truth(double stamp_s) { return flight().T_W_B(stamp_s) * flight().T_B_C(); }

  /// Whether the witness has contradicted at the end of the flight.
  static bool contradicts(const Telling& telling) {
    StereoCalibration calibration = telling.calibration.value_or(flight().calibration());
    const cv::Rect view = telling.view.empty() ? cv::Rect({0, 0}, calibration.size_px) : telling.view;
    calibration.size_px = view.size();
    CameraMotion motion{StereoGeometry(calibration)};
    for (const Pair& pair : pairs()) {
      Eigen::Isometry3d T_W_C = truth(pair.images.stamp_s) * telling.T_C_X;
      T_W_C.translation() *= telling.stretched;
      motion.update(pair.images.stamp_s, pair.images.left(view), pair.disparity_px(view), correction_, T_W_C);
    }
    return motion.witness().contradicts();
  }

  static inline const ScaleCorrection correction_{ScaleConfig()};
};

TEST_F(CameraMotionTest, FollowsAFlightByTheImagesAloneAsWellAsItSays) {
  CameraMotion motion{StereoGeometry(flight().calibration())};
  std::vector<CameraPose> poses;
  for (const Pair& pair : pairs()) {
    motion.update(pair.images.stamp_s, pair.images.left, pair.disparity_px, correction_, std::nullopt);
    ASSERT_TRUE(motion.pose()) << "at " << pair.images.stamp_s;
    poses.push_back(*motion.pose());
  }
  for (int i = 0, now = 5; now < kPairs; ++i, ++now) {
    const Eigen::Isometry3d true_motion =
        truth(pairs()[i].images.stamp_s).inverse() * truth(pairs()[now].images.stamp_s);
    const Eigen::Isometry3d off = true_motion.inverse() * (poses[i].T_M_C.inverse() * poses[now].T_M_C);
    const double sigma_m = std::sqrt(varianceBetween(poses[i].translation, poses[now].translation));
    EXPECT_EQ(poses[i].series, poses[now].series);
    EXPECT_LE(off.translation().norm(), 3.0 * std::sqrt(3.0) * sigma_m) << "half a second from pair " << i;
    EXPECT_LE(off.translation().norm(), 0.03) << "half a second from pair " << i;
    EXPECT_LE(Eigen::AngleAxisd(off.linear()).angle(), 0.3 * M_PI / 180.0) << "half a second from pair " << i;
  }
}

TEST_F(CameraMotionTest, AToldPoseIsTakenAsItIs) {
  CameraMotion motion{StereoGeometry(flight().calibration())};
  const Pair& pair = pairs().front();
  motion.update(pair.images.stamp_s, pair.images.left, pair.disparity_px, correction_, truth(pair.images.stamp_s));
  ASSERT_TRUE(motion.pose());
  EXPECT_TRUE(motion.pose()->T_M_C.isApprox(truth(pair.images.stamp_s)));
}

TEST_F(CameraMotionTest, TheImagesTellWhatLiesBetweenToldPoses) {
  CameraMotion motion{StereoGeometry(flight().calibration())};
  const auto told = [](int i) { return i % 4 == 0; };  // every 0.4 s
  std::optional<CameraPose> first;
  for (int i = 0; i < kPairs; ++i) {
    const Pair& pair = pairs()[i];
    const Eigen::Isometry3d T_W_C = truth(pair.images.stamp_s);
    motion.update(pair.images.stamp_s, pair.images.left, pair.disparity_px, correction_,
                  told(i) ? std::optional(T_W_C) : std::nullopt);
    ASSERT_TRUE(motion.pose()) << i;
    if (!first) first = motion.pose();
    EXPECT_EQ(motion.pose()->series, first->series) << i;
    EXPECT_LE((motion.pose()->T_M_C.translation() - T_W_C.translation()).norm(), told(i) ? 1e-9 : 0.03) << i;
    const double sigma_m = std::sqrt(varianceBetween(first->translation, motion.pose()->translation));
    EXPECT_EQ(sigma_m > 0.0, !told(i)) << i;
  }
}

TEST_F(CameraMotionTest, AToldMotionThatTheImagesContradictIsNoneWithinHalfASecond) {
  for (const double stretched : {0.0, 0.5, 0.98, 1.0, 2.0}) {
    CameraMotion motion{StereoGeometry(flight().calibration())};
    int told = 0;
    for (int i = 0; i < kPairs; ++i) {
      Eigen::Isometry3d T_W_C = truth(pairs()[i].images.stamp_s);
      T_W_C.translation() *= stretched;
      motion.update(pairs()[i].images.stamp_s, pairs()[i].images.left, pairs()[i].disparity_px, correction_, T_W_C);
      told += motion.pose().has_value();
    }
    const bool is_sound = stretched >= 0.98 && stretched <= 1.0;
    if (is_sound) {
      EXPECT_EQ(told, kPairs) << stretched;
    } else {
      EXPECT_LE(told, 5) << stretched;
    }
  }
}

TEST_F(CameraMotionTest, PosesFromBeforeAJumpAreOfAnotherSeries) {
  CameraMotion motion{StereoGeometry(flight().calibration())};
  int series = 0;
  for (int i = 0; i < 4; ++i) {
    Eigen::Isometry3d T_W_C = truth(pairs()[i].images.stamp_s);
    if (i >= 2) T_W_C.translation().x() += 5.0;  // a loop was closed
    motion.update(pairs()[i].images.stamp_s, pairs()[i].images.left, pairs()[i].disparity_px, correction_, T_W_C);
    if (i == 1 || i == 3) {
      EXPECT_EQ(motion.pose()->series, series) << i;
    } else {
      EXPECT_NE(motion.pose()->series, series) << i;
    }
    series = motion.pose()->series;
  }
}

TEST_F(CameraMotionTest, ImagesWithoutTextureLoseIt) {
  CameraMotion motion{StereoGeometry(flight().calibration())};
  const cv::Mat plain(flight().calibration().size_px, CV_8UC1, cv::Scalar(90));
  const cv::Mat unmatched(plain.size(), CV_32FC1, cv::Scalar(kNaN));
  motion.update(1.0, plain, unmatched, correction_, std::nullopt);
  motion.update(1.1, plain, unmatched, correction_, std::nullopt);
  EXPECT_FALSE(motion.pose());
}

TEST_F(CameraMotionTest, ASoundRigIsNotContradicted) { EXPECT_FALSE(contradicts({})); }

TEST_F(CameraMotionTest, OdometryThatIsTwoPercentShortIsNotContradicted) {
  Telling telling;
  telling.stretched = 0.98;
  EXPECT_FALSE(contradicts(telling));
}

TEST_F(CameraMotionTest, ACropOfRowsWithTheWholeSensorsCalibrationIsContradicted) {
  for (const int top : {-60, -48, 48, 60}) {
    Telling telling;
    telling.view = cv::Rect(0, std::max(0, top), 640, 480 - std::abs(top));
    EXPECT_EQ(contradicts(telling), top > 0) << "rows from " << top;  // cut at the end, the rest is where it was
  }
}

TEST_F(CameraMotionTest, ACalibrationOfALargerImageIsContradicted) {
  for (const double factor : {1.12, 1.08, 0.9}) {
    Telling telling;
    telling.calibration = flight().calibration();
    telling.calibration->fx_px *= factor;
    telling.calibration->fy_px *= factor;
    telling.calibration->cx_px *= factor;
    telling.calibration->cy_px *= factor;
    telling.calibration->cx_right_px *= factor;
    EXPECT_TRUE(contradicts(telling)) << factor;
  }
}

TEST_F(CameraMotionTest, ACameraThatIsMountedOtherwiseThanTfSaysIsContradicted) {
  for (const int axis : {0, 1}) {  // a roll does not show while it flies straight ahead
    for (const double angle_rad : {M_PI, M_PI / 2.0, 0.15}) {
      Telling telling;
      telling.T_C_X.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
      EXPECT_TRUE(contradicts(telling)) << angle_rad << " rad about axis " << axis;
    }
  }
}

TEST_F(CameraMotionTest, ABaselineOfAnotherRigIsContradicted) {
  Telling telling;
  telling.calibration = flight().calibration();
  telling.calibration->baseline_m *= 0.8;
  EXPECT_TRUE(contradicts(telling));
}

TEST_F(CameraMotionTest, FrozenOdometryIsContradicted) {
  Telling telling;
  telling.stretched = 0.0;
  EXPECT_TRUE(contradicts(telling));
}

}  // namespace
}  // namespace flight_corridor
