#include "flight_corridor/stereo/patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr int kBand_px = 60;  // rows that are labelled side by side with others

bool isOneSurface(float one_px, float other_px) {
  return std::abs(one_px - other_px) <= kSameSurface_px;
}  // not of NaN

/// A row's matches of either kind.
struct Matches {
  Matches(int v, const cv::Mat& best_px, const cv::Mat& repeated_px)
      : best(best_px.ptr<float>(v)), repeated(repeated_px.ptr<float>(v)) {}

  float operator[](int u) const { return std::isnan(best[u]) ? repeated[u] : best[u]; }

  const float *best, *repeated;
};

}  // namespace

Patches::Patches(const StereoGeometry& geometry, double smallest_obstacle_m, BandWorkers& workers)
    : geometry_(geometry),
      smallest_m_(smallest_obstacle_m),
      bands_((geometry.size().height + kBand_px - 1) / kBand_px),
      runs_(static_cast<std::size_t>(geometry.size().area())),
      end_(static_cast<std::size_t>(geometry.size().height)),
      parents_(runs_.size()),
      kept_(static_cast<std::size_t>(bands_)),
      workers_(workers) {}

int Patches::keep(cv::Mat& best_px, cv::Mat& repeated_px) {
  const auto firstRow = [&](int band) { return std::min(band * kBand_px, geometry_.size().height); };
  workers_.run(bands_, [&](int band, int) {
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) {
      findRuns(v, best_px, repeated_px);
      if (v > firstRow(band)) joinWithAbove(v, best_px, repeated_px);
    }
  });
  for (int band = 1; band < bands_; ++band) joinWithAbove(firstRow(band), best_px, repeated_px);
  workers_.run(bands_, [&](int band, int) {
    kept_[band] = 0;
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) kept_[band] += keepRow(v, best_px, repeated_px);
  });
  return std::accumulate(kept_.begin(), kept_.end(), 0);
}

/// Each run is its own patch so far. Its area is that of its pixels, each at its own distance. A textureless obstacle
/// has matches on its outline alone: a strip as wide as the outline counts as if it were as wide as the smallest
/// obstacle.
void Patches::findRuns(int v, const cv::Mat& best_px, const cv::Mat& repeated_px) {
  const Matches matches(v, best_px, repeated_px);
  const int width = geometry_.size().width;
  const double narrowest_m = smallest_m_ / kEdgeWidth_px;
  int next = label(v);
  for (int u = 0; u < width;) {
    float disparity_px = matches[u];
    if (std::isnan(disparity_px)) {
      ++u;
      continue;
    }
    Run run{u, u, 0, 0.0, 0.0};
    float before_px;
    do {
      const double edge_m = geometry_.pixelEdge(disparity_px);
      const double pixel_m2 = edge_m * std::max(edge_m, narrowest_m);
      const bool is_best = !std::isnan(matches.best[u]);
      run.all_m2 += pixel_m2;
      run.best += is_best;
      if (!is_best) run.repeated_m2 += pixel_m2;
      before_px = disparity_px;
    } while (++u < width && isOneSurface(disparity_px = matches[u], before_px));
    run.end_u = u;
    runs_[next] = run;
    parents_[next] = next;
    ++next;
  }
  end_[v] = next;
}

/// Joins the runs of a row with those that they touch in the row above, also across corners.
void Patches::joinWithAbove(int v, const cv::Mat& best_px, const cv::Mat& repeated_px) {
  const Matches row(v, best_px, repeated_px), above(v - 1, best_px, repeated_px);
  const auto touch = [&](const Run& one, const Run& other) {
    for (int u = std::max(one.first_u, other.first_u - 1); u < std::min(one.end_u, other.end_u + 1); ++u) {
      for (int beside = std::max(u - 1, other.first_u); beside < std::min(u + 2, other.end_u); ++beside) {
        if (isOneSurface(row[u], above[beside])) return true;
      }
    }
    return false;
  };
  int first_above = label(v - 1);
  for (int one = label(v); one < end_[v]; ++one) {
    while (first_above < end_[v - 1] && runs_[first_above].end_u < runs_[one].first_u) ++first_above;
    for (int other = first_above; other < end_[v - 1] && runs_[other].first_u <= runs_[one].end_u; ++other) {
      if (rootOf(parents_, one) != rootOf(parents_, other) && touch(runs_[one], runs_[other])) join(one, other);
    }
  }
}

/// @return number of best matches that stay.
int Patches::keepRow(int v, cv::Mat& best_px, cv::Mat& repeated_px) const {
  auto *best = best_px.ptr<float>(v), *repeated = repeated_px.ptr<float>(v);
  int kept = 0;
  for (int i = label(v); i < end_[v]; ++i) {
    int root = i;
    while (parents_[root] != root) root = parents_[root];
    const Run &patch = runs_[root], &run = runs_[i];
    const bool is_patch = patch.all_m2 - patch.repeated_m2 >= smallest_m_ * smallest_m_;
    if (is_patch && 2.0 * patch.repeated_m2 <= patch.all_m2) {
      kept += run.best;
      continue;
    }
    for (int u = run.first_u; u < run.end_u; ++u) {
      if (is_patch && std::isnan(repeated[u])) repeated[u] = best[u];
      best[u] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return kept;
}

void Patches::join(int one, int other) {
  one = rootOf(parents_, one);
  other = rootOf(parents_, other);
  if (one > other) std::swap(one, other);
  parents_[other] = one;
  runs_[one].all_m2 += runs_[other].all_m2;
  runs_[one].repeated_m2 += runs_[other].repeated_m2;
}

}  // namespace flight_corridor
