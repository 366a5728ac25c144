#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "flight_corridor/corridor/corridor.hpp"
#include "support/random_octree.hpp"
#include "support/random_pose.hpp"

namespace flight_corridor {
namespace {

using test_support::kEverywhere;
using test_support::keyOf;
using test_support::kResolution_m;
using test_support::randomPose;
using test_support::randomTree;

/// Fills a cube of the octree, which prunes it to one leaf.
void fillCube(octomap::OcTree& tree, const octomap::OcTreeKey& low, int edge_cells, float log_odds) {
  for (int x = 0; x < edge_cells; ++x) {
    for (int y = 0; y < edge_cells; ++y) {
      for (int z = 0; z < edge_cells; ++z) {
        tree.setNodeValue(keyOf(low[0] - 32768 + x, low[1] - 32768 + y, low[2] - 32768 + z), log_odds);
      }
    }
  }
}

/// Leaves of 1 to 16 cells' edge, the smaller ones cut into the larger ones.
octomap::OcTree randomTreeOfBlocks(std::mt19937& random, double occupied_share) {
  octomap::OcTree tree(kResolution_m);
  std::bernoulli_distribution occupied(occupied_share);
  for (const int edge_cells : {16, 8, 4, 2, 1}) {
    std::uniform_int_distribution<int> near(-32 / edge_cells, 32 / edge_cells - 1);
    for (int i = 0; i < 64 / edge_cells; ++i) {
      const octomap::OcTreeKey low =
          keyOf(edge_cells * near(random), edge_cells * near(random), edge_cells * near(random));
      fillCube(tree, low, edge_cells, occupied(random) ? 1.0f : -1.0f);
    }
  }
  return tree;
}

/// Planes near the origin, whose inner side holds it or not.
ConvexRegion randomRegion(std::mt19937& random, int planes) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ConvexRegion region(4, planes);
  for (int i = 0; i < planes; ++i) {
    const Eigen::Vector3d normal = Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    region.col(i) << normal, 0.7 + unit(random);
  }
  return region;
}

double nearFace(const Eigen::Isometry3d& T_F_M, const Eigen::Vector3d& cell_M) {
  double nearest = kInfinity;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d to(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    nearest = std::min(nearest, (T_F_M * (cell_M + 0.5 * kResolution_m * to)).x());
  }
  return nearest;
}

/// All cells around the box, one by one.
/// @param end_from_m along the box's axis; from there on cells beside the region are needed, too, unless two thirds of
/// those are in it.
CorridorOccupancy bruteForce(const octomap::OcTree& tree, const Box& box, double blind_m, const ConvexRegion& needed,
                             double end_from_m = kInfinity) {
  CorridorOccupancy result;
  const Eigen::Isometry3d T_F_M = box.T_M_F.inverse();
  const Eigen::Array3d middle_M = box.T_M_F * Eigen::Vector3d(0.5 * box.size_m.x(), 0.0, 0.0);
  const double reach_m = 0.5 * box.size_m.norm();
  const Eigen::Array3i first = ((middle_M - reach_m) / kResolution_m).cast<int>() - 2;
  const Eigen::Array3i last = ((middle_M + reach_m) / kResolution_m).cast<int>() + 2;
  struct {
    int cells = 0, unknown = 0;
  } needed_nearer, needed_at_end, all_at_end;
  for (int i = first.x(); i <= last.x(); ++i) {
    for (int j = first.y(); j <= last.y(); ++j) {
      for (int k = first.z(); k <= last.z(); ++k) {
        const Eigen::Vector3d centre_M = kResolution_m * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
        if (!intersects(box, centre_M, kResolution_m)) continue;
        const octomap::OcTreeNode* node = tree.search(centre_M.x(), centre_M.y(), centre_M.z());
        const double near_face_m = nearFace(T_F_M, centre_M);
        if (node && tree.isNodeOccupied(node) && near_face_m < box.size_m.x() - 1e-6) {
          result.clear_distance_m = std::min(result.clear_distance_m, std::max(0.0, near_face_m));
        }
        const Eigen::Vector3d centre_F = T_F_M * centre_M;
        if (!(blind_m <= centre_F.x() && centre_F.x() <= box.size_m.x() &&
              std::abs(centre_F.y()) <= 0.5 * box.size_m.y() && std::abs(centre_F.z()) <= 0.5 * box.size_m.z())) {
          continue;
        }
        bool is_needed = true;
        for (int plane = 0; plane < needed.cols(); ++plane) {
          is_needed = is_needed && needed.col(plane).head<3>().dot(centre_M) + needed(3, plane) >= 0.0;
        }
        const bool is_at_end = centre_F.x() >= end_from_m;
        const auto count = [&](auto& counted, bool is_counted) {
          counted.cells += is_counted;
          counted.unknown += is_counted && !node;
        };
        count(needed_nearer, is_needed && !is_at_end);
        count(needed_at_end, is_needed && is_at_end);
        count(all_at_end, is_at_end);
      }
    }
  }
  const auto& end = 3 * needed_at_end.cells >= 2 * all_at_end.cells ? needed_at_end : all_at_end;
  const int cells = needed_nearer.cells + end.cells, unknown = needed_nearer.unknown + end.unknown;
  result.unknown_fraction = cells ? unknown / static_cast<double>(cells) : 1.0;
  return result;
}

/// The distance to 1e-9 m; the counts are whole numbers, so that their ratio is equal to the last bit.
void expectEqual(const CorridorOccupancy& fast, const CorridorOccupancy& slow, const std::string& what) {
  if (std::isfinite(slow.clear_distance_m)) {
    EXPECT_NEAR(fast.clear_distance_m, slow.clear_distance_m, 1e-9) << what;
  } else {
    EXPECT_EQ(fast.clear_distance_m, kInfinity) << what;
  }
  EXPECT_EQ(fast.unknown_fraction, slow.unknown_fraction) << what;
}

TEST(CorridorOracle, AgreesWithALoopOverAllCells) {
  CorridorConfig config;
  config.blind_m = 0.3;
  const Corridor corridor(config);
  std::mt19937 random(21);
  for (int trial = 0; trial < 10; ++trial) {
    const octomap::OcTree tree = randomTree(random, trial % 2 ? 400 : 40000);
    const Box box = corridor.box(randomPose(random, 1.0));
    const ConvexRegion observable = randomRegion(random, trial % 4);
    expectEqual(corridor.inspect(tree, box, box.T_M_F.translation(), observable),
                bruteForce(tree, box, config.blind_m, observable, 0.75 * box.size_m.x()),
                "trial " + std::to_string(trial));
  }
}

TEST(CorridorOracle, AnyBoxOnAnyTreeAgreesWithALoopOverAllCells) {
  std::mt19937 random(22);
  std::uniform_real_distribution<double> size(0.02, 2.0);
  int clear = 0, counted = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const octomap::OcTree tree = randomTreeOfBlocks(random, trial % 3 ? 0.02 : 0.3);
    for (int look = 0; look < 4; ++look) {
      const Box box{randomPose(random, 1.5), {size(random), size(random), size(random)}};
      const ConvexRegion needed = randomRegion(random, look);
      const CorridorOccupancy slow = bruteForce(tree, box, 0.0, needed);
      expectEqual(inspectBox(tree, box, needed), slow,
                  "trial " + std::to_string(trial) + ", look " + std::to_string(look));
      clear += std::isinf(slow.clear_distance_m);
      counted += 0.0 < slow.unknown_fraction && slow.unknown_fraction < 1.0;
    }
  }
  EXPECT_GT(clear, 20);
  EXPECT_LT(clear, 180);
  EXPECT_GT(counted, 50);
}

TEST(CorridorOracle, BoxesAlongTheGridAgreeWithALoopOverAllCells) {
  std::mt19937 random(23);
  std::uniform_int_distribution<int> cells(1, 12), start(-20, 10), turn(0, 3);
  for (int trial = 0; trial < 100; ++trial) {
    const octomap::OcTree tree = randomTreeOfBlocks(random, 0.05);
    Box box;  // no face passes through cells' centres: rounding decides nothing
    box.T_M_F.translation() = kResolution_m * Eigen::Vector3d(start(random), start(random), start(random));
    box.T_M_F.rotate(Eigen::AngleAxisd(0.5 * M_PI * turn(random), Eigen::Vector3d::UnitZ()));
    box.size_m = kResolution_m * Eigen::Vector3d(cells(random) + 0.25, cells(random) + 0.5, cells(random) + 0.5);
    expectEqual(inspectBox(tree, box, kEverywhere), bruteForce(tree, box, 0.0, kEverywhere),
                "trial " + std::to_string(trial));
  }
}

}  // namespace
}  // namespace flight_corridor
