#include "flight_corridor/corridor/box_patches.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr double kSplitGain = 0.7;  // of the residual of one plane: what one half leaves, where it is another surface
constexpr double kFlat_px = 0.2;    // RMS about a plane, two sigma of a match: more may be two surfaces
constexpr double kPiece_m = 1.0;    // of a surface: a wider one is more than one plane
constexpr std::ptrdiff_t kFitted = 2000;  // points of a plane are enough
constexpr double kLarge_m2 = 0.035;       // shown of a patch in and near the box: a smaller one the next image may lose
constexpr double kKept = 4.0;             // points across the smallest obstacle are remembered

}  // namespace

struct BoxPatches::Plane {
  Eigen::Vector3d coefficients;
  double rms_px;
  double at(const Point& point) const { return coefficients.dot(Eigen::Vector3d(point.u, point.v, 1.0)); }
};

bool BoxPatch::isMissable() const { return around_m2 < kLarge_m2 || in_middle_m2 < kLarge_m2; }

void shorten(const Fan& fan, const Eigen::Isometry3f& T_F_P, const std::vector<PatchPoint>& points_P, double smallest_m,
             std::vector<double>& free_m) {
  std::vector<BoxPatch> patches(fan.size());
  for (const PatchPoint& point : points_P) {
    fan.visit(T_F_P * point.at, 0.0f, [&](int direction, const Eigen::Vector3f& at) {
      BoxPatch& patch = patches[direction];
      patch.in_box_m2 += point.shown_m2;
      patch.begin_m = std::min<double>(patch.begin_m, at.x());
    });
  }
  for (int i = 0; i < fan.size(); ++i) {
    if (patches[i].blocks(smallest_m * smallest_m)) free_m[i] = std::min(free_m[i], patches[i].begin_m);
  }
}

BoxPatches::BoxPatches(const StereoGeometry& geometry) : geometry_(geometry) {}

const std::vector<std::vector<BoxPatch>>& BoxPatches::find(const Fan& fan, const cv::Mat& depth_m,
                                                           const cv::Mat& textured, double nearest_m, double smallest_m,
                                                           double beside_m) {
  collect(fan, depth_m, textured, nearest_m);
  label();
  sort();
  found_.resize(fan.size());
  for (std::vector<BoxPatch>& patches : found_) patches.clear();
  blocking_C_.clear();
  missable_C_.clear();
  for (std::size_t patch = 0; patch + 1 < begins_.size(); ++patch) {
    Point *first = sorted_.data() + begins_[patch], *end = sorted_.data() + begins_[patch + 1];
    fitPlanes(first, end, fit(first, end), smallest_m);
    measure(fan, first, end, smallest_m, static_cast<float>(beside_m));
  }
  return found_;
}

/// Matches without texture are chance: they are no hits.
void BoxPatches::collect(const Fan& fan, const cv::Mat& depth_m, const cv::Mat& textured, double nearest_m) {
  points_.clear();
  const double end_m = fan.farthestCorner(), fx_px = geometry_.calibration().fx_px;
  const double far_m = std::max(end_m + kBeside_m, geometry_.shiftedDepth(end_m, -kMatchNoise_px));
  for (int v = 0; v < depth_m.rows; ++v) {
    const auto* depth = depth_m.ptr<float>(v);
    const std::uint8_t* is_textured = textured.ptr(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      if (!is_textured[u] || !(nearest_m <= depth[u] && depth[u] <= far_m)) continue;
      const double hit_m = geometry_.shiftedDepth<double>(depth[u], kMatchNoise_px);
      const Eigen::Vector3f hit_F = fan.T_F_C() * geometry_.point(u, v, hit_m).cast<float>();
      bool is_near = false;
      fan.visit(hit_F, kBeside_m, [&](int, const Eigen::Vector3f&) { is_near = true; });
      if (!is_near) continue;
      points_.push_back(
          {u, v, static_cast<float>(geometry_.disparity(depth[u])), static_cast<float>(depth[u] / fx_px), hit_F, 0.0f});
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
}

/// A patch's points side by side, still in the order of the pixels.
void BoxPatches::sort() {
  begins_.assign(1, 0);                                         // first counts, then ends, then begins
  for (int i = 0; i < static_cast<int>(points_.size()); ++i) {  // a root is the first of its patch
    const int first = patch_[i];
    if (first == i) begins_.push_back(0);
    patch_[i] = first == i ? static_cast<int>(begins_.size()) - 2 : patch_[first];
    ++begins_[patch_[i]];
  }
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  sorted_.resize(points_.size());
  for (std::size_t i = points_.size(); i-- > 0;) sorted_[--begins_[patch_[i]]] = points_[i];
}

/// What a patch shows in each box.
void BoxPatches::measure(const Fan& fan, const Point* first, const Point* end, double smallest_m, float beside_m) {
  sums_.assign(fan.size(), {});
  const Eigen::Array3f size_m = fan.box().size_m.cast<float>();
  const Eigen::Array3f middle_m = Eigen::Array3f(size_m.x(), 0.5f * size_m.y(), 0.5f * size_m.z()) - beside_m;
  for (const Point* point = first; point != end; ++point) {
    const double pixel_m2 = point->edge_m * std::max<double>(point->edge_m, smallest_m / kEdgeWidth_px);
    const Eigen::Vector3f fitted_F =
        fan.T_F_C() * geometry_.point(point->u, point->v, geometry_.depth(point->fitted_px)).cast<float>();
    fan.visit(point->hit_F, beside_m, [&](int direction, const Eigen::Vector3f& hit) {
      BoxPatch& sum = sums_[direction];
      sum.around_m2 += pixel_m2;
      if (!fan.contains(hit)) return;
      sum.in_box_m2 += pixel_m2;
      ++sum.in_box_px;
      sum.begin_m = std::min<double>(sum.begin_m, fan.turned(direction, fitted_F).x());
      if (hit.x() < middle_m.x() && std::abs(hit.y()) <= middle_m.y() && std::abs(hit.z()) <= middle_m.z()) {
        sum.in_middle_m2 += pixel_m2;
      }
    });
  }
  bool is_missable = false;
  for (int direction = 0; direction < fan.size(); ++direction) {
    BoxPatch& sum = sums_[direction];
    if (!(sum.around_m2 > 0.0)) continue;
    if (sum.in_box_px > 0) sum.begin_m = std::clamp<double>(sum.begin_m, 0.0, size_m.x());
    found_[direction].push_back(sum);
    if (!sum.blocks(smallest_m * smallest_m)) continue;
    if (direction == 0) keep(fan, first, end);
    is_missable |= sum.isMissable();
  }
  if (is_missable) keepMissable(fan, first, end, smallest_m);
}

/// Every n-th point, which stands for n.
void BoxPatches::keepMissable(const Fan& fan, const Point* first, const Point* end, double smallest_m) {
  const Eigen::Isometry3f T_C_F = fan.T_F_C().inverse();
  double due = 0.0;
  for (const Point* point = first; point != end; ++point) {
    bool is_kept = false;
    fan.visit(point->hit_F, 0.0f, [&](int direction, const Eigen::Vector3f&) {
      is_kept |= sums_[direction].blocks(smallest_m * smallest_m) && sums_[direction].isMissable();
    });
    const double step = std::max(1.0, smallest_m / (kKept * point->edge_m));
    if (is_kept) due += 1.0 / step;
    if (due < 1.0) continue;
    due -= 1.0;
    const double pixel_m2 = point->edge_m * std::max<double>(point->edge_m, smallest_m / kEdgeWidth_px);
    missable_C_.push_back({T_C_F * point->hit_F, static_cast<float>(step * pixel_m2)});
  }
}

/// A patch's points in the first direction's box.
void BoxPatches::keep(const Fan& fan, const Point* first, const Point* end) {
  for (const Point* point = first; point != end; ++point) {
    if (!fan.contains(fan.turned(0, point->hit_F))) continue;
    blocking_C_.push_back(geometry_.point(point->u, point->v, geometry_.depth(point->disparity_px + kMatchNoise_px)));
  }
}

/// Least squares, of some of many points; flat where they do not span a plane.
BoxPatches::Plane BoxPatches::fit(const Point* first, const Point* end) {
  const std::ptrdiff_t step = 1 + (end - first) / kFitted;
  const double u0 = first->u, v0 = first->v;
  double n = 0.0, squares = 0.0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::ptrdiff_t i = 0; i < end - first; i += step) {
    const Point& point = first[i];
    const Eigen::Vector3d at(point.u - u0, point.v - v0, 1.0);
    normal += at * at.transpose();
    right += at * point.disparity_px;
    squares += static_cast<double>(point.disparity_px) * point.disparity_px;
    n += 1.0;
  }
  normal(0, 0) += 1e-3 * n;
  normal(1, 1) += 1e-3 * n;
  Plane plane;
  plane.coefficients = normal.ldlt().solve(right);
  plane.rms_px = std::sqrt(std::max(0.0, (squares - plane.coefficients.dot(right)) / n));
  plane.coefficients.z() -= plane.coefficients.x() * u0 + plane.coefficients.y() * v0;
  return plane;
}

/// Points that are wider than a piece, or no plane, are parted at the middle of their longer side; the latter where one
/// half is flatter than the whole. Of mere noise none is.
void BoxPatches::fitPlanes(Point* first, Point* end, const Plane& plane, double smallest_m) {
  const auto by_u = [](const Point& one, const Point& other) { return one.u < other.u; };
  const auto by_v = [](const Point& one, const Point& other) { return one.v < other.v; };
  const auto across = std::minmax_element(first, end, by_u), along = std::minmax_element(first, end, by_v);
  const int width_px = across.second->u - across.first->u, height_px = along.second->v - along.first->v;
  const double smallest_px = smallest_m / first->edge_m;
  const bool is_wide = std::max(width_px, height_px) * first->edge_m > kPiece_m;
  const bool is_enough = static_cast<double>(end - first) >= 2.0 * std::max(4.0, smallest_px * smallest_px);
  if (is_enough && (is_wide || plane.rms_px > kFlat_px)) {
    Point* middle = first + (end - first) / 2;
    if (width_px > height_px) {
      std::nth_element(first, middle, end, by_u);
    } else {
      std::nth_element(first, middle, end, by_v);
    }
    const Plane one = fit(first, middle), other = fit(middle, end);
    if (is_wide || std::min(one.rms_px, other.rms_px) < kSplitGain * plane.rms_px) {
      fitPlanes(first, middle, one, smallest_m);
      fitPlanes(middle, end, other, smallest_m);
      return;
    }
  }
  for (Point* point = first; point != end; ++point) point->fitted_px = static_cast<float>(plane.at(*point));
}

}  // namespace flight_corridor
