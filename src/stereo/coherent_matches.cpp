#include "flight_corridor/stereo/coherent_matches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace flight_corridor {

namespace {

constexpr float kStep_px = 1.0f;  // between neighbours of one surface: noise and slope
constexpr float kOutline_px = 9;  // width of what is matched along an outline: that of the census window
constexpr int kBand_px = 60;      // rows that are labelled side by side with others
constexpr int kNone = -1;         // the label where nothing is matched

bool isOneSurface(float one_px, float other_px) { return std::abs(one_px - other_px) <= kStep_px; }  // not of NaN

}  // namespace

CoherentMatches::CoherentMatches(const StereoGeometry& geometry, double smallest_obstacle_m, int threads)
    : geometry_(geometry),
      width_(geometry.size().width),
      bands_((geometry.size().height + kBand_px - 1) / kBand_px),
      smallest_m_(smallest_obstacle_m),
      matches_px_(geometry.size(), CV_32FC1),
      labels_(static_cast<std::size_t>(geometry.size().area())),
      parents_(labels_.size()),
      areas_(labels_.size()),
      kept_(static_cast<std::size_t>(bands_)),
      workers_(std::min(threads, bands_)) {}

int CoherentMatches::keep(cv::Mat& best_px, cv::Mat& repeated_px) {
  const int height = geometry_.size().height;
  const auto firstRow = [&](int band) { return std::min(band * kBand_px, height); };
  workers_.run(bands_, [&](int band, int) {
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) {
      labelRow(v, best_px, repeated_px);
      if (v > firstRow(band)) joinWithAbove(v);
    }
    for (int label = firstRow(band) * width_; label < firstRow(band + 1) * width_; ++label) {
      if (labels_[label] == label) parents_[label] = root(label);  // so the way to a root is short from here on
    }
  });
  for (int band = 1; band < bands_; ++band) joinWithAbove(firstRow(band));
  workers_.run(bands_, [&](int band, int) {
    kept_[band] = 0;
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) kept_[band] += keepRow(v, best_px, repeated_px);
  });
  return std::accumulate(kept_.begin(), kept_.end(), 0);
}

/// A run is a patch of its own yet. Its area is that of its pixels, each at its own distance. What is bare has matches
/// on its outline alone: a strip as wide as the outline counts as if it were as wide as the smallest obstacle.
void CoherentMatches::labelRow(int v, const cv::Mat& best_px, const cv::Mat& repeated_px) {
  const auto *best = best_px.ptr<float>(v), *repeated = repeated_px.ptr<float>(v);
  auto* row = matches_px_.ptr<float>(v);
  for (int u = 0; u < width_; ++u) row[u] = std::isnan(best[u]) ? repeated[u] : best[u];
  int* labels = &labels_[static_cast<std::size_t>(v) * width_];
  for (int first = 0, end = 0; first < width_; first = end) {
    const int label = v * width_ + first;
    if (std::isnan(row[first])) {
      labels[end++] = kNone;
      continue;
    }
    Area area;
    do {
      labels[end] = label;
      const double edge_m = geometry_.pixelEdge(row[end]);
      const double pixel_m2 = edge_m * std::max(edge_m, smallest_m_ / kOutline_px);
      area.all_m2 += pixel_m2;
      if (std::isnan(best[end])) area.repeated_m2 += pixel_m2;
      ++end;
    } while (end < width_ && isOneSurface(row[end], row[end - 1]));
    parents_[label] = label;
    areas_[label] = area;
  }
}

/// Joins the runs of a row with those that they touch in the row above, also across corners.
void CoherentMatches::joinWithAbove(int v) {
  const auto *row = matches_px_.ptr<float>(v), *above = matches_px_.ptr<float>(v - 1);
  const int *labels = &labels_[static_cast<std::size_t>(v) * width_], *labels_above = labels - width_;
  std::pair<int, int> joined{-1, -1};  // last
  for (int u = 0; u < width_; ++u) {
    if (labels[u] == kNone) continue;
    for (int beside = std::max(0, u - 1); beside <= std::min(width_ - 1, u + 1); ++beside) {
      const std::pair<int, int> touching{labels[u], labels_above[beside]};
      if (touching == joined || !isOneSurface(row[u], above[beside])) continue;
      join(touching.first, touching.second);
      joined = touching;
    }
  }
}

/// @return number of best matches that stay.
int CoherentMatches::keepRow(int v, cv::Mat& best_px, cv::Mat& repeated_px) const {
  auto *best = best_px.ptr<float>(v), *repeated = repeated_px.ptr<float>(v);
  const int* labels = &labels_[static_cast<std::size_t>(v) * width_];
  int kept = 0;
  for (int u = 0; u < width_; ++u) {
    int label = labels[u];
    if (label == kNone) continue;
    while (parents_[label] != label) label = parents_[label];
    const Area& area = areas_[label];
    const bool is_patch = area.all_m2 - area.repeated_m2 >= smallest_m_ * smallest_m_;
    if (is_patch && 2.0 * area.repeated_m2 <= area.all_m2) {
      kept += !std::isnan(best[u]);
      continue;
    }
    if (is_patch && std::isnan(repeated[u])) repeated[u] = best[u];
    best[u] = std::numeric_limits<float>::quiet_NaN();
  }
  return kept;
}

int CoherentMatches::root(int label) {
  while (parents_[label] != label) label = parents_[label] = parents_[parents_[label]];
  return label;
}

void CoherentMatches::join(int one, int other) {
  one = root(one);
  other = root(other);
  if (one == other) return;
  if (one > other) std::swap(one, other);
  parents_[other] = one;
  areas_[one].all_m2 += areas_[other].all_m2;
  areas_[one].repeated_m2 += areas_[other].repeated_m2;
}

}  // namespace flight_corridor
