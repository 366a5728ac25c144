#include "flight_corridor/stereo/coherent_matches.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace flight_corridor {

namespace {

constexpr float kStep_px = 1.0f;  // between neighbours of one surface: noise and slope

bool isOneSurface(float one_px, float other_px) { return std::abs(one_px - other_px) <= kStep_px; }  // not of NaN

}  // namespace

CoherentMatches::CoherentMatches(const StereoGeometry& geometry, double smallest_obstacle_m)
    : geometry_(geometry),
      size_(geometry.size()),
      least_m2_(smallest_obstacle_m * smallest_obstacle_m),
      labels_(static_cast<std::size_t>(size_.area())) {}

void CoherentMatches::keep(cv::Mat& best_px, cv::Mat& repeated_px) {
  parents_.clear();
  areas_.clear();
  for (int v = 0; v < size_.height; ++v) labelRow(v, best_px, repeated_px);
  for (int label = 0; label < static_cast<int>(parents_.size()); ++label) parents_[label] = root(label);
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < size_.height; ++v) {
    auto *best = best_px.ptr<float>(v), *repeated = repeated_px.ptr<float>(v);
    const int* labels = &labels_[static_cast<std::size_t>(v) * size_.width];
    for (int u = 0; u < size_.width; ++u) {
      const Area& area = areas_[parents_[labels[u]]];
      const bool is_patch = area.all_m2 - area.repeated_m2 >= least_m2_;
      if (is_patch && 2.0 * area.repeated_m2 <= area.all_m2) continue;
      if (is_patch && std::isnan(repeated[u])) repeated[u] = best[u];
      best[u] = none;
    }
  }
}

/// A run's area is that of its pixels, each at its own distance; none where nothing is matched.
void CoherentMatches::labelRow(int v, const cv::Mat& best_px, const cv::Mat& repeated_px) {
  const auto *best = best_px.ptr<float>(v), *repeated = repeated_px.ptr<float>(v);
  std::swap(row_px_, above_px_);
  row_px_.resize(static_cast<std::size_t>(size_.width));
  for (int u = 0; u < size_.width; ++u) row_px_[u] = std::isnan(best[u]) ? repeated[u] : best[u];
  const float *row = row_px_.data(), *above = above_px_.data();
  int* labels = &labels_[static_cast<std::size_t>(v) * size_.width];
  const int* labels_above = labels - size_.width;
  int joined = -1;  // label of the row above that the run was joined with last
  for (int u = 0; u < size_.width; ++u) {
    if (u == 0 || !isOneSurface(row[u], row[u - 1])) {
      parents_.push_back(static_cast<int>(parents_.size()));
      areas_.emplace_back();
      joined = -1;
    }
    const int label = labels[u] = static_cast<int>(parents_.size()) - 1;
    if (!(row[u] > 0.0f)) continue;
    const double edge_m = geometry_.pixelEdge(row[u]);
    Area& area = areas_[root(label)];
    area.all_m2 += edge_m * edge_m;
    if (std::isnan(best[u])) area.repeated_m2 += edge_m * edge_m;
    if (v == 0) continue;
    for (int beside = std::max(0, u - 1); beside <= std::min(size_.width - 1, u + 1); ++beside) {
      if (labels_above[beside] == joined || !isOneSurface(row[u], above[beside])) continue;
      join(label, labels_above[beside]);
      joined = labels_above[beside];
    }
  }
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
