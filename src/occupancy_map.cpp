#include "flight_corridor/occupancy_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_corridor/types.hpp"

namespace flight_corridor {

namespace {

constexpr float kKeyOrigin = 32768.0f;     // OctoMap's key of the coordinate 0
constexpr float kSmallestDepth_m = 0.05f;  // cubes nearer than this reach behind the camera's optical centre

}  // namespace

/// A cube of the octree, known to it or not.
struct OccupancyMap::Cube {
  octomap::OcTreeKey key;    // of its lowest corner's cell
  unsigned depth;            // 0 = root
  Eigen::Vector3f centre_C;  // [m]
};

Violations check(const MapConfig& config) {
  Rules rules("map");
  rules.require(0.01 <= config.resolution_m && config.resolution_m <= 1.0, "resolution_m", "0.01 to 1",
                config.resolution_m);
  rules.require(config.max_range_m > config.resolution_m && config.max_range_m <= 100.0, "max_range_m",
                "above resolution_m, up to 100", config.max_range_m);
  rules.require(0.0 < config.hit_fraction && config.hit_fraction <= 1.0, "hit_fraction", "above 0, up to 1",
                config.hit_fraction);
  rules.require(config.min_hit_points >= 1, "min_hit_points", "1 or more", config.min_hit_points);
  rules.require(0.0 <= config.hit_band_px && config.hit_band_px <= config.free_band_px, "hit_band_px",
                "0 to free_band_px", config.hit_band_px);
  rules.require(config.free_band_px >= 0.0, "free_band_px", "not negative", config.free_band_px);
  rules.require(0.0 < config.min_ray_fraction && config.min_ray_fraction <= 1.0, "min_ray_fraction", "above 0, up to 1",
                config.min_ray_fraction);
  rules.require(config.log_odds_hit > 0.0, "log_odds_hit", "positive", config.log_odds_hit);
  rules.require(config.log_odds_miss < 0.0, "log_odds_miss", "negative", config.log_odds_miss);
  rules.require(config.log_odds_min < 0.0 && config.log_odds_min >= -10.0, "log_odds_min", "-10 to below 0",
                config.log_odds_min);
  rules.require(config.log_odds_max > 0.0 && config.log_odds_max <= 10.0, "log_odds_max", "above 0, up to 10",
                config.log_odds_max);
  rules.require(config.log_odds_hit + config.log_odds_min >= 0.0, "log_odds_hit",
                "no less than -log_odds_min, so that one hit makes a free cell occupied", config.log_odds_hit);
  return rules.broken();
}

octomap::OcTreeNode* OccupancyMap::Tree::makeRoot() {
  if (!root) {
    root = new octomap::OcTreeNode();
    ++tree_size;
    size_changed = true;
  }
  return root;
}

OccupancyMap::OccupancyMap(const MapConfig& config, const StereoGeometry& geometry)
    : config_(config),
      geometry_(geometry),
      tree_((throwIfBroken(check(config)), config.resolution_m)),
      focal_px_(geometry.calibration().fx_px, geometry.calibration().fy_px),
      centre_px_(geometry.calibration().cx_px, geometry.calibration().cy_px) {
  tree_.setClampingThresMin(octomap::probability(config.log_odds_min));
  tree_.setClampingThresMax(octomap::probability(config.log_odds_max));
  tree_.setProbHit(octomap::probability(config.log_odds_hit));
  tree_.setProbMiss(octomap::probability(config.log_odds_miss));
  half_edges_C_.resize(tree_.getTreeDepth() + 1);
  cube_reach_C_.resize(tree_.getTreeDepth() + 1);
  path_.resize(tree_.getTreeDepth() + 1);
  child_of_path_.resize(tree_.getTreeDepth() + 1);
  const Eigen::Vector3d corners_C[] = {geometry_.point(0, 0, 1), geometry_.point(geometry_.size().width - 1, 0, 1),
                                       geometry_.point(geometry_.size().width - 1, geometry_.size().height - 1, 1),
                                       geometry_.point(0, geometry_.size().height - 1, 1)};
  for (int side = 0; side < 4; ++side) {
    view_sides_C_[side] = corners_C[(side + 1) % 4].cross(corners_C[side]).cast<float>();
  }
}

void OccupancyMap::insert(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  measureRays(depth_m);
  pyramid_.build(near_m_, far_m_, config_.min_ray_fraction);
  countPoints(hit_m_, T_M_C.cast<float>());

  const Eigen::Isometry3f T_C_M = T_M_C.inverse().cast<float>();
  orientCubes(T_C_M);
  path_[0] = tree_.getRoot();
  visit({octomap::OcTreeKey(0, 0, 0), 0, T_C_M.translation()});
}

void OccupancyMap::measureRays(const cv::Mat& depth_m) {
  hit_m_.create(depth_m.size(), CV_32FC1);
  near_m_.create(depth_m.size(), CV_32FC1);
  far_m_.create(depth_m.size(), CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* surface = depth_m.ptr<float>(v);
    auto* hit_row = hit_m_.ptr<float>(v);
    auto* near_row = near_m_.ptr<float>(v);
    auto* far_row = far_m_.ptr<float>(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      hit_row[u] = static_cast<float>(geometry_.shiftedDepth(surface[u], config_.hit_band_px));
      near_row[u] = static_cast<float>(geometry_.shiftedDepth(surface[u], config_.free_band_px));
      far_row[u] = static_cast<float>(geometry_.shiftedDepth(surface[u], -config_.free_band_px));
    }
  }
}

/// Neighbouring pixels mostly fall into one cell, so that runs of them are looked up once.
void OccupancyMap::countPoints(const cv::Mat& depth_m, const Eigen::Isometry3f& T_M_C) {
  points_.clear();
  const float max_range_m = static_cast<float>(config_.max_range_m);
  const float cells_per_m = static_cast<float>(1.0 / config_.resolution_m);
  const Eigen::Array3f key_origin = Eigen::Array3f::Constant(kKeyOrigin);
  octomap::OcTreeKey run_key;
  int run = 0;
  const auto flush = [&] {
    if (run > 0) points_[run_key] += run;
    run = 0;
  };
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* row = depth_m.ptr<float>(v);
    const float y = (static_cast<float>(v) - centre_px_.y()) / focal_px_.y();
    for (int u = 0; u < depth_m.cols; ++u) {
      if (!(row[u] <= max_range_m)) continue;
      const float x = (static_cast<float>(u) - centre_px_.x()) / focal_px_.x();
      const Eigen::Array3f cell = (T_M_C * (Eigen::Vector3f(x, y, 1.0f) * row[u])).array() * cells_per_m + key_origin;
      if ((cell < 0.0f).any() || (cell >= 2.0f * key_origin).any()) continue;  // outside what an octree can hold
      const Eigen::Array3i index = cell.cast<int>();
      const octomap::OcTreeKey key(static_cast<octomap::key_type>(index.x()), static_cast<octomap::key_type>(index.y()),
                                   static_cast<octomap::key_type>(index.z()));
      if (run == 0 || key != run_key) flush();
      run_key = key;
      ++run;
    }
  }
  flush();
}

void OccupancyMap::orientCubes(const Eigen::Isometry3f& T_C_M) {
  for (unsigned depth = 0; depth < half_edges_C_.size(); ++depth) {
    half_edges_C_[depth] = T_C_M.linear() * static_cast<float>(0.5 * tree_.getNodeSize(depth));
    cube_reach_C_[depth] = half_edges_C_[depth].cwiseAbs().rowwise().sum();
  }
}

/// Depth-first over the cubes that the camera sees, known to the tree or not; nodes come into being where evidence
/// falls.
/// @return whether anything in the cube changed.
bool OccupancyMap::visit(const Cube& cube) {
  const unsigned leaf_depth = tree_.getTreeDepth();
  const Sight sight = look(cube);
  if (cube.depth == leaf_depth) {
    const bool hit = sight != Sight::Free && isHit(cube);
    if (!hit && sight != Sight::Free) return false;
    addToPath(cube.depth, static_cast<float>(hit ? config_.log_odds_hit : config_.log_odds_miss));
    return true;
  }
  if (sight == Sight::Nothing) return false;
  if (sight == Sight::Free) {
    addToPath(cube.depth, static_cast<float>(config_.log_odds_miss));
    return true;
  }

  bool changed = false;
  const auto half_cells = static_cast<octomap::key_type>(1u << (leaf_depth - cube.depth - 1));
  for (unsigned child = 0; child < 8; ++child) {
    Cube part{cube.key, cube.depth + 1, cube.centre_C};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const bool upper = child >> axis & 1u;
      if (upper) part.key[axis] = static_cast<octomap::key_type>(part.key[axis] + half_cells);
      part.centre_C += (upper ? 1.0f : -1.0f) * half_edges_C_[part.depth].col(axis);
    }
    octomap::OcTreeNode* node = path_[cube.depth];
    path_[part.depth] = node && tree_.nodeChildExists(node, child) ? tree_.getNodeChild(node, child) : nullptr;
    child_of_path_[part.depth] = child;
    changed |= visit(part);
  }
  if (changed && !tree_.pruneNode(path_[cube.depth])) path_[cube.depth]->updateOccupancyChildren();
  return changed;
}

/// What the rays that meet a cube say of it. At leaves a part of the rays is enough. The cube is bounded by a box
/// square to the camera, whose image is bounded by its sides at its nearest or farthest depth.
OccupancyMap::Sight OccupancyMap::look(const Cube& cube) const {
  const Eigen::Array3f reach_C = cube_reach_C_[cube.depth];
  const Eigen::Array3f low_C = cube.centre_C.array() - reach_C, high_C = cube.centre_C.array() + reach_C;
  const float nearest_m = low_C.z(), farthest_m = high_C.z();
  if (farthest_m <= 0.0f || nearest_m > config_.max_range_m) return Sight::Nothing;
  if (nearest_m < kSmallestDepth_m) return isBesideView(cube) ? Sight::Nothing : Sight::Mixed;

  const Eigen::Array2f low_m = low_C.head<2>(), high_m = high_C.head<2>();
  const Eigen::Array2f low =
      (low_m / (low_m < 0.0f).select(Eigen::Array2f::Constant(nearest_m), farthest_m)) * focal_px_ + centre_px_;
  const Eigen::Array2f high =
      (high_m / (high_m > 0.0f).select(Eigen::Array2f::Constant(nearest_m), farthest_m)) * focal_px_ + centre_px_;
  const Eigen::Array2f last(near_m_.cols - 1, near_m_.rows - 1);
  if ((high < 0.0f).any() || (low > last).any()) return Sight::Nothing;
  const Eigen::Array2i first_px = low.max(0.0f).cast<int>(), last_px = high.min(last).ceil().cast<int>();
  const DepthPyramid::Reach reach =
      pyramid_.reach({first_px.x(), first_px.y(), last_px.x() - first_px.x() + 1, last_px.y() - first_px.y() + 1});
  if (nearest_m > reach.farthest_m) return Sight::Nothing;

  const bool leaf = cube.depth == tree_.getTreeDepth();
  const bool whole = (low >= 0.0f).all() && (high <= last).all();
  const bool seen_past = farthest_m <= std::min(reach.nearest_m, static_cast<float>(config_.max_range_m));
  const bool rays_enough = reach.tile_fraction >= (leaf ? static_cast<float>(config_.min_ray_fraction) : 1.0f);
  return whole && seen_past && rays_enough ? Sight::Free : Sight::Mixed;
}

/// Whether a cube lies outside one of the planes through the image's borders: for cubes too near to be projected.
bool OccupancyMap::isBesideView(const Cube& cube) const {
  return std::any_of(view_sides_C_.begin(), view_sides_C_.end(), [&](const Eigen::Vector3f& normal_C) {
    return normal_C.dot(cube.centre_C) > normal_C.cwiseAbs().dot(cube_reach_C_[cube.depth].matrix());
  });
}

/// Enough points for a cell at this distance: a full face shows f^2 r^2 / Z^2 of them.
bool OccupancyMap::isHit(const Cube& cube) const {
  const auto found = points_.find(cube.key);
  if (found == points_.end() || !(cube.centre_C.z() > 0.0f)) return false;
  const StereoCalibration& calibration = geometry_.calibration();
  const double face_px = calibration.fx_px * calibration.fy_px * std::pow(config_.resolution_m / cube.centre_C.z(), 2);
  const double enough = std::max<double>(config_.min_hit_points, config_.hit_fraction * face_px);
  return found->second >= enough;
}

/// The node of the path at a depth; what is missing of the path comes into being, a pruned parent is taken apart first.
octomap::OcTreeNode* OccupancyMap::materialise(unsigned depth, bool& created) {
  created = false;
  if (path_[depth]) return path_[depth];
  if (depth == 0) {
    created = true;
    return path_[0] = tree_.makeRoot();
  }
  bool parent_created;
  octomap::OcTreeNode* parent = materialise(depth - 1, parent_created);
  const unsigned child = child_of_path_[depth];
  if (!parent_created && !tree_.nodeHasChildren(parent)) {
    tree_.expandNode(parent);
    return path_[depth] = tree_.getNodeChild(parent, child);
  }
  created = true;
  return path_[depth] = tree_.createNodeChild(parent, child);
}

void OccupancyMap::addToPath(unsigned depth, float log_odds) {
  bool created;
  addToSubtree(materialise(depth, created), log_odds);
}

/// Unknown parts of a known subtree come into being with the evidence alone.
void OccupancyMap::addToSubtree(octomap::OcTreeNode* node, float log_odds) {
  if (!tree_.nodeHasChildren(node)) return tree_.updateNodeLogOdds(node, log_odds);
  for (unsigned child = 0; child < 8; ++child) {
    const bool known = tree_.nodeChildExists(node, child);
    addToSubtree(known ? tree_.getNodeChild(node, child) : tree_.createNodeChild(node, child), log_odds);
  }
  if (!tree_.pruneNode(node)) node->updateOccupancyChildren();
}

void OccupancyMap::insertBeam(const Eigen::Vector3d& origin_M, const Eigen::Vector3d& end_M, bool hit) {
  const auto point = [](const Eigen::Vector3f& p) { return octomap::point3d(p.x(), p.y(), p.z()); };
  octomap::OcTreeKey end;
  if (!origin_M.allFinite() || !end_M.allFinite() || !tree_.coordToKeyChecked(point(end_M.cast<float>()), end)) return;
  beam_.reset();
  if (!tree_.computeRayKeys(point(origin_M.cast<float>()), point(end_M.cast<float>()), beam_)) return;
  for (const octomap::OcTreeKey& key : beam_) tree_.updateNode(key, static_cast<float>(config_.log_odds_miss));
  if (hit) tree_.updateNode(end, static_cast<float>(config_.log_odds_hit));
}

}  // namespace flight_corridor
