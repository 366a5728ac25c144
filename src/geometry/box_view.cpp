#include "flight_corridor/geometry/box_view.hpp"

#include <algorithm>
#include <limits>

namespace flight_corridor {

namespace {

constexpr double kNearestSeen_m = 1e-3;  // so near nothing is seen, and f*B/Z is a number still

}  // namespace

/// Slabs (Kay and Kajiya 1986): a ray is in the box where it is between all three pairs of sides.
void BoxView::look(const Box& box_C, double nearest_m) {
  if (nearest_m == nearest_m_ && box_C.T_M_F.matrix() == T_C_F_.matrix() && box_C.size_m == size_m_) return;
  T_C_F_ = box_C.T_M_F;
  size_m_ = box_C.size_m;
  nearest_m_ = nearest_m;
  entry_px_.create(geometry_.size(), CV_32FC1);
  exit_px_.create(geometry_.size(), CV_32FC1);
  const Eigen::Isometry3d T_F_C = box_C.T_M_F.inverse();
  const Eigen::Array3d low(0.0, -0.5 * size_m_.y(), -0.5 * size_m_.z()), high(size_m_.x(), -low.y(), -low.z());
  const Eigen::Array3d to_low = low - T_F_C.translation().array(), to_high = high - T_F_C.translation().array();
  for (int v = 0; v < geometry_.size().height; ++v) {
    for (int u = 0; u < geometry_.size().width; ++u) {
      const Eigen::Array3d ray_F = T_F_C.linear() * geometry_.point(u, v, 1.0);
      const Eigen::Array3d one_m = to_low / ray_F, other_m = to_high / ray_F;  // depths; NaN along a side
      const double entry_m = std::max({kNearestSeen_m, nearest_m, one_m.min(other_m).maxCoeff()});
      const double exit_m = one_m.max(other_m).minCoeff();
      const bool meets = entry_m < exit_m;
      constexpr float kInf = std::numeric_limits<float>::infinity();
      entry_px_.at<float>(v, u) = meets ? static_cast<float>(geometry_.disparity(entry_m)) : -kInf;
      exit_px_.at<float>(v, u) = meets ? static_cast<float>(geometry_.disparity(exit_m)) : -kInf;
    }
  }
}

}  // namespace flight_corridor
