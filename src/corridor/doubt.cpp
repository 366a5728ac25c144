#include "flight_corridor/corridor/doubt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "flight_corridor/disjoint_sets.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr double kInside_px = 0.5;        // so much nearer than the box's end a whole disparity is surely in it
constexpr double kMostOfObstacle = 0.75;  // its edges are matched on what is behind
constexpr std::size_t kEnough = 4;        // candidates for each pixel of the image: doubt enough
constexpr double kSurelyLess = 0.5;       // of the smallest obstacle: by half of the pixels it is none
constexpr double kSurelyMore = 4.0;       // ... it is one
constexpr int kShared = 16;               // ... but of several boxes each has no more than this part

}  // namespace

/// A pixel whose match may not be the only one.
struct Doubt::Pixel {
  /// One of its other disparities.
  struct Alternative {
    int place;
    Eigen::Vector3f point_F;  // a little behind it
    bool is_competitor;       // ... and not in the set
  };

  int at = 0;
  Eigen::Vector3d ray_C;
  double match_px = 0.0;    // corrected
  Eigen::Vector3f match_F;  // where that is
  bool is_repeated = false, has_competitor = false;
  int farthest = 0, nearest = 0;  // places of competitors
  std::vector<Alternative> alternatives;
};

Doubt::Doubt(const StereoGeometry& geometry)
    : geometry_(geometry),
      first_px_(firstDisparity(geometry)),
      labels_(static_cast<std::size_t>(geometry.size().area()), -1) {}

void Doubt::find(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction,
                 const std::vector<Question>& questions, double smallest_m) {
  const double smallest_m2 = smallest_m * smallest_m;
  prepare(fan, from_m, evidence, correction);
  std::vector<Question> open = questions;
  if (fan.size() > 1) {  // most are decided by every second pixel
    looks_at_half_ = true;
    collect(fan, evidence, correction, open);
    for (int i = 0; i < fan.size(); ++i) {
      Direction& direction = directions_[i];
      const bool may_be = open[i].is_open && isDoubtful(direction, kSurelyLess * smallest_m2);
      const bool must_be = may_be && isDoubtful(direction, kSurelyMore * smallest_m2);
      open[i].is_open = may_be && !must_be;
      direction.clear();
      direction.is_doubtful = must_be;
    }
  }
  looks_at_half_ = false;
  const bool is_any_open = std::any_of(open.begin(), open.end(), [](const Question& one) { return one.is_open; });
  if (is_any_open) collect(fan, evidence, correction, open);
  for (int i = 0; i < fan.size(); ++i) {
    if (open[i].is_open) directions_[i].is_doubtful = isDoubtful(directions_[i], smallest_m2);
  }
}

bool Doubt::isDoubtful(const Direction& direction, double smallest_m2) {
  return direction.is_doubtful || holdsRepeated(direction, smallest_m2) || holdsPatch(direction, smallest_m2);
}

void Doubt::prepare(const Fan& fan, double from_m, const DisparityEvidence& evidence,
                    const ScaleCorrection& correction) {
  from_px_ = from_m > 0.0 ? geometry_.disparity(from_m) : kInfinity;
  const double end_m = fan.farthestCorner();
  end_px_ = end_m > 0.0 ? geometry_.disparity(end_m) : kInfinity;
  corrected_px_.resize(static_cast<std::size_t>(8 * evidence.set.channels()));
  for (std::size_t place = 0; place < corrected_px_.size(); ++place) {
    const double disparity_px = correction.correct(static_cast<double>(place) + first_px_);
    corrected_px_[place] = disparity_px > 0.0 ? disparity_px : 0.0;
  }
  directions_.resize(fan.size());
  for (int i = 0; i < fan.size(); ++i) {
    Direction& direction = directions_[i];
    direction.T_D_C = fan.box(i).T_M_F.inverse();
    direction.size_m = fan.box().size_m;
    direction.repeated_m2.resize(corrected_px_.size());
    direction.clear();
  }
}

/// Of pixels that are matched behind a box, and of repeated matches in it: what else is matched in it is for
/// BoxPatches.
void Doubt::collect(const Fan& fan, const DisparityEvidence& evidence, const ScaleCorrection& correction,
                    const std::vector<Question>& questions) {
  const float *best_px = evidence.best_px.ptr<float>(), *repeated_px = evidence.repeated_px.ptr<float>();
  const int width = geometry_.size().width, pixels = geometry_.size().area(), words = evidence.set.channels() / 8;
  const std::size_t enough = kEnough * pixels / std::min(fan.size(), kShared);
  Pixel pixel;
  for (int i = 0; i < pixels; ++i) {
    if (looks_at_half_ && (i % width + i / width) % 2 != 0) continue;
    pixel.is_repeated = !std::isnan(repeated_px[i]);
    pixel.match_px = correction.correct(pixel.is_repeated ? repeated_px[i] : best_px[i]);
    if (std::isnan(pixel.match_px)) continue;
    const auto* set = evidence.set.ptr<std::uint64_t>() + static_cast<std::size_t>(i) * words;
    pixel.has_competitor = (evidence.flags.data[i] & kCompetitor) != 0;
    pixel.farthest = evidence.competitor_farthest.data[i];
    pixel.nearest = evidence.competitor_nearest.data[i];
    const int last = std::max(lastBit(set, words), pixel.has_competitor ? pixel.nearest : -1);
    const double behind_px = pixel.is_repeated ? end_px_ : std::max(end_px_, pixel.match_px);
    if (last < 0 || corrected_px_[last] < behind_px + kInside_px) continue;
    pixel.at = i;
    pixel.ray_C = geometry_.point(i % width, i / width, 1.0);
    const auto point = [&](double disparity_px) -> Eigen::Vector3f {
      return fan.T_F_C() * (geometry_.depth(disparity_px) * pixel.ray_C).cast<float>();
    };
    pixel.match_F = point(pixel.match_px);
    pixel.alternatives.clear();
    const auto add_alternative = [&](int place, bool is_competitor) {
      if (corrected_px_[place] < behind_px + kInside_px || corrected_px_[place] >= from_px_) return;
      pixel.alternatives.push_back({place, point(corrected_px_[place] - kInside_px), is_competitor});
    };
    for (int word = 0; word < words; ++word) {
      for (std::uint64_t bits = set[word]; bits != 0; bits &= bits - 1) {
        add_alternative(64 * word + lowestBit(bits), false);
      }
    }
    const auto add_competitor = [&](int place) {
      if (!(set[place / 64] >> place % 64 & 1u)) add_alternative(place, true);
    };
    if (pixel.has_competitor) add_competitor(pixel.farthest);
    if (pixel.has_competitor && pixel.nearest != pixel.farthest) add_competitor(pixel.nearest);
    const auto look = [&](int direction) {
      Direction& box = directions_[direction];
      if (!questions[direction].is_open || box.is_doubtful || std::exchange(box.looked_at, i) == i) return;
      add(fan, direction, pixel, questions[direction].is_lidar_valid);
      box.is_doubtful = box.candidates.size() >= enough;
    };
    if (fan.size() == 1) {
      look(0);
    } else {
      const auto look_into_all = [&](const Eigen::Vector3f& point_F) {
        fan.visit(point_F, 0.0f, [&](int direction, const Eigen::Vector3f&) { look(direction); });
      };
      for (const Pixel::Alternative& alternative : pixel.alternatives) look_into_all(alternative.point_F);
      if (corrected_px_[last] >= from_px_) look_into_all(point(from_px_ - kInside_px));  // it may surround a box
    }
  }
}

/// What a pixel may be in a direction's box.
void Doubt::add(const Fan& fan, int direction, const Pixel& pixel, bool is_lidar_valid) {
  const auto holds = [&](const Eigen::Vector3f& point_F) { return fan.contains(fan.turned(direction, point_F)); };
  const bool holds_match = pixel.match_px < from_px_ && holds(pixel.match_F);
  if (holds_match && !pixel.is_repeated) return;
  Direction& box = directions_[direction];
  bool is_farthest_in = false;
  for (const Pixel::Alternative& alternative : pixel.alternatives) {
    const bool is_behind = !holds_match && pixel.match_px < corrected_px_[alternative.place];
    if ((!is_behind && !pixel.is_repeated) || !holds(alternative.point_F)) continue;
    is_farthest_in |= alternative.place == pixel.farthest;
    if (alternative.is_competitor && is_behind && is_lidar_valid) continue;
    box.candidates.push_back({pixel.at, alternative.place});
  }
  if (!pixel.has_competitor) return;
  if (holds_match && is_farthest_in) {
    const auto place = std::lower_bound(corrected_px_.begin(), corrected_px_.end() - 1, pixel.match_px);
    box.repeated_m2[place - corrected_px_.begin()] +=
        pixelArea() * std::pow(geometry_.pixelEdge(corrected_px_[pixel.farthest]), 2);
  }
  const bool may_surround = fan.size() == 1 || corrected_px_[pixel.nearest] >= from_px_;
  if (may_surround && !is_farthest_in && !(is_lidar_valid && !holds_match)) addSurrounded(box, pixel);
}

/// Of competitors on both sides of a box one between, of which nothing is known, may be in it.
void Doubt::addSurrounded(Direction& box, const Pixel& pixel) const {
  const Crossing crossing = flight_corridor::crossing(box.T_D_C, box.size_m, pixel.ray_C);
  if (!crossing.meets()) return;
  const double exit_px = geometry_.disparity(crossing.exit);
  const double entry_px = crossing.entry > 0.0 ? std::min(from_px_, geometry_.disparity(crossing.entry)) : from_px_;
  if (!pixel.is_repeated && !(pixel.match_px < exit_px)) return;
  const auto first = std::lower_bound(corrected_px_.begin(), corrected_px_.end(), exit_px + kInside_px);
  if (first == corrected_px_.end() || *first >= entry_px) return;
  const bool surrounds = corrected_px_[pixel.farthest] < *first && corrected_px_[pixel.nearest] >= entry_px;
  if (surrounds) box.candidates.push_back({pixel.at, static_cast<int>(first - corrected_px_.begin())});
}

/// Whether pixels at one disparity that touch each other cover the smallest obstacle's area.
bool Doubt::holdsPatch(const Direction& direction, double smallest_m2) {
  const std::vector<Candidate>& candidates = direction.candidates;
  begins_.assign(corrected_px_.size() + 1, 0);
  for (const Candidate& candidate : candidates) ++begins_[candidate.place + 1];
  for (std::size_t place = 1; place < begins_.size(); ++place) begins_[place] += begins_[place - 1];
  by_place_.resize(candidates.size());
  std::vector<int>& next = parents_;  // scratch
  next.assign(begins_.begin(), begins_.end());
  for (const Candidate& candidate : candidates) by_place_[next[candidate.place]++] = candidate.pixel;
  for (int place = 0; place + 1 < static_cast<int>(begins_.size()); ++place) {
    if (holdsPatchAt(place, smallest_m2)) return true;
  }
  return false;
}

bool Doubt::holdsPatchAt(int place, double smallest_m2) {
  const int *begin = by_place_.data() + begins_[place], *end = by_place_.data() + begins_[place + 1];
  const double disparity_px = corrected_px_[place];
  if (begin == end || !(disparity_px > 0.0)) return false;
  const double pixel_m = geometry_.pixelEdge(disparity_px);
  const double enough = smallest_m2 / (pixelArea() * pixel_m * pixel_m);
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
    touch(looks_at_half_ ? -2 : -1, 0);
    touch(0, looks_at_half_ ? -2 : -1);
    for (const int du : {-1, 1}) touch(du, -1);
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

/// Whether repeated matches of one surface, to a pixel, cover most of the smallest obstacle; they need not touch.
bool Doubt::holdsRepeated(const Direction& direction, double smallest_m2) {
  const std::vector<double>& repeated_m2 = direction.repeated_m2;
  for (std::size_t place = 1; place + 1 < repeated_m2.size(); ++place) {
    const double surface_m2 = repeated_m2[place - 1] + repeated_m2[place] + repeated_m2[place + 1];
    if (surface_m2 > 0.0 && surface_m2 >= kMostOfObstacle * smallest_m2) return true;
  }
  return false;
}

cv::Mat Doubt::image() const {
  cv::Mat image = cv::Mat::zeros(geometry_.size(), CV_8UC1);
  for (const Candidate& candidate : directions_.front().candidates) image.data[candidate.pixel] = 255;
  return image;
}

}  // namespace flight_corridor
