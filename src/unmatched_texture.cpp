#include "flight_corridor/unmatched_texture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "flight_corridor/cross_sections.hpp"
#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr double kClear = 5.0;      // by how much clear texture exceeds what can be told from noise
constexpr float kFaintFits = 0.6f;  // least correlation of windows that fit whose texture is less: noise takes from it
constexpr int kAround_px = 32;      // so far beside a gap, or a pixel of it, surfaces are looked for
constexpr int kWitnesses = 2;       // neighbours that must lie on a surface on which a pixel fits
constexpr double kTold_px = 1.0;    // so near to the LiDAR's range a surface is what its beam met:
constexpr float kTold = 0.1f;       // what fits there may correlate by so much less than in the box
constexpr double kSlack_px = 4.0;   // matching moves the edges of a gap
constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

cv::Rect hull(const std::vector<cv::Rect>& areas) {
  cv::Rect hull;
  for (const cv::Rect& area : areas) hull |= area;
  return hull;
}

}  // namespace

/// Asks of each pixel of a row in turn where its content fits. One thread's.
class UnmatchedTexture::Search {
 public:
  Search(const StereoGeometry& geometry, const cv::Mat& matched_m, const WindowMatcher& matcher, double nearest_m,
         double farthest_m, double told_m)
      : geometry_(geometry),
        matched_m_(matched_m),
        matcher_(matcher),
        farthest_m_(farthest_m),
        told_px_(geometry.disparity(told_m)),
        farthest_px_(matcherDisparity(kSmallestScale * geometry.disparity(farthest_m))),
        nearest_px_(matcherDisparity(geometry.disparity(nearest_m))) {}

  /// Runs of a row's pixels without a match whose content the right camera should see.
  template <class Work>
  void forEachGap(int v, const Work& work) const {
    const auto* depth_m = matched_m_.ptr<float>(v);
    for (int first = 0; first < matched_m_.cols; ++first) {
      if (!std::isnan(depth_m[first])) continue;
      int end = first + 1;
      while (end < matched_m_.cols && std::isnan(depth_m[end])) ++end;
      if (!isHidden(depth_m, first, end)) work(first, end);
      first = end;
    }
  }

  float correlationInBox(int u, int v) { return matcher_.correlation(u, v, farthest_px_, nearest_px_, scratch_); }

  struct Fit {
    float depth_m = kNoDepth;
    float correlation = -1.0f;  // and what the LiDAR's word is worth
  };

  /// On the nearest of the surfaces around that lie behind the box, if at least two of the matches next to the pixel
  /// are of such surfaces.
  /// @param least_correlation of windows that fit.
  Fit behind(int u, int v, float least_correlation) {
    Fit fit;
    int witnesses = 0;
    std::optional<int> surface_px;
    float correlation = -1.0f;
    for (const float depth_m : depthsAround(u, v)) {
      if (!(depth_m * kSmallestScale > farthest_m_)) continue;
      if (const int next_px = matcherDisparity(geometry_.disparity(depth_m)); surface_px != next_px) {
        surface_px = next_px;
        correlation = correlationAt(u, v, next_px);
      }
      if (correlation < least_correlation) continue;
      ++witnesses;
      const bool is_told = std::abs(geometry_.disparity(depth_m) - told_px_) <= kTold_px;
      fit.correlation = std::max(fit.correlation, correlation + (is_told ? kTold : 0.0f));
      fit.depth_m = std::fmin(fit.depth_m, depth_m);
    }
    return witnesses >= kWitnesses ? fit : Fit();
  }

 private:
  /// Whether the right camera does not see what is in a gap: it is background behind the nearer surface on the gap's
  /// right, which hides as many columns as its disparity is larger, or lies beside that camera's image, on the left.
  bool isHidden(const float* depth_m, int first, int end) const {
    if (end == matched_m_.cols) return false;
    float background_m = first > 0 ? 0.0f : std::numeric_limits<float>::infinity();
    for (int u = std::max(first - kAround_px, 0); u < std::min(end + kAround_px, matched_m_.cols); ++u) {
      if (depth_m[u] > background_m) background_m = depth_m[u];
    }
    return geometry_.disparity(depth_m[end]) - geometry_.disparity(background_m) >= end - first - kSlack_px;
  }

  /// In whole pixels of the images, principal-point difference included.
  int matcherDisparity(double disparity_px) const {
    const double largest_px = matched_m_.cols;
    return static_cast<int>(std::floor(std::min(disparity_px, largest_px) + geometry_.principalPointDifference()));
  }

  /// Of the next matches to eight sides of a pixel; NaN where there is none.
  std::array<float, 8> depthsAround(int u, int v) const {
    const auto next = [&](int du, int dv) {
      for (int step = 1; step <= kAround_px; ++step) {
        const cv::Point at(u + step * du, v + step * dv);
        if (!cv::Rect({}, matched_m_.size()).contains(at)) break;
        if (const float depth_m = matched_m_.at<float>(at); !std::isnan(depth_m)) return depth_m;
      }
      return kNoDepth;
    };
    return {next(-1, 0), next(1, 0), next(0, -1), next(0, 1), next(-1, -1), next(1, -1), next(-1, 1), next(1, 1)};
  }

  /// Of the best of three windows that hold a pixel, in the middle and at either end: beside a picket one of them shows
  /// no other surface (Fusiello, Roberto and Trucco 1997).
  float correlationAt(int u, int v, int surface_px) {
    float best = -1.0f;
    for (const int shift : {0, -WindowMatcher::kReach_px, WindowMatcher::kReach_px}) {
      best = std::max(best, matcher_.correlation(u + shift, v, surface_px, surface_px + 1, scratch_));
    }
    return best;
  }

  const StereoGeometry& geometry_;
  const cv::Mat& matched_m_;
  const WindowMatcher& matcher_;
  double farthest_m_, told_px_;
  int farthest_px_, nearest_px_;
  std::vector<float> scratch_;
};

UnmatchedTexture::UnmatchedTexture(const StereoGeometry& geometry, const StereoFrame& pair, const Disparity& disparity,
                                   const cv::Mat& matched_m, double nearest_m, const Box& box_C, double told_m)
    : size_(geometry.size()) {
  const std::vector<cv::Rect> views = crossSections(box_C, geometry);
  area_ = hull(views);
  if (area_.empty()) return;
  unmatched_ = cv::Mat::zeros(area_.size(), CV_32FC1);
  background_ = cv::Mat::zeros(area_.size(), CV_8UC1);
  behind_m_ = cv::Mat(area_.size(), CV_32FC1, cv::Scalar(kNoDepth));
  cv::Mat broad_m = matched_m.clone();
  if (!disparity.small.empty()) broad_m.setTo(kNoDepth, disparity.small);
  const WindowMatcher matcher(pair.left, pair.right, {area_.y, area_.br().y});
  cv::parallel_for_({area_.y, area_.br().y}, [&](const cv::Range& rows) {
    Search search(geometry, broad_m, matcher, nearest_m, farthestCorner(box_C), told_m);
    for (int v = rows.start; v < rows.end; ++v) {
      search.forEachGap(v, [&](int first, int end) {
        for (int u = std::max(first, area_.x); u < std::min(end, area_.br().x); ++u) judge(u, v, disparity, search);
      });
    }
  });
  for (const cv::Rect& view : views) {
    const double least = disparity.least_texture * view.area();
    const double texture = std::max(cv::sum(disparity.texture(view))[0], least);
    if (texture > 0.0) share_ = std::max(share_, cv::sum(unmatched_(view - area_.tl()))[0] / texture);
  }
}

void UnmatchedTexture::judge(int u, int v, const Disparity& disparity, Search& search) {
  const float texture = disparity.texture.at<float>(v, u);
  if (!(texture >= disparity.least_texture)) return;
  const bool is_clear = texture >= kClear * disparity.least_texture;
  const Search::Fit behind = search.behind(u, v, is_clear ? WindowMatcher::kFits : kFaintFits);
  const bool is_behind = !std::isnan(behind.depth_m);
  if (!is_behind && !is_clear) return;
  const float in_box = search.correlationInBox(u, v);
  const cv::Point pixel = cv::Point(u, v) - area_.tl();
  if (is_behind && is_clear) background_.at<std::uint8_t>(pixel) = 255;
  if (is_behind && behind.correlation >= in_box) behind_m_.at<float>(pixel) = behind.depth_m;
  if (is_behind || in_box < WindowMatcher::kFits) return;
  unmatched_.at<float>(pixel) = texture;
}

cv::Mat UnmatchedTexture::image() const {
  cv::Mat image = cv::Mat::zeros(size_, CV_32FC1);
  if (!area_.empty()) unmatched_.copyTo(image(area_));
  return image;
}

void UnmatchedTexture::fill(DepthImages& depth) const {
  depth.background = cv::Mat::zeros(size_, CV_8UC1);
  if (area_.empty()) return;
  background_.copyTo(depth.background(area_));
  cv::Mat area_m = depth.filled_m(area_);
  behind_m_.copyTo(area_m, ~(area_m == area_m));  // NaN != NaN is false in OpenCV's vector code
}

}  // namespace flight_corridor
