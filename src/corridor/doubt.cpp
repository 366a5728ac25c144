#include "flight_corridor/corridor/doubt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr double kInside_px = 0.5;        // so much nearer than the box's end a whole disparity is surely in it
constexpr double kMostOfObstacle = 0.75;  // its edges are matched on what is behind
constexpr std::size_t kEnough = 4;        // candidates for each pixel of the image: doubt enough

}  // namespace

Doubt::Doubt(const StereoGeometry& geometry)
    : geometry_(geometry),
      first_px_(firstDisparity(geometry)),
      labels_(static_cast<std::size_t>(geometry.size().area()), -1) {}

bool Doubt::isIn(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
                 bool is_lidar_valid, double smallest_m) {
  const double smallest_m2 = smallest_m * smallest_m;
  collect(box, evidence, correction, is_lidar_valid);
  if (candidates_.size() >= kEnough * labels_.size()) return true;
  if (holdsRepeated(smallest_m2)) return true;
  begins_.assign(static_cast<std::size_t>(8 * evidence.set.channels()) + 1, 0);
  for (const Candidate& candidate : candidates_) ++begins_[candidate.place + 1];
  for (std::size_t place = 1; place < begins_.size(); ++place) begins_[place] += begins_[place - 1];
  by_place_.resize(candidates_.size());
  std::vector<int>& next = parents_;  // scratch
  next.assign(begins_.begin(), begins_.end());
  for (const Candidate& candidate : candidates_) by_place_[next[candidate.place]++] = candidate.pixel;
  for (int place = 0; place + 1 < static_cast<int>(begins_.size()); ++place) {
    if (holdsPatch(place, correction, smallest_m2)) return true;
  }
  return false;
}

/// Of pixels that are matched behind the box, and of repeated matches in it: what else is matched in it is for
/// BoxPatches.
void Doubt::collect(const BoxView& box, const DisparityEvidence& evidence, const ScaleCorrection& correction,
                    bool is_lidar_valid) {
  candidates_.clear();
  repeated_m2_.assign(static_cast<std::size_t>(8 * evidence.set.channels()), 0.0);
  const int words = evidence.set.channels() / 8;
  corrected_px_.resize(static_cast<std::size_t>(64 * words));  // of each place; grows with it
  for (int place = 0; place < 64 * words; ++place) {
    const double disparity_px = correction.correct(place + first_px_);
    corrected_px_[place] = disparity_px > 0.0 ? disparity_px : 0.0;
  }
  const auto places_below = [this](double disparity_px) {
    return static_cast<int>(std::lower_bound(corrected_px_.begin(), corrected_px_.end(), disparity_px) -
                            corrected_px_.begin());
  };
  const float *entry_px = box.entry().ptr<float>(), *exit_px = box.exit().ptr<float>();
  const float *best_px = evidence.best_px.ptr<float>(), *repeated_px = evidence.repeated_px.ptr<float>();
  const auto* set = evidence.set.ptr<std::uint64_t>();
  const int pixels = geometry_.size().area();
  for (int i = 0; i < pixels && candidates_.size() < kEnough * pixels; ++i) {
    if (!(exit_px[i] < entry_px[i])) continue;  // its ray misses the box
    const bool is_repeated = !std::isnan(repeated_px[i]);
    const double match_px = correction.correct(is_repeated ? repeated_px[i] : best_px[i]);
    const bool is_behind = match_px < exit_px[i];
    if (!is_behind && !is_repeated) continue;
    const bool competes = (evidence.flags.data[i] & kCompetitor) && !(is_behind && is_lidar_valid);
    const int last = lastBit(set + static_cast<std::size_t>(i) * words, words);
    if (!competes && !(last >= 0 && corrected_px_[last] >= exit_px[i])) continue;
    const int first = places_below(exit_px[i] + kInside_px), end = places_below(entry_px[i]);
    if (first >= end) continue;
    const int farthest = evidence.competitor_farthest.data[i], nearest = evidence.competitor_nearest.data[i];
    if (competes && !is_behind && match_px < entry_px[i] && farthest >= first) {
      repeated_m2_[std::min<std::size_t>(places_below(match_px), repeated_m2_.size() - 1)] +=
          std::pow(geometry_.pixelEdge(corrected_px_[farthest]), 2);
    }
    for (int word = first / 64; word < words; ++word) {
      std::uint64_t bits = set[static_cast<std::size_t>(i) * words + word];
      for (bits = bitsTo(bitsFrom(bits, word, first), word, end - 1); bits != 0; bits &= bits - 1) {
        candidates_.push_back({i, 64 * word + lowestBit(bits)});
      }
    }
    if (!competes) continue;
    const bool surrounds = farthest < first && nearest >= end;  // of those between nothing is known: one may be in it
    const auto add = [&](int place) {
      const bool is_in_set = set[static_cast<std::size_t>(i) * words + place / 64] >> place % 64 & 1u;
      if (!is_in_set) candidates_.push_back({i, place});
    };
    if (surrounds || (first <= farthest && farthest < end)) add(surrounds ? first : farthest);
    if (nearest != farthest && first <= nearest && nearest < end) add(nearest);
  }
}

/// Whether repeated matches of one surface, to a pixel, cover most of the smallest obstacle; they need not touch.
bool Doubt::holdsRepeated(double smallest_m2) const {
  for (std::size_t place = 1; place + 1 < repeated_m2_.size(); ++place) {
    const double surface_m2 = repeated_m2_[place - 1] + repeated_m2_[place] + repeated_m2_[place + 1];
    if (surface_m2 > 0.0 && surface_m2 >= kMostOfObstacle * smallest_m2) return true;
  }
  return false;
}

/// Whether pixels at one disparity that touch each other cover the smallest obstacle's area.
bool Doubt::holdsPatch(int place, const ScaleCorrection& correction, double smallest_m2) {
  const int *begin = by_place_.data() + begins_[place], *end = by_place_.data() + begins_[place + 1];
  const double disparity_px = correction.correct(place + first_px_);
  if (begin == end || !(disparity_px > 0.0)) return false;
  const double pixel_m = geometry_.pixelEdge(disparity_px);
  const double enough = smallest_m2 / (pixel_m * pixel_m);
  if (static_cast<double>(end - begin) < enough) return false;
  const int width = geometry_.size().width;
  parents_.clear();
  sizes_.clear();
  int largest = 0;
  for (const int* pixel = begin; pixel != end; ++pixel) {
    const int u = *pixel % width, v = *pixel / width;
    int label = -1;
    const auto touch = [&](int du, int dv) {
      if (u + du < 0 || u + du >= width || v + dv < 0) return;
      const int other = labels_[*pixel + dv * width + du];
      if (other < 0) return;
      const int at = rootOf(parents_, other);
      if (label < 0) {
        label = at;
      } else if (at != label) {
        parents_[at] = label;
        sizes_[label] += sizes_[at];
      }
    };
    touch(-1, 0);
    for (const int du : {-1, 0, 1}) touch(du, -1);
    if (label < 0) {
      label = static_cast<int>(parents_.size());
      parents_.push_back(label);
      sizes_.push_back(0);
    }
    labels_[*pixel] = label;
    largest = std::max(largest, ++sizes_[label]);
  }
  for (const int* pixel = begin; pixel != end; ++pixel) labels_[*pixel] = -1;
  return largest >= enough;
}

cv::Mat Doubt::image() const {
  cv::Mat image = cv::Mat::zeros(geometry_.size(), CV_8UC1);
  for (const Candidate& candidate : candidates_) image.data[candidate.pixel] = 255;
  return image;
}

}  // namespace flight_corridor
