#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "flight_corridor/map/cell_evidence.hpp"
#include "support/calibrations.hpp"
#include "support/ray_oracle.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using test_support::kSmallGeometry;
using test_support::wallDepth;
using test_support::withoutHitBand;

using Cells = std::map<std::array<int, 3>, float>;  // from the map's origin

/// All evidence near a camera at the map's origin.
Cells evidenceOf(CellEvidence& evidence) {
  constexpr int kReach = 10;  // blocks
  constexpr int kEdge = EvidenceTree::kBlockCells;
  Cells cells;
  EvidenceTree::Block<float> log_odds;
  for (int x = -kReach * kEdge; x < kReach * kEdge; x += kEdge) {
    for (int y = -kReach * kEdge; y < kReach * kEdge; y += kEdge) {
      for (int z = -kReach * kEdge; z < kReach * kEdge; z += kEdge) {
        const auto key = [](int k) { return static_cast<octomap::key_type>(EvidenceTree::kKeyOrigin + k); };
        if (!evidence.find({key(x), key(y), key(z)}, log_odds)) continue;
        for (unsigned i = 0; i < log_odds.size(); ++i) {
          const unsigned column = i % kEdge, row = i / kEdge % kEdge, layer = i / kEdge / kEdge;
          const float odds = log_odds[EvidenceTree::cellInBlock(column, row, layer)];
          const auto at = [](int low, unsigned offset) { return low + static_cast<int>(offset); };
          if (odds != 0.0f) cells[{at(x, column), at(y, row), at(z, layer)}] = odds;
        }
      }
    }
  }
  return cells;
}

Cells evidenceOf(const cv::Mat& depth_m, const MapConfig& config = {}, double nearest_m = 0.0) {
  CellEvidence evidence(config, kSmallGeometry, nearest_m);
  evidence.look(depth_m, Eigen::Isometry3d::Identity());
  return evidenceOf(evidence);
}

/// The free cells, and where the nearest begins and the farthest ends along z of C.
struct Extent {
  double cells = 0.0, nearest_m = kInfinity, farthest_m = 0.0;
};

Extent freeBefore(const cv::Mat& depth_m, double nearest_m = 0.0) {
  const MapConfig config;
  Extent found;
  for (const auto& [cell, log_odds] : evidenceOf(depth_m, config, nearest_m)) {
    if (log_odds > 0.0f) continue;
    found.nearest_m = std::min(found.nearest_m, cell[2] * config.resolution_m);
    found.farthest_m = std::max(found.farthest_m, (cell[2] + 1) * config.resolution_m);
    ++found.cells;
  }
  return found;
}

TEST(CellEvidence, IsFreeUpToTheBandBeforeAWall) {
  const Extent found = freeBefore(wallDepth(kSmallGeometry.size(), 4.0));
  const double end_m = kSmallGeometry.shiftedDepth(4.0, MapConfig().free_band_px);
  EXPECT_LE(found.farthest_m, end_m + 1e-6);
  EXPECT_GT(found.farthest_m, end_m - MapConfig().resolution_m - 1e-6);
}

TEST(CellEvidence, IsFreeFromWhereASurfaceWouldHaveBeenSeen) {
  const cv::Mat wall_m = wallDepth(kSmallGeometry.size(), 4.0);
  const Extent all = freeBefore(wall_m);
  for (const double nearest_m : {0.33, 1.0, 1.47, 3.05}) {
    const Extent found = freeBefore(wall_m, nearest_m);
    EXPECT_GE(found.nearest_m, nearest_m - 1e-6);
    EXPECT_LT(found.nearest_m, nearest_m + MapConfig().resolution_m + 1e-6);
    EXPECT_EQ(found.farthest_m, all.farthest_m);
    EXPECT_LT(found.cells, all.cells);
  }
}

TEST(CellEvidence, IsFreeInMostOfTheViewBeforeAWall) {
  const Extent found = freeBefore(wallDepth(kSmallGeometry.size(), 4.0));
  const StereoCalibration& camera = kSmallGeometry.calibration();
  const double view_m3 = camera.size_px.area() / (camera.fx_px * camera.fy_px) * std::pow(found.farthest_m, 3) / 3.0;
  const double free_m3 = found.cells * std::pow(MapConfig().resolution_m, 3);
  EXPECT_LT(free_m3, view_m3);
  EXPECT_GT(free_m3, 0.75 * view_m3);  // cells on the border of the view are left out
}

TEST(CellEvidence, IsNothingOfTheImageBefore) {
  CellEvidence evidence(MapConfig(), kSmallGeometry, 0.0);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  evidence.look(wallDepth(kSmallGeometry.size(), 4.0), here);
  EXPECT_GT(evidenceOf(evidence).size(), 0u);
  evidence.look(wallDepth(kSmallGeometry.size(), kNaN), here);
  EXPECT_EQ(evidenceOf(evidence).size(), 0u);
}

/// Evidence of as many pixels of a wall in one cell.
std::size_t hitsOf(int pixels, double depth_m) {
  const int edge = static_cast<int>(kSmallGeometry.calibration().fx_px * MapConfig().resolution_m / depth_m) - 1;
  const Eigen::Vector2d corner = kSmallGeometry.project({1e-3, 1e-3, depth_m});
  cv::Mat depth = wallDepth(kSmallGeometry.size(), kNaN);
  for (int i = 0; i < pixels; ++i) {
    const int u = static_cast<int>(std::ceil(corner.x())) + i % edge,
              v = static_cast<int>(std::ceil(corner.y())) + i / edge;
    depth.at<float>(v, u) = static_cast<float>(depth_m);
  }
  return evidenceOf(depth, withoutHitBand()).size();
}

TEST(CellEvidence, AShareOfAFullFaceIsAHit) {
  for (const double depth_m : {0.65, 1.35, 2.05}) {
    const double edge_px = kSmallGeometry.calibration().fx_px * MapConfig().resolution_m / depth_m;
    const int enough = static_cast<int>(std::ceil(MapConfig().hit_fraction * edge_px * edge_px));
    ASSERT_GT(enough, MapConfig().min_hit_points);
    EXPECT_EQ(hitsOf(enough, depth_m), 1u) << depth_m;
    EXPECT_EQ(hitsOf(enough - 1, depth_m), 0u) << depth_m;
  }
}

TEST(CellEvidence, AFewPointsFarAwayAreNoHit) {
  EXPECT_EQ(hitsOf(MapConfig().min_hit_points - 1, 5.05), 0u);
  EXPECT_EQ(hitsOf(MapConfig().min_hit_points, 5.05), 1u);
}

TEST(CellEvidence, PointsBeyondTheRangeAreNoHits) {
  const auto cells = evidenceOf(wallDepth(kSmallGeometry.size(), 9.05), withoutHitBand());
  ASSERT_FALSE(cells.empty());
  for (const auto& [cell, log_odds] : cells) EXPECT_LT(log_odds, 0.0f);
}

}  // namespace
}  // namespace flight_corridor
