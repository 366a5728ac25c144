#include "flight_corridor/range/beam_footprint.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace flight_corridor {

namespace {

constexpr double kSmallestForward = 0.5;    // cosine of the largest angle between beam and optical axis
constexpr double kSmallestRadius_px = 2.0;  // a footprint narrower than a matching block holds one measurement anyway
constexpr int kIterations = 4;              // until footprint and range agree
constexpr double kGaussianMad = 1.4826;     // median absolute deviation to sigma
constexpr double kAround = 6.0;             // radii around a footprint in which its surface should be alone
constexpr double kBeside = 3.0;             // ... within which the beam may have met something

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

BeamFootprint::BeamFootprint(const LidarConfig& config, const StereoGeometry& geometry, const Eigen::Isometry3d& T_C_L,
                             double disparity_sigma_px)
    : config_(config),
      geometry_(geometry),
      origin_C_(T_C_L.translation()),
      direction_C_(T_C_L.linear() * Eigen::Vector3d::UnitX()),
      disparity_sigma_px_(disparity_sigma_px) {
  throwIfBroken(check(config));
  if (!looksAhead(T_C_L)) {
    throw std::invalid_argument(
        "the LiDAR's beam does not point where the camera looks: check its pose (beam along +x)");
  }
}

bool BeamFootprint::looksAhead(const Eigen::Isometry3d& T_C_L) {
  return T_C_L.matrix().allFinite() && T_C_L.linear()(2, 0) >= kSmallestForward;
}

bool BeamFootprint::endsInView(const LidarConfig& config, const StereoGeometry& geometry,
                               const Eigen::Isometry3d& T_C_L) {
  return geometry.contains(geometry.project(T_C_L * Eigen::Vector3d(config.max_range_m, 0.0, 0.0)));
}

std::optional<Footprint> BeamFootprint::at(double range_m, double beam_width_rad) const {
  const Eigen::Vector3d p_C = point(range_m);
  const Eigen::Vector2d centre_px = geometry_.project(p_C);
  if (!geometry_.contains(centre_px)) return std::nullopt;
  const double width_rad = std::fmax(beam_width_rad, config_.min_beam_width_rad);
  const double radius_m = range_m * std::tan(0.5 * std::min(width_rad, 1.0));
  return Footprint{centre_px, std::max(geometry_.calibration().fx_px * radius_m / p_C.z(), kSmallestRadius_px)};
}

std::optional<FootprintReading> BeamFootprint::read(const cv::Mat& disparity_px, double range_guess_m,
                                                    double beam_width_rad) {
  double range_m = std::isfinite(range_guess_m) ? range_guess_m : config_.max_range_m;
  std::optional<FootprintReading> reading;
  for (int i = 0; i < kIterations; ++i) {
    const auto footprint = at(range_m, beam_width_rad);
    if (!footprint) return std::nullopt;
    reading = readAt(disparity_px, *footprint);
    if (!reading) return std::nullopt;
    const auto agreed = at(reading->range_m, beam_width_rad);
    if (agreed && (agreed->centre_px - footprint->centre_px).norm() <= 0.5 * footprint->radius_px) return reading;
    range_m = reading->range_m;
  }
  return std::nullopt;  // the pixel jumps between surfaces: none is where the beam would meet it
}

/// Refills scratch_ with the matches within a circle.  @return how many pixels it holds.
int BeamFootprint::collect(const cv::Mat& disparity_px, const Footprint& circle) {
  scratch_.clear();
  const Eigen::Vector2d& centre = circle.centre_px;
  const int v_first = std::max(0, static_cast<int>(std::ceil(centre.y() - circle.radius_px)));
  const int v_last = std::min(disparity_px.rows - 1, static_cast<int>(std::floor(centre.y() + circle.radius_px)));
  int pixels = 0;
  for (int v = v_first; v <= v_last; ++v) {
    const double half = std::sqrt(std::max(0.0, std::pow(circle.radius_px, 2) - std::pow(v - centre.y(), 2)));
    const int u_first = std::max(0, static_cast<int>(std::ceil(centre.x() - half)));
    const int u_last = std::min(disparity_px.cols - 1, static_cast<int>(std::floor(centre.x() + half)));
    for (int u = u_first; u <= u_last; ++u, ++pixels) {
      const float d = disparity_px.at<float>(v, u);
      if (d > 0.0f) scratch_.push_back(d);
    }
  }
  return pixels;
}

std::optional<FootprintReading> BeamFootprint::readAt(const cv::Mat& disparity_px, const Footprint& footprint) {
  const int pixels = collect(disparity_px, footprint);
  if (scratch_.empty() || scratch_.size() < config_.min_valid_fraction * pixels) return std::nullopt;

  FootprintReading reading;
  reading.footprint = footprint;
  reading.disparity_px = median(scratch_);
  for (float& d : scratch_) d = std::abs(d - static_cast<float>(reading.disparity_px));
  reading.disparity_sigma_px = kGaussianMad * median(scratch_);
  reading.range_m = range(geometry_.depth(reading.disparity_px));
  collect(disparity_px, {footprint.centre_px, kAround * footprint.radius_px});
  const auto same =
      std::count_if(scratch_.begin(), scratch_.end(), [&](float d) { return isSameSurface(d, reading.disparity_px); });
  reading.unity = static_cast<double>(same) / static_cast<double>(scratch_.size());
  return reading;
}

const std::vector<float>& BeamFootprint::matchesBeside(const cv::Mat& disparity_px, double range_m,
                                                       double beam_width_rad) {
  scratch_.clear();
  const auto footprint = at(range_m, beam_width_rad);
  if (!footprint) return scratch_;
  const int pixels = collect(disparity_px, {footprint->centre_px, kBeside * footprint->radius_px});
  if (scratch_.size() < config_.min_valid_fraction * pixels) scratch_.clear();
  return scratch_;
}

}  // namespace flight_corridor
