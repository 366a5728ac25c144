#include "flight_corridor/unmatched_texture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace flight_corridor {

namespace {

constexpr double kClear = 5.0;     // by how much clear texture exceeds what can be told from noise
constexpr double kSlack_px = 6.0;  // matching moves both edges of a gap
constexpr int kSections = 16;      // of a box, equally far apart

double sumOver(const cv::Mat& integral, const cv::Rect& area) {
  return integral.at<double>(area.br().y, area.br().x) - integral.at<double>(area.y, area.br().x) -
         integral.at<double>(area.br().y, area.x) + integral.at<double>(area.y, area.x);
}

}  // namespace

void UnmatchedTexture::find(const Disparity& disparity, const cv::Mat& depth_m) {
  least_texture_ = disparity.least_texture;
  unmatched_ = cv::Mat::zeros(depth_m.size(), CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    addRow(depth_m.ptr<float>(v), disparity.texture.ptr<float>(v), depth_m.cols,
           static_cast<float>(kClear * least_texture_), unmatched_.ptr<float>(v));
  }
  cv::integral(disparity.texture, texture_sum_, CV_64F);
  cv::integral(unmatched_, unmatched_sum_, CV_64F);
}

/// Gap by gap: a run of pixels without depth.
void UnmatchedTexture::addRow(const float* depth_m, const float* texture, int cols, float least,
                              float* unmatched) const {
  for (int first = 0; first < cols; ++first) {
    if (!std::isnan(depth_m[first])) continue;
    int last = first;
    while (last + 1 < cols && std::isnan(depth_m[last + 1])) ++last;
    const float before_m = first > 0 ? depth_m[first - 1] : NAN, after_m = last + 1 < cols ? depth_m[last + 1] : NAN;
    if (!isHidden(last + 1 - first, before_m, after_m)) {
      for (int u = first; u <= last; ++u) unmatched[u] = texture[u] >= least ? texture[u] : 0.0f;
    }
    first = last;
  }
}

/// Whether the right camera does not see what is in a gap: it lies beside that camera's image, at the left border, or
/// behind the nearer surface on the gap's right, which hides as many columns as its disparity is larger.
bool UnmatchedTexture::isHidden(int width_px, float before_m, float after_m) const {
  if (std::isnan(before_m)) return true;
  return geometry_.disparity(after_m) - geometry_.disparity(before_m) >= width_px - kSlack_px;  // false for NaN
}

double UnmatchedTexture::share(const Box& box_C) const {
  double largest = 0.0;
  if (texture_sum_.empty()) return largest;
  for (int i = 1; i <= kSections; ++i) {
    const cv::Rect area = view(box_C, box_C.size_m.x() * i / kSections);
    const double texture = std::max(sumOver(texture_sum_, area), least_texture_ * area.area());
    if (texture > 0.0) largest = std::max(largest, sumOver(unmatched_sum_, area) / texture);
  }
  return largest;
}

/// Pixels of the rectangle around a cross-section of a box; none where it reaches behind the camera.
cv::Rect UnmatchedTexture::view(const Box& box_C, double x_m) const {
  Eigen::AlignedBox2d view;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner_F(x_m, (i & 1 ? 0.5 : -0.5) * box_C.size_m.y(),
                                   (i & 2 ? 0.5 : -0.5) * box_C.size_m.z());
    const Eigen::Vector2d pixel = geometry_.project(box_C.T_M_F * corner_F);
    if (pixel.hasNaN()) return {};
    view.extend(pixel);
  }
  const cv::Size size = geometry_.size();
  const Eigen::AlignedBox2d image(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(size.width, size.height));
  const Eigen::AlignedBox2d seen = view.intersection(image);
  if (seen.isEmpty()) return {};
  const Eigen::Vector2i first = seen.min().cast<int>(), last = seen.max().cast<int>();
  return {first.x(), first.y(), last.x() - first.x(), last.y() - first.y()};
}

}  // namespace flight_corridor
