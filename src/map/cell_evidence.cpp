#include "flight_corridor/map/cell_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr float kSmallestDepth_m = 0.05f;  // cells nearer than this may reach behind the camera's optical centre
constexpr float kPixel = 1.0f / CellEvidence::kTile_px;  // in tiles

}  // namespace

CellEvidence::CellEvidence(const MapConfig& config, const StereoGeometry& geometry, double nearest_m)
    : config_(config),
      geometry_(geometry),
      nearest_m_(std::max(static_cast<float>(nearest_m), kSmallestDepth_m)),
      min_rays_(config.min_ray_fraction * kTile_px * kTile_px) {
  const StereoCalibration& camera = geometry.calibration();
  centre_ = Eigen::Array3d(camera.cx_px, camera.cy_px, 0.0).cast<float>() * kPixel;
  last_ = Eigen::Array3i(camera.size_px.width - 1, camera.size_px.height - 1, 0).cast<float>() * kPixel;
}

void CellEvidence::look(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, bool clears) {
  clears_ = clears;
  const StereoCalibration& camera = geometry_.calibration();
  const Eigen::Vector3d focal(kPixel * camera.fx_px, kPixel * camera.fy_px, 1.0);
  T_P_M_ = focal.asDiagonal() * T_M_C.inverse().affine();
  const Eigen::Matrix3f edges = (T_P_M_.leftCols<3>() * config_.resolution_m).cast<float>();
  reach_ = 0.5f * edges.cwiseAbs().rowwise().sum();
  for (unsigned x = 0; x < EvidenceTree::kBlockCells; ++x) {
    for (unsigned y = 0; y < EvidenceTree::kBlockCells; ++y) {
      for (unsigned z = 0; z < EvidenceTree::kBlockCells; ++z) {
        const Eigen::Array3f corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        cells_.row(EvidenceTree::cellInBlock(x, y, z)) = edges * (corner + 0.5f).matrix();
      }
    }
  }
  countPoints(depth_m, T_M_C);
  if (clears) findLeast(depth_m);
}

/// Neighbouring pixels mostly fall into one block.
void CellEvidence::countPoints(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  points_.clear();
  const Eigen::Array3d camera = T_M_C.translation().array() / config_.resolution_m + EvidenceTree::kKeyOrigin;
  const Eigen::Matrix3d cells_per_px = T_M_C.linear() * geometry_.cameraMatrix().inverse() / config_.resolution_m;
  octomap::OcTreeKey last_block(0, 0, 0);
  EvidenceTree::Block<std::uint32_t>* points = nullptr;
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const double hit_m = geometry_.shiftedDepth<double>(depth_m.at<float>(v, u), config_.hit_band_px);
      if (!(hit_m <= config_.max_range_m)) continue;
      const Eigen::Array3d cell = camera + (cells_per_px * Eigen::Vector3d(u, v, 1.0)).array() * hit_m;
      if (!(cell >= 0.0).all() || !(cell < EvidenceTree::kLastKey + 1).all()) continue;
      const Eigen::Array<octomap::key_type, 3, 1> k = cell.cast<octomap::key_type>();
      const octomap::OcTreeKey block = EvidenceTree::blockOf({k[0], k[1], k[2]});
      if (!points || block != last_block) points = &points_[block];
      last_block = block;
      ++(*points)[EvidenceTree::cellInBlock(k[0], k[1], k[2])];
    }
  }
}

/// Of single tiles; larger squares follow when they are asked for.
void CellEvidence::findLeast(const cv::Mat& depth_m) {
  const cv::Size tiles((depth_m.cols + kTile_px - 1) / kTile_px, (depth_m.rows + kTile_px - 1) / kTile_px);
  cv::Mat1f least_m(tiles, std::numeric_limits<float>::infinity());
  cv::Mat1b rays(tiles, 0);
  float farthest_m = 0.0f;
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float surface_m = depth_m.at<float>(v, u);
      float& nearest_m = least_m(v / kTile_px, u / kTile_px);
      nearest_m = surface_m < nearest_m ? surface_m : nearest_m;
      farthest_m = surface_m > farthest_m ? surface_m : farthest_m;
      rays(v / kTile_px, u / kTile_px) += !std::isnan(surface_m);
    }
  }
  // The band keeps the order of depths: it is enough to shift each tile's nearest.
  for (float& nearest_m : least_m) nearest_m = geometry_.shiftedDepth(nearest_m, config_.free_band_px);
  farthest_m_ =
      std::min(geometry_.shiftedDepth(farthest_m, config_.free_band_px), static_cast<float>(config_.max_range_m));
  least_m_.assign(1, least_m);
  cv::integral(rays, rays_sum_, CV_32S);
}

bool CellEvidence::find(const octomap::OcTreeKey& block, EvidenceTree::Block<float>& log_odds) {
  const Eigen::Vector3d lowest(block[0], block[1], block[2]);
  const Eigen::Vector3d corner_M = (lowest.array() - EvidenceTree::kKeyOrigin) * config_.resolution_m;
  const Eigen::Vector3f corner = (T_P_M_ * corner_M.homogeneous()).cast<float>();
  log_odds.fill(0.0f);
  bool has_evidence = false;
  const auto add = [&](int cell, double evidence) {
    log_odds[static_cast<std::size_t>(cell)] = static_cast<float>(evidence);
    has_evidence = true;
  };
  if (clears_ && isInView(corner)) {
    project(corner);
    for (int cell = 0; cell < kCells; ++cell) {
      if (isFree(cell)) add(cell, config_.log_odds_miss);
    }
  }
  const auto points = points_.find(block);
  if (points == points_.end()) return has_evidence;
  for (int cell = 0; cell < kCells; ++cell) {
    const std::uint32_t count = points->second[static_cast<std::size_t>(cell)];
    if (isHit(count, corner.z() + cells_(cell, 2))) add(cell, config_.log_odds_hit);
  }
  return has_evidence;
}

/// @param depth_m of the cell's centre.
bool CellEvidence::isHit(std::uint32_t points, float depth_m) const {
  if (points < static_cast<std::uint32_t>(config_.min_hit_points) || depth_m <= 0.0f) return false;
  const StereoCalibration& camera = geometry_.calibration();
  const double face_px = camera.fx_px * camera.fy_px * std::pow(config_.resolution_m / depth_m, 2);
  return points >= config_.hit_fraction * face_px;
}

/// Whether some of a block may be: it is not all on the outer side of one of the view's faces.
bool CellEvidence::isInView(const Eigen::Vector3f& corner) const {
  const Eigen::Array3f middle = corner.array() + 0.5f * (cells_.row(0) + cells_.row(kCells - 1)).transpose();
  const Eigen::Array3f reach = reach_ * EvidenceTree::kBlockCells;
  const float far_m = middle.z() + reach.z();
  if (far_m < nearest_m_ || middle.z() - reach.z() > farthest_m_) return false;
  return (middle + reach + centre_ * far_m).head<2>().minCoeff() >= 0.0f &&
         (middle - reach + (centre_ - last_) * far_m).head<2>().maxCoeff() <= 0.0f;
}

/// Bounds of the images of the boxes: each by its side at its nearest or farthest depth. On the far sides with the next
/// pixel.
void CellEvidence::project(const Eigen::Vector3f& corner) {
  const auto near_m = cells_.col(2) + (corner.z() - reach_.z());
  far_m_ = cells_.col(2) + (corner.z() + reach_.z());
  inside_ = (near_m - nearest_m_).min(farthest_m_ - far_m_);
  per_near_ = near_m.max(kSmallestDepth_m).inverse();
  per_far_ = far_m_.inverse();
  for (const int axis : {0, 1}) {
    const auto low = cells_.col(axis) + (corner[axis] - reach_[axis]);
    const auto high = cells_.col(axis) + (corner[axis] + reach_[axis]);
    low_.col(axis) = (low * per_near_).min(low * per_far_) + centre_[axis];
    high_.col(axis) = (high * per_near_).max(high * per_far_) + centre_[axis];
    inside_ = inside_.min(low_.col(axis)).min(last_[axis] - high_.col(axis));
    high_.col(axis) = (high_.col(axis) + kPixel).min(last_[axis]);
  }
}

bool CellEvidence::isFree(int cell) {
  if (!(inside_[cell] >= 0.0f)) return false;
  const int left = static_cast<int>(low_(cell, 0)), top = static_cast<int>(low_(cell, 1));
  const int right = static_cast<int>(high_(cell, 0)) + 1, bottom = static_cast<int>(high_(cell, 1)) + 1;
  // Two squares cover a rectangle; they are larger than it if one would not do to half of it.
  const int width = right - left, height = bottom - top;
  const int side = std::max(std::min(width, height), (std::max(width, height) + 1) / 2);
  while (static_cast<int>(least_m_.size()) < side) addLargerSquares();
  const cv::Mat1f& least_m = least_m_[static_cast<std::size_t>(side) - 1];
  if (far_m_[cell] > least_m(top, left)) return false;
  if (far_m_[cell] > least_m(std::max(top, bottom - side), std::max(left, right - side))) return false;
  const int *above = rays_sum_[top], *below = rays_sum_[bottom];
  return below[right] - above[right] - below[left] + above[left] >= min_rays_ * (width * height);
}

void CellEvidence::addLargerSquares() {
  cv::Mat1f larger_m;
  cv::erode(least_m_.back(), larger_m, cv::Mat1b::ones(2, 2), cv::Point(0, 0));
  least_m_.push_back(larger_m);
}

}  // namespace flight_corridor
