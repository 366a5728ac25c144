#include "flight_corridor/corridor/doubt.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

#include "flight_corridor/geometry/section.hpp"
#include "flight_corridor/stereo/disparity_bits.hpp"
#include "flight_corridor/stereo/match_error.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr int kBands = 8;                 // of rows, or of disparities, side by side
constexpr double kInside_px = 0.5;        // so much nearer than the box's end a whole disparity is surely in it
constexpr double kMostOfObstacle = 0.75;  // its edges are matched on what is behind

/// Words of so many bits.
int wordsOf(int bits) { return (bits + 63) / 64; }

}  // namespace

/// A pixel whose match may not be the only one.
struct Doubt::Pixel {
  int at;
  const std::uint64_t* set;
  double match_px;  // corrected
  bool is_repeated, has_competitor;
  int farthest, nearest;  // indices of the competitors' disparities

  bool isInSet(int d) const { return set[d / 64] >> d % 64 & 1u; }
};

Doubt::Doubt(const StereoGeometry& geometry)
    : geometry_(geometry),
      first_px_(firstDisparity(geometry)),
      matches_px_(static_cast<std::size_t>(geometry.size().area())),
      scratch_(kBands) {}

/// A patch in a direction's box is a part of one of all pixels that may be in any box: where none of these is large
/// enough, no direction is looked into.
void Doubt::find(const Fan& fan, double from_m, const DisparityEvidence& evidence, const EarlierMatches& earlier,
                 const ScaleCorrection& correction, const std::vector<Question>& questions, double smallest_m,
                 BandWorkers& workers) {
  const double smallest_m2 = smallest_m * smallest_m;
  earlier_ = &earlier;
  correction_ = &correction;
  prepare(fan, from_m, evidence, correction, questions);
  findViews();
  const auto inBands = [&](int begin, int end, const auto& visit) {
    for (Scratch& scratch : scratch_) prepare(scratch);
    workers.run(kBands, [&](int band, int) {
      const int size = end - begin, last = begin + size * (band + 1) / kBands;
      for (int i = begin + size * band / kBands; i < last; ++i) visit(i, scratch_[band]);
    });
  };
  inBands(0, geometry_.size().height, [&](int v, Scratch& scratch) { markRow(v, correction, scratch); });
  for (const Scratch& scratch : scratch_) {
    for (const int at : scratch.repeated) addRepeated(pixel(at));
  }
  for (Direction& one : directions_) one.is_doubtful = one.question.is_open && holdsRepeated(one, smallest_m2);
  inBands(begin_d_, end_d_, [&](int d, Scratch& scratch) { checkDisparity(d, smallest_m2, scratch); });
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const auto found = [&](const Scratch& scratch) {
      return scratch.boxes[i].is_undecided != directions_[i].isUndecided();
    };
    directions_[i].is_doubtful |= std::any_of(scratch_.begin(), scratch_.end(), found);
  }
}

void Doubt::prepare(const Fan& fan, double from_m, const DisparityEvidence& evidence, const ScaleCorrection& correction,
                    const std::vector<Question>& questions) {
  fan_ = fan;
  evidence_ = evidence;
  from_px_ = from_m > 0.0 ? geometry_.disparity(from_m) : kInfinity;
  const double end_m = fan.farthestCorner();
  end_px_ = end_m > 0.0 ? geometry_.disparity(end_m) : kInfinity;
  corrected_px_.resize(static_cast<std::size_t>(8 * evidence.set.channels()));
  for (std::size_t d = 0; d < corrected_px_.size(); ++d) {
    const double disparity_px = correction.correct(static_cast<double>(d) + first_px_);
    corrected_px_[d] = disparity_px > 0.0 ? disparity_px : 0.0;
  }
  const auto indexFrom = [&](double disparity_px) {
    return static_cast<int>(std::lower_bound(corrected_px_.begin(), corrected_px_.end(), disparity_px) -
                            corrected_px_.begin());
  };
  begin_d_ = indexFrom(end_px_ + kInside_px);
  end_d_ = std::max(begin_d_, indexFrom(from_px_));
  bits_.resize(static_cast<std::size_t>(geometry_.size().height) * begin(1, begin_d_));
  directions_.resize(fan.size());
  is_camera_inside_ = true;
  for (int i = 0; i < fan.size(); ++i) {
    Direction& direction = directions_[i];
    direction.T_D_C = fan.box(i).T_M_F.inverse();
    is_camera_inside_ &=
        contains(fan.box().size_m, direction.T_D_C.translation() + kTouch_m * Eigen::Vector3d::UnitX());
    direction.is_doubtful = false;
    direction.question = questions[i];
    direction.repeated_m2.assign(corrected_px_.size(), 0.0);
  }
}

void Doubt::prepare(Scratch& scratch) const {
  scratch.repeated.clear();
  scratch.doubtful.clear();
  scratch.boxes.resize(directions_.size());
  for (std::size_t i = 0; i < directions_.size(); ++i) scratch.boxes[i].is_undecided = directions_[i].isUndecided();
}

/// Where the boxes are in the image, a disparity.
void Doubt::findViews() {
  views_.assign(corrected_px_.size(), {});
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const Box box_C = fan_.box(static_cast<int>(i));
    for (int d = begin_d_; d < end_d_ && directions_[i].question.is_open; ++d) {
      views_[d] |= sectionAt(box_C, geometry_.depth(corrected_px_[d] - kInside_px), geometry_).view;
    }
  }
}

/// Of a row of the image at a disparity, in bits_.
std::ptrdiff_t Doubt::begin(int v, int d) const {
  const int words = wordsOf(geometry_.size().width), disparities = end_d_ - begin_d_;
  return static_cast<std::ptrdiff_t>(v * disparities + d - begin_d_) * words;
}

void Doubt::mark(int d, int at) {
  const int width = geometry_.size().width, u = at % width;
  bits_[begin(at / width, d) + u / 64] |= std::uint64_t{1} << u % 64;
}

Doubt::Pixel Doubt::pixel(int at) const {
  const int words = evidence_.set.channels() / 8;
  return {at,
          evidence_.set.ptr<std::uint64_t>() + static_cast<std::size_t>(at) * words,
          matches_px_[at],
          !std::isnan(evidence_.repeated_px.ptr<float>()[at]),
          (evidence_.flags.data[at] & kCompetitor) != 0,
          evidence_.competitor_farthest.data[at],
          evidence_.competitor_nearest.data[at]};
}

Eigen::Vector3f Doubt::point(const Pixel& pixel, double disparity_px) const {
  const int width = geometry_.size().width;
  const Eigen::Vector3d ray_C = geometry_.point(pixel.at % width, pixel.at / width, 1.0);
  return fan_.T_F_C() * (geometry_.depth(disparity_px) * ray_C).cast<float>();
}

/// Of competitors on both sides of a box one between, of which nothing is known, may be in it: at the farthest one.
/// Calls visit(direction, d).
template <class Visit>
void Doubt::visitBracketed(const Pixel& pixel, Scratch& scratch, Visit&& visit) const {
  if (!pixel.has_competitor || (is_camera_inside_ && corrected_px_[pixel.nearest] < from_px_)) return;
  if (pixel.nearest <= begin_d_ || pixel.farthest >= end_d_) return;
  const int width = geometry_.size().width;
  const Eigen::Vector3d ray_C = geometry_.point(pixel.at % width, pixel.at / width, 1.0);
  for (int i = 0; i < static_cast<int>(directions_.size()); ++i) {
    if (!scratch.boxes[i].is_undecided) continue;
    const Crossing crossing = flight_corridor::crossing(directions_[i].T_D_C, fan_.box().size_m, ray_C);
    if (!crossing.meets()) continue;
    const double exit_px = geometry_.disparity(crossing.exit);
    if (corrected_px_[pixel.farthest] >= exit_px + kInside_px) continue;
    const double entry_px = crossing.entry > 0.0 ? std::min(from_px_, geometry_.disparity(crossing.entry)) : from_px_;
    if (corrected_px_[pixel.nearest] < entry_px || (!pixel.is_repeated && !(pixel.match_px < exit_px))) continue;
    if (isConfirmed(i, pixel) && !isMatchIn(i, pixel)) continue;
    const auto begin = corrected_px_.begin(), end = begin + end_d_;
    const auto first = std::lower_bound(begin + begin_d_, end, exit_px + kInside_px);
    if (first != end && *first < entry_px) visit(i, static_cast<int>(first - begin));
  }
}

/// Of pixels that are matched behind a box, and of repeated matches in it: what else is matched in it is for
/// BoxPatches.
void Doubt::markRow(int v, const ScaleCorrection& correction, Scratch& scratch) {
  cv::Rect view;
  int first_d = end_d_;
  for (int d = end_d_ - 1; d >= begin_d_; --d) {
    if (v < views_[d].y || v >= views_[d].br().y) continue;
    view |= views_[d];
    first_d = d;
  }
  std::fill(bits_.begin() + begin(v, first_d), bits_.begin() + begin(v, end_d_), 0);
  for (int u = view.x; u < view.br().x; ++u) markPixel(v * geometry_.size().width + u, first_d, correction, scratch);
}

void Doubt::markPixel(int at, int first_d, const ScaleCorrection& correction, Scratch& scratch) {
  const int words = evidence_.set.channels() / 8, width = geometry_.size().width;
  const auto* set = evidence_.set.ptr<std::uint64_t>() + static_cast<std::size_t>(at) * words;
  const bool has_competitor = (evidence_.flags.data[at] & kCompetitor) != 0;
  if (!has_competitor && firstBitFrom(set, words, first_d) >= end_d_) return;
  const float best_px = evidence_.best_px.ptr<float>()[at], repeated_px = evidence_.repeated_px.ptr<float>()[at];
  matches_px_[at] = correction.correct(std::isnan(repeated_px) ? best_px : repeated_px);
  if (std::isnan(matches_px_[at])) return;
  const Pixel pixel = this->pixel(at);
  const auto add = [&](int d) {
    if (isAlternative(pixel, d) && views_[d].contains({at % width, at / width})) mark(d, at);
  };
  for (int word = first_d / 64; word < words; ++word) {
    std::uint64_t bits = bitsTo(bitsFrom(set[word], word, first_d), word, end_d_ - 1);
    for (; bits != 0; bits &= bits - 1) add(64 * word + lowestBit(bits));
  }
  if (!has_competitor) return;
  add(pixel.farthest);
  add(pixel.nearest);
  if (pixel.is_repeated) scratch.repeated.push_back(at);
  visitBracketed(pixel, scratch, [&](int, int d) { mark(d, at); });
}

/// Whether a disparity is one of a pixel's other disparities, where a box may be.
bool Doubt::isAlternative(const Pixel& pixel, int d) const {
  const bool is_other = pixel.is_repeated || corrected_px_[d] >= pixel.match_px + kInside_px;
  const bool is_competitor = pixel.has_competitor && (d == pixel.farthest || d == pixel.nearest);
  return begin_d_ <= d && d < end_d_ && is_other && (is_competitor || pixel.isInSet(d));
}

bool Doubt::isMatchIn(int direction, const Pixel& pixel) const {
  return end_px_ <= pixel.match_px && pixel.match_px < from_px_ &&
         fan_.contains(fan_.turned(direction, point(pixel, pixel.match_px)));
}

/// Whether an alternative that fits in a direction's box may be there.
bool Doubt::mayBeIn(int direction, const Pixel& pixel, int d) const {
  const bool is_behind = pixel.match_px < corrected_px_[d] && !isMatchIn(direction, pixel);
  if (!is_behind) return pixel.is_repeated;
  return !isConfirmed(direction, pixel) || pixel.isInSet(d);
}

/// Whether the LiDAR measured the surface on which a pixel is matched. Of other surfaces it says nothing.
bool Doubt::isConfirmed(int direction, const Pixel& pixel) const {
  return isOneSurface(pixel.match_px, directions_[direction].question.lidar_px);
}

void Doubt::addRepeated(const Pixel& pixel) {
  if (!isAlternative(pixel, pixel.farthest)) return;
  const auto d = std::lower_bound(corrected_px_.begin(), corrected_px_.end() - 1, pixel.match_px);
  const double pixel_m2 = std::pow(geometry_.pixelEdge(corrected_px_[pixel.farthest]), 2);
  const Eigen::Vector3f farthest_F = point(pixel, corrected_px_[pixel.farthest] - kInside_px);
  fan_.visit(farthest_F, 0.0f, [&](int direction, const Eigen::Vector3f&) {
    Direction& one = directions_[direction];
    if (one.question.is_open && isMatchIn(direction, pixel)) one.repeated_m2[d - corrected_px_.begin()] += pixel_m2;
  });
}

/// Whether pixels at one disparity that touch each other cover the smallest obstacle's area, in each direction's box.
void Doubt::checkDisparity(int d, double smallest_m2, Scratch& scratch) const {
  const double smallest_px = smallest_m2 / std::pow(geometry_.pixelEdge(corrected_px_[d]), 2);
  const int width = geometry_.size().width;
  for (Scratch::Box& box : scratch.boxes) box.clear();
  const cv::Rect& view = views_[d];
  const auto is_undecided = [](const Scratch::Box& box) { return box.is_undecided; };
  if (view.empty() || std::none_of(scratch.boxes.begin(), scratch.boxes.end(), is_undecided)) return;
  const int first_word = view.x / 64, words = wordsOf(view.br().x) - first_word;
  const BitImage image{bits_.data() + begin(view.y, d) + first_word, begin(1, d) - begin(0, d), view.height, words};
  for (const BitPatches::Run& run : scratch.patches.find(image, smallest_px)) {
    const int row = (view.y + run.v) * width + 64 * first_word;
    for (int at = row + run.first_u; at < row + run.end_u; ++at) {
      const Pixel pixel = this->pixel(at);
      const auto add = [&](int direction, const Eigen::Vector3f&) {
        Scratch::Box& box = scratch.boxes[direction];
        if (box.is_undecided && mayBeIn(direction, pixel, d)) box.add(at / width, at % width);
      };
      if (isAlternative(pixel, d)) fan_.visit(point(pixel, corrected_px_[d] - kInside_px), 0.0f, add);
      visitBracketed(pixel, scratch, [&](int direction, int bracketed) {
        if (bracketed == d) scratch.boxes[direction].add(at / width, at % width);
      });
    }
  }
  for (Scratch::Box& box : scratch.boxes) {
    box.is_undecided = box.is_undecided && !holdsPatch(box, d, smallest_px, scratch);
  }
}

/// Whether pixels that may be in a box form such a patch, which no earlier pair refutes.
bool Doubt::holdsPatch(const Scratch::Box& box, int d, double smallest_px, Scratch& scratch) const {
  if (box.pixels == 0 || box.pixels < smallest_px) return false;
  const int words = wordsOf(geometry_.size().width), first_v = box.runs.front().v;
  const int rows = box.runs.back().v - first_v + 1;
  scratch.box_bits.assign(static_cast<std::size_t>(rows * words), 0);
  for (const BitPatches::Run& run : box.runs) {
    for (int u = run.first_u; u < run.end_u; ++u) {
      scratch.box_bits[(run.v - first_v) * words + u / 64] |= std::uint64_t{1} << u % 64;
    }
  }
  std::map<int, std::vector<cv::Point>> patches;
  for (const BitPatches::Run& run : scratch.patches.find({scratch.box_bits.data(), words, rows, words}, smallest_px)) {
    for (int u = run.first_u; u < run.end_u; ++u) patches[run.patch].emplace_back(u, first_v + run.v);
  }
  for (auto& [index, patch] : patches) {
    if (!earlier_->empty() && isRefuted(patch, d)) continue;
    scratch.doubtful = std::move(patch);
    return true;
  }
  return false;
}

/// Of a bracketed pixel no place is known.
bool Doubt::isRefuted(const std::vector<cv::Point>& patch, int d) const {
  const int width = geometry_.size().width;
  std::vector<cv::Point> placed;
  std::copy_if(patch.begin(), patch.end(), std::back_inserter(placed),
               [&](const cv::Point& at) { return isAlternative(pixel(at.y * width + at.x), d); });
  return 2 * placed.size() > patch.size() && earlier_->refute(placed, corrected_px_[d], *correction_);
}

/// Whether repeated matches of one surface, to a pixel, cover most of the smallest obstacle; they need not touch.
bool Doubt::holdsRepeated(const Direction& direction, double smallest_m2) {
  const std::vector<double>& repeated_m2 = direction.repeated_m2;
  for (std::size_t d = 1; d + 1 < repeated_m2.size(); ++d) {
    const double surface_m2 = repeated_m2[d - 1] + repeated_m2[d] + repeated_m2[d + 1];
    if (surface_m2 > 0.0 && surface_m2 >= kMostOfObstacle * smallest_m2) return true;
  }
  return false;
}

cv::Mat Doubt::image() const {
  cv::Mat shown = cv::Mat::zeros(geometry_.size(), CV_8UC1);
  for (int d = begin_d_; d < end_d_; ++d) {
    const cv::Rect& view = views_[d];
    for (int v = view.y; v < view.br().y; ++v) {
      const std::uint64_t* row = bits_.data() + begin(v, d);
      for (int u = view.x; u < view.br().x; ++u) {
        const int at = v * shown.cols + u;
        if (!(row[u / 64] >> u % 64 & 1u) || shown.data[at]) continue;
        const Pixel pixel = this->pixel(at);
        const bool is_bracketed = !isAlternative(pixel, d);
        const auto isInBox = [&] {
          return fan_.contains(fan_.turned(0, point(pixel, corrected_px_[d] - kInside_px))) && mayBeIn(0, pixel, d);
        };
        if (is_bracketed || isInBox()) shown.data[at] = 128;
      }
    }
  }
  bool is_of_patch = false;
  for (const Scratch& scratch : scratch_) {
    is_of_patch |= !scratch.doubtful.empty();
    for (const cv::Point& at : scratch.doubtful) shown.at<std::uint8_t>(at) = 255;
  }
  const Direction& first = directions_.front();
  if (!first.is_doubtful || is_of_patch) return shown;
  const auto& repeated_m2 = first.repeated_m2;  // of the surface that shows most
  const auto most = std::max_element(repeated_m2.begin(), repeated_m2.end()) - repeated_m2.begin();
  for (int at = 0; at < shown.size().area(); ++at) {
    const Pixel pixel = this->pixel(at);
    const auto d = std::lower_bound(corrected_px_.begin(), corrected_px_.end() - 1, pixel.match_px);
    const bool is_of_it = std::abs(d - corrected_px_.begin() - most) <= 1 && pixel.is_repeated;
    if (is_of_it && shown.data[at] == 128) shown.data[at] = 255;
  }
  return shown;
}

}  // namespace flight_corridor
