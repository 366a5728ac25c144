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

void CoherentMatches::keep(cv::Mat& disparity_px) {
  if (least_m2_ <= 0.0) return;
  parents_.clear();
  areas_m2_.clear();
  for (int v = 0; v < size_.height; ++v) {
    labelRow(v, disparity_px.ptr<float>(v), v > 0 ? disparity_px.ptr<float>(v - 1) : nullptr);
  }
  for (int label = 0; label < static_cast<int>(parents_.size()); ++label) parents_[label] = root(label);
  for (int v = 0; v < size_.height; ++v) {
    auto* row = disparity_px.ptr<float>(v);
    const int* labels = &labels_[static_cast<std::size_t>(v) * size_.width];
    for (int u = 0; u < size_.width; ++u) {
      if (areas_m2_[parents_[labels[u]]] < least_m2_) row[u] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// A run's area is that of its pixels, each at its own distance; none where nothing is matched.
void CoherentMatches::labelRow(int v, const float* row, const float* above) {
  int* labels = &labels_[static_cast<std::size_t>(v) * size_.width];
  const int* labels_above = labels - size_.width;
  int joined = -1;  // label of the row above that the run was joined with last
  for (int u = 0; u < size_.width; ++u) {
    if (u == 0 || !isOneSurface(row[u], row[u - 1])) {
      parents_.push_back(static_cast<int>(parents_.size()));
      areas_m2_.push_back(0.0);
      joined = -1;
    }
    const int label = labels[u] = static_cast<int>(parents_.size()) - 1;
    if (!(row[u] > 0.0f)) continue;
    const double edge_m = geometry_.pixelEdge(row[u]);
    areas_m2_[root(label)] += edge_m * edge_m;
    if (above == nullptr) continue;
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
  areas_m2_[one] += areas_m2_[other];
}

}  // namespace flight_corridor
