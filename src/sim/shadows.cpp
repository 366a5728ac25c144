#include "sim/shadows.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor::sim {
namespace {

constexpr double kCell_m = 0.04;
constexpr float kBias_m =
    0.20f;  // more than a cell's slope, so that no surface shades itself; leaves let their neighbours shine

}  // namespace

Shadows::Shadows(const std::vector<Primitive>& primitives, const Eigen::Vector3d& to_sun_W,
                 const Eigen::AlignedBox3d& region_W)
    : T_S_W_(Eigen::Quaterniond::FromTwoVectors(to_sun_W, Eigen::Vector3d::UnitZ())) {
  const Eigen::AlignedBox3d region_S = region_W.transformed(T_S_W_);
  T_S_W_.pretranslate(-region_S.min());
  const Eigen::Vector3d size_m = region_S.sizes();
  height_m_ = cv::Mat(static_cast<int>(size_m.y() / kCell_m) + 1, static_cast<int>(size_m.x() / kCell_m) + 1, CV_32FC1,
                      cv::Scalar(-kInfinity));
  for (const Primitive& primitive : primitives) add(primitive);
}

float Shadows::lit(const Eigen::Vector3f& p_W) const {
  const Eigen::Vector3d p_S = T_S_W_ * p_W.cast<double>();
  const double u = p_S.x() / kCell_m, v = p_S.y() / kCell_m;
  if (!(0.0 <= u && u < height_m_.cols - 1 && 0.0 <= v && v < height_m_.rows - 1)) return 1.0f;
  const int column = static_cast<int>(u), row = static_cast<int>(v);
  const auto right = static_cast<float>(u - column), down = static_cast<float>(v - row);
  const auto reached = [&](int x, int y) {
    return height_m_.at<float>(row + y, column + x) < static_cast<float>(p_S.z()) + kBias_m ? 1.0f : 0.0f;
  };
  return (1.0f - down) * ((1.0f - right) * reached(0, 0) + right * reached(1, 0)) +
         down * ((1.0f - right) * reached(0, 1) + right * reached(1, 1));
}

void Shadows::add(const Primitive& primitive) {
  const Eigen::Isometry3d T_S_O = T_S_W_ * primitive.T_W_O;
  const Eigen::AlignedBox3d box_S = Eigen::AlignedBox3d(-primitive.half_m, primitive.half_m).transformed(T_S_O);
  const Eigen::Isometry3d T_O_S = T_S_O.inverse();
  const Eigen::Vector3f down_O = -T_O_S.linear().col(2).cast<float>();
  const auto top_m = static_cast<float>(box_S.max().z() + 1.0);
  const auto from = [](double low_m) { return std::max(static_cast<int>(std::ceil(low_m / kCell_m)), 0); };
  const auto until = [](double high_m, int size) {
    return std::min(static_cast<int>(std::floor(high_m / kCell_m)), size - 1);
  };
  for (int row = from(box_S.min().y()); row <= until(box_S.max().y(), height_m_.rows); ++row) {
    for (int column = from(box_S.min().x()); column <= until(box_S.max().x(), height_m_.cols); ++column) {
      const Eigen::Vector3d start_S(column * kCell_m, row * kCell_m, top_m);
      const auto hit = intersect(primitive, (T_O_S * start_S).cast<float>(), down_O);
      float& height_m = height_m_.at<float>(row, column);
      if (hit) height_m = std::max(height_m, top_m - hit->t);
    }
  }
}

}  // namespace flight_corridor::sim
