#include "flight_corridor/motion/earlier_matches.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor {

namespace {

constexpr std::size_t kMostMatches = 3;    // pairs: their sets are large
constexpr std::size_t kMostSamples = 100;  // pixels of a patch that are looked up
constexpr double kSigmas = 2.0;            // of the motion's error
constexpr double kFit_px = 1.0;            // a disparity so near to a place's fits there
constexpr double kFitting = 0.5;  // of a patch's pixels: in every pair some of a real one are matched otherwise

}  // namespace

EarlierMatches::EarlierMatches(const StereoGeometry& geometry, double nearest_m)
    : geometry_(geometry),
      first_px_(firstDisparity(geometry)),
      largest_px_(geometry.disparity(nearest_m)),
      pairs_(kMostMatches) {}

void EarlierMatches::add(double stamp_s, const CameraPose& pose, DisparityEvidence& matches) {
  if (DisparityEvidence* kept = pairs_.add(stamp_s, pose)) std::swap(*kept, matches);
}

bool EarlierMatches::refute(const std::vector<cv::Point>& patch, double at_px,
                            const ScaleCorrection& correction) const {
  const std::size_t step = 1 + (patch.size() - 1) / kMostSamples;
  std::vector<cv::Point> samples;
  for (std::size_t i = 0; i < patch.size(); i += step) samples.push_back(patch[i]);
  const double depth_m = geometry_.depth(at_px);
  return std::any_of(pairs_.views().begin(), pairs_.views().end(),
                     [&](const Ring::View& view) { return refute(view, samples, depth_m, correction); });
}

/// A pair that does not show all of the patch in both images, or whose search does not reach it, refutes nothing.
bool EarlierMatches::refute(const Ring::View& view, const std::vector<cv::Point>& patch, double depth_m,
                            const ScaleCorrection& correction) const {
  const cv::Size size = geometry_.size();
  std::vector<Place> places;
  int reach = 0;
  for (const cv::Point& pixel : patch) {
    const Eigen::Vector3d p_E = view.motion.T_K_C * geometry_.point(pixel.x, pixel.y, depth_m);
    const Eigen::Vector2d at = geometry_.project(p_E);
    if (!geometry_.contains(at)) return false;
    const double corrected_px = geometry_.disparity(p_E.z());
    const double measured_px = corrected_px * correction.scale(corrected_px);
    const double fit_px = kFit_px + kSigmas * measured_px * view.motion.sigma_m / p_E.z();
    places.push_back({{cvRound(at.x()), cvRound(at.y())}, measured_px - fit_px, measured_px + fit_px});
    reach = std::max(reach, cvRound(kSigmas * geometry_.calibration().fx_px * view.motion.error(p_E.z()) / p_E.z()));
  }
  const double shift_px = geometry_.principalPointDifference();
  const bool is_shown = std::all_of(places.begin(), places.end(), [&](const Place& place) {
    return first_px_ <= place.first_px && place.last_px <= largest_px_ &&
           place.pixel.x - reach >= std::max(0.0, place.last_px + shift_px) && place.pixel.x + reach < size.width &&
           place.pixel.y >= reach && place.pixel.y + reach < size.height;
  });
  if (!is_shown) return false;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const auto fitting = std::count_if(places.begin(), places.end(), [&](const Place& place) {
        return fits(*view.kept, place, {x, y});
      });
      if (static_cast<double>(fitting) >= kFitting * static_cast<double>(places.size())) return false;
    }
  }
  return true;
}

/// What is matched nearer hides the place; so may whatever a pixel without a match is of.
bool EarlierMatches::fits(const DisparityEvidence& matches, const Place& place, const cv::Point& moved_px) const {
  const cv::Point at = place.pixel + moved_px;
  const float best_px = matches.best_px.at<float>(at), repeated_px = matches.repeated_px.at<float>(at);
  if (best_px >= place.first_px || repeated_px >= place.first_px) return true;  // not of NaN
  const bool has_competitor = (matches.flags.at<std::uint8_t>(at) & kCompetitor) != 0;
  if (has_competitor && matches.competitor_nearest.at<std::uint8_t>(at) + first_px_ >= place.first_px) return true;
  const int words = matches.set.channels() / 8;
  const auto* set = matches.set.ptr<std::uint64_t>(at.y) + static_cast<std::size_t>(at.x) * words;
  const int found = firstBitFrom(set, words, static_cast<int>(std::ceil(place.first_px - first_px_)));
  const bool is_matched = !std::isnan(best_px) || !std::isnan(repeated_px);
  return found < 64 * words && (!is_matched || found + first_px_ <= place.last_px);
}

}  // namespace flight_corridor
