#include "flight_corridor/unmatched_texture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flight_corridor/cross_sections.hpp"
#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr double kClear = 5.0;     // by how much clear texture exceeds what can be told from noise
constexpr int kAround_px = 32;     // so far beside a gap, or a pixel of it, surfaces are looked for
constexpr int kWitnesses = 2;      // neighbours that must lie on a surface on which a pixel fits
constexpr double kSlack_px = 4.0;  // matching moves the edges of a gap
constexpr double kScale = 0.9;     // smallest factor that the depth's scale may be wrong by

double sumOver(const cv::Mat& integral, const cv::Rect& area) {
  return integral.at<double>(area.br().y, area.br().x) - integral.at<double>(area.y, area.br().x) -
         integral.at<double>(area.br().y, area.x) + integral.at<double>(area.y, area.x);
}

cv::Rect hull(const std::vector<cv::Rect>& areas) {
  cv::Rect hull;
  for (const cv::Rect& area : areas) hull |= area;
  return hull;
}

double farthestDepth(const Box& box_C) {
  double farthest_m = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 1.0 : 0.0, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    farthest_m = std::max(farthest_m, (box_C.T_M_F * box_C.size_m.cwiseProduct(corner)).z());
  }
  return farthest_m;
}

}  // namespace

UnmatchedTexture::UnmatchedTexture(const StereoGeometry& geometry, const StereoFrame& pair, const Disparity& disparity,
                                   const cv::Mat& matched_m, double nearest_m)
    : geometry_(geometry), pair_(pair), disparity_(disparity), matched_m_(matched_m.clone()), nearest_m_(nearest_m) {
  if (!disparity.small.empty()) matched_m_.setTo(std::numeric_limits<float>::quiet_NaN(), disparity.small);
}

double UnmatchedTexture::share(const Box& box_C) const {
  const std::vector<cv::Rect> views = crossSections(box_C, geometry_);
  const cv::Rect all = hull(views);
  if (all.empty()) return 0.0;
  cv::Mat texture_sum, unmatched_sum;
  cv::integral(disparity_.texture(all), texture_sum, CV_64F);
  cv::integral(unmatched(all, farthestDepth(box_C)), unmatched_sum, CV_64F);
  double largest = 0.0;
  for (const cv::Rect& view : views) {
    const cv::Rect area = view - all.tl();
    const double texture = std::max(sumOver(texture_sum, area), disparity_.least_texture * area.area());
    if (texture > 0.0) largest = std::max(largest, sumOver(unmatched_sum, area) / texture);
  }
  return largest;
}

cv::Mat UnmatchedTexture::image(const Box& box_C) const {
  cv::Mat image = cv::Mat::zeros(geometry_.size(), CV_32FC1);
  const cv::Rect all = hull(crossSections(box_C, geometry_));
  if (!all.empty()) unmatched(all, farthestDepth(box_C)).copyTo(image(all));
  return image;
}

/// Texture of an area where it is unmatched, elsewhere 0.
cv::Mat UnmatchedTexture::unmatched(const cv::Rect& area, double farthest_m) const {
  const WindowMatcher matcher(pair_.left, pair_.right, {area.y, area.br().y});
  const int farthest_px = matcherDisparity(kScale * geometry_.disparity(farthest_m));
  const int nearest_px = matcherDisparity(geometry_.disparity(nearest_m_));
  cv::Mat unmatched = cv::Mat::zeros(area.size(), CV_32FC1);
  cv::parallel_for_({area.y, area.br().y}, [&](const cv::Range& rows) {
    std::vector<float> scratch;
    for (int v = rows.start; v < rows.end; ++v) {
      const auto* texture = disparity_.texture.ptr<float>(v);
      auto* out = unmatched.ptr<float>(v - area.y);
      const auto fitsBehind = [&](int u) {
        const std::array<float, 4> around_m = depthsAround(u, v);
        const auto fitting = std::count_if(around_m.begin(), around_m.end(), [&](float depth_m) {
          if (!(depth_m * kScale > farthest_m)) return false;
          const int surface_px = matcherDisparity(geometry_.disparity(depth_m));
          return matcher.fits(u, v, surface_px, surface_px + 1, scratch);
        });
        return fitting >= kWitnesses;
      };
      forEachGap(v, [&](int first, int end) {
        for (int u = std::max(first, area.x); u < std::min(end, area.br().x); ++u) {
          const bool is_clear = texture[u] >= kClear * disparity_.least_texture;
          if (is_clear && matcher.fits(u, v, farthest_px, nearest_px, scratch) && !fitsBehind(u)) {
            out[u - area.x] = texture[u];
          }
        }
      });
    }
  });
  return unmatched;
}

/// In whole pixels of the images, principal-point difference included.
int UnmatchedTexture::matcherDisparity(double disparity_px) const {
  const double largest_px = matched_m_.cols;
  return static_cast<int>(std::floor(std::min(disparity_px, largest_px) + geometry_.principalPointDifference()));
}

/// Of the next matches to the left and right of a pixel, above and below; NaN where there is none.
std::array<float, 4> UnmatchedTexture::depthsAround(int u, int v) const {
  const auto next = [&](int du, int dv) {
    for (int step = 1; step <= kAround_px; ++step) {
      const cv::Point at(u + step * du, v + step * dv);
      if (!cv::Rect({}, matched_m_.size()).contains(at)) break;
      if (const float depth_m = matched_m_.at<float>(at); !std::isnan(depth_m)) return depth_m;
    }
    return std::numeric_limits<float>::quiet_NaN();
  };
  return {next(-1, 0), next(1, 0), next(0, -1), next(0, 1)};
}

/// Runs of a row's pixels without a match whose content the right camera should see.
template <class Work>
void UnmatchedTexture::forEachGap(int v, const Work& work) const {
  const auto* depth_m = matched_m_.ptr<float>(v);
  for (int first = 0; first < matched_m_.cols; ++first) {
    if (!std::isnan(depth_m[first])) continue;
    int end = first + 1;
    while (end < matched_m_.cols && std::isnan(depth_m[end])) ++end;
    if (!isHidden(depth_m, first, end)) work(first, end);
    first = end;
  }
}

/// Whether the right camera does not see what is in a gap: it is background behind the nearer surface on the gap's
/// right, which hides as many columns as its disparity is larger, or lies beside that camera's image, on the left.
bool UnmatchedTexture::isHidden(const float* depth_m, int first, int end) const {
  if (end == matched_m_.cols) return false;
  float background_m = first > 0 ? 0.0f : std::numeric_limits<float>::infinity();
  for (int u = std::max(first - kAround_px, 0); u < std::min(end + kAround_px, matched_m_.cols); ++u) {
    if (depth_m[u] > background_m) background_m = depth_m[u];
  }
  return geometry_.disparity(depth_m[end]) - geometry_.disparity(background_m) >= end - first - kSlack_px;
}

}  // namespace flight_corridor
