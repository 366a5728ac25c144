#include "flight_corridor/corridor/box_patches.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr double kSplitGain = 0.7;  // of the residual of one plane: what one half leaves, where it is another surface
constexpr double kFlat_px = 0.2;    // RMS about a plane, two sigma of a match: more may be two surfaces

}  // namespace

struct BoxPatches::Plane {
  Eigen::Vector3d coefficients;
  double rms_px;
  double at(const Point& point) const { return coefficients.dot(Eigen::Vector3d(point.u, point.v, 1.0)); }
};

BoxPatches::BoxPatches(const StereoGeometry& geometry) : geometry_(geometry) {}

const std::vector<BoxPatch>& BoxPatches::find(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& textured,
                                              double nearest_m, double smallest_m) {
  collect(box_C, depth_m, textured, nearest_m);
  label();
  members_.resize(std::max(members_.size(), patches_.size()));
  for (std::vector<Point>& members : members_) members.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    BoxPatch& patch = patches_[patch_[i]];
    const double pixel_m2 = point.edge_m * std::max<double>(point.edge_m, smallest_m / kEdgeWidth_px);
    patch.around_m2 += pixel_m2;
    if (point.is_in_middle) patch.in_middle_m2 += pixel_m2;
    if (!point.is_in_box) continue;
    patch.in_box_m2 += pixel_m2;
    ++patch.in_box_px;
    members_[patch_[i]].push_back(point);
  }
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    std::vector<Point>& members = members_[i];
    if (members.empty()) continue;
    Point *first = members.data(), *end = first + members.size();
    patches_[i].begin_m = begin(box_C, first, end, fit(first, end), smallest_m);
  }
  return patches_;
}

/// Matches without texture are chance: they are no hits.
void BoxPatches::collect(const Box& box_C, const cv::Mat& depth_m, const cv::Mat& textured, double nearest_m) {
  points_.clear();
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  const Eigen::Vector3d beside_m(kBeside_m, 2.0 * kBeside_m, 2.0 * kBeside_m);
  const Eigen::Vector3d around_m = box_C.size_m + beside_m, middle_m = (box_C.size_m - beside_m).cwiseMax(0.0);
  const double far_m = farthestCorner(box_C) + kBeside_m, fx_px = geometry_.calibration().fx_px;
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* depth = depth_m.ptr<float>(v);
    const std::uint8_t* is_textured = textured.ptr(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      if (!is_textured[u] || !(nearest_m <= depth[u] && depth[u] <= far_m)) continue;
      const double hit_m = geometry_.shiftedDepth<double>(depth[u], kMatchNoise_px);
      const Eigen::Vector3d point_F = T_F_C * geometry_.point(u, v, hit_m);
      if (!contains(around_m, point_F)) continue;
      points_.push_back({u, v, static_cast<float>(geometry_.disparity(depth[u])), static_cast<float>(depth[u] / fx_px),
                         contains(box_C.size_m, point_F), contains(middle_m, point_F)});
    }
  }
}

/// Neighbours of one surface, also across corners (union-find).
void BoxPatches::label() {
  const int width = geometry_.size().width;
  patch_.resize(points_.size());
  place_above_.assign(width + 2, -1);
  place_.assign(width + 2, -1);
  int row = -1;
  for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
    const Point& point = points_[i];
    if (point.v != row) {
      std::swap(place_, place_above_);
      if (point.v != row + 1) std::fill(place_above_.begin(), place_above_.end(), -1);
      std::fill(place_.begin(), place_.end(), -1);
      row = point.v;
    }
    patch_[i] = i;
    for (const int other :
         {place_[point.u], place_above_[point.u], place_above_[point.u + 1], place_above_[point.u + 2]}) {
      if (other < 0 || std::abs(points_[other].disparity_px - point.disparity_px) > kSameSurface_px) continue;
      const int one = rootOf(patch_, i), two = rootOf(patch_, other);
      patch_[std::max(one, two)] = std::min(one, two);
    }
    place_[point.u + 1] = i;
  }
  patches_.clear();
  for (int i = 0; i < static_cast<int>(points_.size()); ++i) {  // a root is the first of its patch
    const int first = patch_[i];
    if (first == i) patches_.emplace_back();
    patch_[i] = first == i ? static_cast<int>(patches_.size()) - 1 : patch_[first];
  }
}

/// Least squares; flat where the points do not span a plane.
BoxPatches::Plane BoxPatches::fit(const Point* first, const Point* end) const {
  const double n = static_cast<double>(end - first), u0 = first->u, v0 = first->v;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (const Point* point = first; point != end; ++point) {
    const Eigen::Vector3d at(point->u - u0, point->v - v0, 1.0);
    normal += at * at.transpose();
    right += at * point->disparity_px;
    squares += static_cast<double>(point->disparity_px) * point->disparity_px;
  }
  normal(0, 0) += 1e-3 * n;
  normal(1, 1) += 1e-3 * n;
  Plane plane;
  plane.coefficients = normal.ldlt().solve(right);
  plane.rms_px = std::sqrt(std::max(0.0, (squares - plane.coefficients.dot(right)) / n));
  plane.coefficients.z() -= plane.coefficients.x() * u0 + plane.coefficients.y() * v0;
  return plane;
}

/// Where the nearest of the planes begins: points that are no plane are parted at the middle of their longer side,
/// where one half is flatter than the whole. Of mere noise none is.
double BoxPatches::begin(const Box& box_C, Point* first, Point* end, const Plane& plane, double smallest_m) const {
  const double smallest_px = smallest_m / first->edge_m;
  if (plane.rms_px > kFlat_px && static_cast<double>(end - first) >= 2.0 * std::max(4.0, smallest_px * smallest_px)) {
    const auto by_u = [](const Point& one, const Point& other) { return one.u < other.u; };
    const auto by_v = [](const Point& one, const Point& other) { return one.v < other.v; };
    const auto across = std::minmax_element(first, end, by_u), along = std::minmax_element(first, end, by_v);
    Point* middle = first + (end - first) / 2;
    if (across.second->u - across.first->u > along.second->v - along.first->v) {
      std::nth_element(first, middle, end, by_u);
    } else {
      std::nth_element(first, middle, end, by_v);
    }
    const Plane one = fit(first, middle), other = fit(middle, end);
    if (std::min(one.rms_px, other.rms_px) < kSplitGain * plane.rms_px) {
      return std::min(begin(box_C, first, middle, one, smallest_m), begin(box_C, middle, end, other, smallest_m));
    }
  }
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  double begin_m = kInfinity;
  for (const Point* point = first; point != end; ++point) {
    const Eigen::Vector3d point_F = T_F_C * geometry_.point(point->u, point->v, geometry_.depth(plane.at(*point)));
    begin_m = std::min(begin_m, point_F.x());
  }
  return std::clamp(begin_m, 0.0, box_C.size_m.x());
}

}  // namespace flight_corridor
