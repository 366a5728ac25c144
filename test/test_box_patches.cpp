#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "flight_corridor/corridor/box_patches.hpp"
#include "support/calibrations.hpp"
#include "support/corridor_box.hpp"
#include "support/evidence.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kCorridor;
using test_support::kSmallest_m;
using test_support::kVgaGeometry;
using test_support::texturedAllOver;
using test_support::wallDepth;

constexpr double kNearest_m = 0.33;
constexpr double kSmallest_m2 = kSmallest_m * kSmallest_m;

class BoxPatchesTest : public testing::Test {
 protected:
  std::vector<BoxPatch> find(const Box& box = kCorridor) {
    return patches_.find(box, depth_m_, textured_, kNearest_m, kSmallest_m).front();
  }
  /// Of what blocks; +inf: nothing does.
  double begin() {
    double begin_m = kInfinity;
    for (const BoxPatch& patch : find()) {
      if (patch.blocks(kSmallest_m2)) begin_m = std::min(begin_m, patch.begin_m);
    }
    return begin_m;
  }

  void put(const cv::Rect& pixels, double depth_m) { depth_m_(pixels) = depth_m; }
  /// Of a match's sigma [px].
  void addNoise(double sigma_px, std::uint64_t seed) {
    cv::Mat noise(depth_m_.size(), CV_32FC1);
    cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, sigma_px);
    for (int i = 0; i < static_cast<int>(depth_m_.total()); ++i) {
      float& depth_m = depth_m_.ptr<float>()[i];
      depth_m = static_cast<float>(kVgaGeometry.depth(kVgaGeometry.disparity(depth_m) + noise.ptr<float>()[i]));
    }
  }

  /// Of a pole of 3 cm before a wall at 3.5 m.
  double beginOfPole(double pole_m) {
    depth_m_ = wallDepth(kVgaGeometry.size(), 3.5);
    put({310, 0, static_cast<int>(std::ceil(0.03 / pole_m * kVgaGeometry.calibration().fx_px)), 480}, pole_m);
    addNoise(0.15, 4);
    return begin();
  }

  cv::Mat depth_m_ = wallDepth(kVgaGeometry.size(), 7.0);
  cv::Mat textured_ = texturedAllOver(kVgaGeometry.size());
  BoxPatches patches_{kVgaGeometry};
};

TEST_F(BoxPatchesTest, AWallBehindTheBoxOrTooNearToBeMatchedIsNone) {
  for (const double depth_m : {7.0, 0.9 * kNearest_m, kNaN}) {
    depth_m_ = wallDepth(kVgaGeometry.size(), depth_m);
    EXPECT_TRUE(find().empty()) << depth_m;
  }
}

TEST_F(BoxPatchesTest, WhereverInTheBoxAPatchStandsItIsOneOfTheSameAreaAndBegin) {
  const double depth_m = 2.53, edge_m = 0.1;
  const int edge_px = static_cast<int>(edge_m / depth_m * kVgaGeometry.calibration().fx_px);
  for (const int u : {270, 271, 277, 283, 300, 341}) {  // 0.1 m are 14 px
    for (const int v : {220, 226, 231, 240}) {
      depth_m_ = wallDepth(kVgaGeometry.size(), 7.0);
      put({u, v, edge_px, edge_px}, depth_m);
      const std::vector<BoxPatch> patches = find();
      ASSERT_EQ(patches.size(), 1u) << u << " " << v;
      EXPECT_NEAR(patches[0].in_box_m2, edge_m * edge_m, 0.2 * edge_m * edge_m) << "a pixel more or less";
      EXPECT_EQ(patches[0].around_m2, patches[0].in_box_m2);
      EXPECT_NEAR(patches[0].begin_m, depth_m, 1e-3);
      EXPECT_TRUE(patches[0].blocks(kSmallest_m2));
    }
  }
}

TEST_F(BoxPatchesTest, SurfacesFartherApartThanAPixelAreTwo) {
  const double disparity_px = kVgaGeometry.disparity(2.5);
  for (const double step_px : {0.5, 0.9, 1.1, 3.0}) {
    put({300, 230, 20, 20}, kVgaGeometry.depth(disparity_px));
    put({320, 230, 20, 20}, kVgaGeometry.depth(disparity_px + step_px));
    EXPECT_EQ(find().size(), step_px < 1.0 ? 1u : 2u) << step_px;
  }
}

TEST_F(BoxPatchesTest, WhatTouchesAcrossACornerIsOneWhatDoesNotTouchIsTwo) {
  put({300, 230, 10, 10}, 2.5);
  put({310, 240, 10, 10}, 2.5);
  EXPECT_EQ(find().size(), 1u);
  put({310, 240, 1, 10}, 7.0);
  EXPECT_EQ(find().size(), 2u);
}

TEST_F(BoxPatchesTest, ANoisySlantedPlaneBeginsWhereItsNearestPointInTheBoxIs) {
  for (const double slope : {-1.0, -0.5, 0.0, 0.3, 1.0}) {
    double nearest_m = kInfinity;
    for (int v = 0; v < depth_m_.rows; ++v) {
      for (int u = 0; u < depth_m_.cols; ++u) {
        const Eigen::Vector3d ray = kVgaGeometry.point(u, v, 1.0);
        const double z_m = 2.5 / (1.0 - slope * ray.x());  // z = 2.5 + slope x
        const bool is_there = std::abs(z_m * ray.x()) < 0.55 && std::abs(z_m * ray.y()) < 0.19;
        depth_m_.at<float>(v, u) = static_cast<float>(is_there ? z_m : kNaN);
        if (is_there) nearest_m = std::min(nearest_m, z_m);
      }
    }
    addNoise(0.2, 10 + static_cast<std::uint64_t>(2.0 + slope));
    EXPECT_NEAR(begin(), nearest_m, 0.02) << slope;
  }
}

TEST_F(BoxPatchesTest, BeforeAWallInTheBoxTheBeginIsThePoles) {
  for (const double pole_m : {1.2, 2.5, 2.9}) {
    EXPECT_NEAR(beginOfPole(pole_m), pole_m, 0.02);
  }
}

/// Its foot is as far away as the wall: matches of both are connected.
TEST_F(BoxPatchesTest, APoleThatLeansOnTheWallBeginsAtItsNearEnd) {
  depth_m_ = wallDepth(kVgaGeometry.size(), 3.5);
  const double wall_px = kVgaGeometry.disparity(3.5), near_px = kVgaGeometry.disparity(2.5);
  const double half_px = 0.2 * kVgaGeometry.calibration().fx_px / 2.5;  // of the box's height there
  const int first = static_cast<int>(240 - half_px), end = static_cast<int>(240 + half_px);
  for (int v = first; v < end; ++v) {
    const double share = (v - first) / static_cast<double>(end - 1 - first);
    put({310, v, 12, 1}, kVgaGeometry.depth(wall_px + share * (near_px - wall_px)));
  }
  ASSERT_EQ(find().size(), 1u);
  addNoise(0.1, 5);
  EXPECT_LT(begin(), 2.5 + 0.05);  // half a smallest obstacle; a plane through pole and wall may begin sooner
  EXPECT_GT(begin(), 2.5 - 0.15);
}

TEST_F(BoxPatchesTest, WithoutTextureThereIsNothing) {
  depth_m_ = wallDepth(kVgaGeometry.size(), 2.0);
  textured_.setTo(0);
  EXPECT_TRUE(find().empty());
  textured_(cv::Rect(300, 230, 20, 20)) = 255;
  ASSERT_EQ(find().size(), 1u);
  EXPECT_NEAR(find()[0].begin_m, 2.0, 1e-3);
}

TEST_F(BoxPatchesTest, WhatBeginsBehindTheEndByLessThanNoiseIsInTheBox) {
  const double end_px = kVgaGeometry.disparity(4.0);
  for (const auto& [behind_px, is_in] : {std::pair(0.05, true), std::pair(0.2, false)}) {
    put({300, 230, 30, 20}, kVgaGeometry.depth(end_px - behind_px));
    EXPECT_EQ(std::isfinite(begin()), is_in) << behind_px << " px";
    EXPECT_LE(std::isfinite(begin()) ? begin() : 0.0, 4.0);
  }
}

TEST_F(BoxPatchesTest, FarAwayNoiseIsMoreMetres) {
  Box far = kCorridor;
  far.size_m.x() = 20.0;
  for (const auto& [behind_px, is_in] : {std::pair(0.1, true), std::pair(0.2, false)}) {
    depth_m_ = wallDepth(kVgaGeometry.size(), kVgaGeometry.depth(kVgaGeometry.disparity(20.0) - behind_px));
    const std::vector<BoxPatch> patches = find(far);
    const auto blocks = [](const BoxPatch& patch) { return patch.blocks(kSmallest_m2); };
    EXPECT_EQ(std::any_of(patches.begin(), patches.end(), blocks), is_in) << behind_px << " px";
  }
}

TEST_F(BoxPatchesTest, WhatStandsBesideTheBoxIsAroundIt) {
  const double depth_m = 2.5;
  for (const auto& [y_m, is_in, is_around] : {std::tuple(0.5, true, true), std::tuple(0.65, false, true),
                                              std::tuple(0.7, false, true), std::tuple(0.85, false, false)}) {
    depth_m_ = wallDepth(kVgaGeometry.size(), 7.0);
    const Eigen::Vector2d middle = kVgaGeometry.project({y_m, 0.0, depth_m});
    put({static_cast<int>(middle.x()) - 2, 230, 5, 20}, depth_m);  // 4 cm
    ASSERT_EQ(find().size(), is_around ? 1u : 0u) << y_m;
    for (const BoxPatch& patch : find()) {
      EXPECT_EQ(patch.in_box_m2 > 0.0, is_in) << y_m;
      EXPECT_EQ(patch.in_middle_m2, 0.0) << y_m;
    }
  }
}

TEST_F(BoxPatchesTest, TheMirrorImageHasTheSameOnes) {
  cv::RNG random(8);
  for (int i = 0; i < 12; ++i) {
    put({random.uniform(200, 420), random.uniform(200, 270), random.uniform(4, 40), random.uniform(4, 40)},
        random.uniform(1.5, 4.2));
  }
  addNoise(0.1, 6);
  const auto areas = [&] {
    std::vector<double> areas_m2;
    for (const BoxPatch& patch : find()) areas_m2.push_back(patch.in_box_m2);
    std::sort(areas_m2.begin(), areas_m2.end());
    return areas_m2;
  };
  const std::vector<double> one = areas();
  const double begin_m = begin();
  cv::flip(depth_m_, depth_m_, 1);  // the principal point is in the middle
  EXPECT_NEAR(begin(), begin_m, 0.01);
  const std::vector<double> other = areas();
  ASSERT_EQ(other.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(other[i], one[i], 1e-6);
}

TEST_F(BoxPatchesTest, OfWhatTheNextImageMayMissPointsAreKeptThatStandForAllOfIt) {
  const auto keptArea = [&](const cv::Rect& pixels) {
    depth_m_ = wallDepth(kVgaGeometry.size(), 6.0);
    put(pixels, 1.0);
    double shown_m2 = 0.0, kept_m2 = 0.0;
    for (const BoxPatch& patch : find()) shown_m2 += patch.in_box_m2;
    for (const PatchPoint& point : patches_.missable()) {
      kept_m2 += point.shown_m2;
      EXPECT_NEAR(point.at.z(), 1.0, 0.02);
    }
    EXPECT_LT(patches_.missable().size(), pixels.area());
    return kept_m2 / shown_m2;
  };
  EXPECT_NEAR(keptArea({300, 220, 40, 40}), 1.0, 0.1);
  EXPECT_NEAR(keptArea({300, 180, 2, 100}), 1.0, 0.1) << "thin";
  EXPECT_EQ(keptArea({250, 200, 100, 80}), 0.0) << "broad, in the middle";
}

TEST_F(BoxPatchesTest, OfWhatIsBroadThePartAtTheBoxsEdgeIsKept) {
  depth_m_ = wallDepth(kVgaGeometry.size(), 6.0);
  put({0, 0, 115, 480}, 1.0);  // up to a hand's breadth into the box
  ASSERT_EQ(find().size(), 1u);
  EXPECT_GT(patches_.missable().size(), 0u);
  for (const PatchPoint& point : patches_.missable()) EXPECT_LE(std::abs(point.at.x()), 0.6);
}

}  // namespace
}  // namespace flight_corridor
