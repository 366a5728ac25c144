#include "flight_corridor/island_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/window_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr int kLargest_px = 200;    // pixels of an island: larger ones are taken at their word
constexpr int kStep_px = 2;         // at most between neighbours of one island
constexpr int kSameSurface_px = 3;  // from a surface of which an island is a part, seen through a gap
constexpr int kAround_px = 32;      // so far beside an island its surroundings are looked at
constexpr double kSurface = 0.05;   // of the matches there are a surface
constexpr double kFits = 0.3;       // of an island's pixels fit on the surface that it is of; of a small thing's 0.2
constexpr int kFixedPoint = 16;
constexpr std::int16_t kNone = std::numeric_limits<std::int16_t>::min();

}  // namespace

void IslandFilter::filter(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px) {
  const std::vector<Island> islands = findIslands(disparity_px);
  if (islands.empty()) return;
  const WindowMatcher matcher(left, right, {0, left.rows});
  for (const Island& island : islands) {
    const std::vector<int> surfaces_px = surfacesAround(island, meanDisparity(island, disparity_px));
    const bool is_mistake = std::any_of(surfaces_px.begin(), surfaces_px.end(),
                                        [&](int surface_px) { return fits(island, matcher, surface_px); });
    if (!is_mistake) continue;
    cv::Mat part = disparity_px(island.box);
    part.setTo(std::numeric_limits<float>::quiet_NaN(), labels_(island.box) == island.label);
  }
}

/// Leaves what is no island in fixed_, the islands in labels_.
std::vector<IslandFilter::Island> IslandFilter::findIslands(const cv::Mat& disparity_px) {
  const cv::Mat matched = disparity_px == disparity_px;
  disparity_px.convertTo(fixed_, CV_16S, kFixedPoint);
  fixed_.setTo(kNone, ~matched);
  cv::filterSpeckles(fixed_, kNone, kLargest_px, kStep_px * kFixedPoint, speckles_);
  cv::bitwise_and(matched, fixed_ == kNone, islands_);
  const int count = cv::connectedComponentsWithStats(islands_, labels_, stats_, centroids_, 4);
  std::vector<Island> islands;
  for (int label = 1; label < count; ++label) {
    const int* stats = stats_.ptr<int>(label);
    islands.push_back(
        {label,
         stats[cv::CC_STAT_AREA],
         {stats[cv::CC_STAT_LEFT], stats[cv::CC_STAT_TOP], stats[cv::CC_STAT_WIDTH], stats[cv::CC_STAT_HEIGHT]}});
  }
  return islands;
}

int IslandFilter::meanDisparity(const Island& island, const cv::Mat& disparity_px) const {
  return static_cast<int>(std::floor(cv::mean(disparity_px(island.box), labels_(island.box) == island.label)[0]));
}

/// Disparities of the surfaces around an island, in whole pixels; none where it may be a part of one of them.
std::vector<int> IslandFilter::surfacesAround(const Island& island, int island_px) {
  const cv::Point reach(kAround_px, kAround_px);
  const cv::Rect around = cv::Rect(island.box.tl() - reach, island.box.br() + reach) & cv::Rect({}, fixed_.size());
  matches_.clear();
  int total = 0;
  for (int v = around.y; v < around.br().y; ++v) {
    const auto* fixed = fixed_.ptr<std::int16_t>(v);
    for (int u = around.x; u < around.br().x; ++u) {
      if (fixed[u] == kNone) continue;
      ++matches_[static_cast<int>(std::floor(static_cast<double>(fixed[u]) / kFixedPoint))];
      ++total;
    }
  }
  std::vector<int> surfaces_px;
  for (const auto& [surface_px, matches] : matches_) {
    if (matches < kSurface * total) continue;
    if (std::abs(surface_px - island_px) <= kSameSurface_px) return {};
    surfaces_px.push_back(surface_px);
  }
  return surfaces_px;
}

bool IslandFilter::fits(const Island& island, const WindowMatcher& matcher, int surface_px) {
  int fitting = 0;
  for (int v = island.box.y; v < island.box.br().y; ++v) {
    const auto* label = labels_.ptr<int>(v);
    for (int u = island.box.x; u < island.box.br().x; ++u) {
      fitting += label[u] == island.label && matcher.fits(u, v, surface_px, surface_px + 1, scratch_);
    }
  }
  return fitting >= kFits * island.area_px;
}

}  // namespace flight_corridor
