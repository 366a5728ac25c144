#include "flight_corridor/geometry/stereo_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kShortestBaseline_m = 0.01, kLongestBaseline_m = 2.0;  // that an aircraft, or a car, has room for
constexpr double kUsualBaselines_m[] = {0.03, 0.6};                     // by which the unit of another is guessed
// How far rectified pairs' principal points are from the middle, as a share of width and height.
constexpr double kMostAcross = 0.16, kMostDown = 0.12, kMostOfBoth = 0.063;
constexpr double kUsualAcross = 0.09, kUsualDown = 0.05, kUsualOfBoth = 0.03;  // beyond, it is warned about

void requirePositive(double value, const char* name, std::string& faults) {
  if (!(value > 0.0 && std::isfinite(value))) {
    faults += " " + std::string(name) + " must be positive (" + std::to_string(value) + ");";
  }
}

/// In which unit a baseline was given, if in metres no aircraft has it.
std::string likelyUnit(double baseline) {
  std::string text;
  for (const auto& [unit, metres] : {std::pair("mm", 0.001), std::pair("cm", 0.01), std::pair("inches", 0.0254)}) {
    const double baseline_m = baseline * metres;
    if (!(kUsualBaselines_m[0] <= baseline_m && baseline_m <= kUsualBaselines_m[1])) continue;
    text +=
        (text.empty() ? "; likely in " : ", or in ") + std::string(unit) + " (" + std::to_string(baseline_m) + " m)";
  }
  return text;
}

void requireBaseline(double baseline_m, std::string& faults) {
  if (kShortestBaseline_m <= baseline_m && baseline_m <= kLongestBaseline_m) return;
  std::ostringstream text;
  text << " baseline must be " << kShortestBaseline_m << " to " << kLongestBaseline_m << " m (" << baseline_m << " m"
       << likelyUnit(baseline_m) << (baseline_m < 0.0 ? "; left and right are exchanged" : "")
       << (baseline_m == 0.0 ? "; both cameras have the same position" : "") << ");";
  faults += text.str();
}

void requireFinite(double value, const char* name, std::string& faults) {
  if (!std::isfinite(value)) faults += " " + std::string(name) + " must be finite;";
}

/// Where the principal point is, from the middle, as a share of width and height. Of two that differ it is the middle
/// one: a region of the image moves both by as much.
struct PrincipalPoint {
  cv::Size size_px;
  double cx_px, cy_px;

  explicit PrincipalPoint(const StereoCalibration& calibration)
      : size_px(calibration.size_px),
        cx_px(0.5 * (calibration.cx_px + calibration.cx_right_px)),
        cy_px(calibration.cy_px) {}

  double across() const { return cx_px / size_px.width - 0.5; }
  double down() const { return cy_px / size_px.height - 0.5; }
  /// By which both are off at least; images of another size move both by one factor.
  double ofBoth() const { return across() * down() > 0.0 ? std::min(std::abs(across()), std::abs(down())) : 0.0; }
  bool exceeds(double across_most, double down_most, double both_most) const {
    return std::abs(across()) > across_most || std::abs(down()) > down_most || ofBoth() > both_most;
  }
};

/// "cy is at 67 % of the height, at 38 to 62 % in rectified pairs"
std::string offMiddle(const char* name, const char* side, double off, double most) {
  if (std::abs(off) <= most) return "";
  std::ostringstream text;
  text << "; " << name << " is at " << std::lround(100.0 * (0.5 + off)) << " % of the " << side << ", at "
       << std::lround(100.0 * (0.5 - most)) << " to " << std::lround(100.0 * (0.5 + most)) << " % in rectified pairs";
  return text.str();
}

/// Of a larger image they show a part: likely the middle one.
std::string likelyCrop(const char* name, int size_px, double likely_px) {
  if (likely_px <= size_px) return "";
  const double first = std::floor(0.5 * (likely_px - size_px));
  std::ostringstream text;
  text << ", of which these images show " << size_px << " " << name << ", e.g. " << first << " to " << first + size_px;
  return text.str();
}

/// The size of which the principal point would be near the middle, and what these images are of it.
std::string likelySize(const PrincipalPoint& point) {
  const cv::Size& size_px = point.size_px;
  const double across = std::abs(point.across()), down = std::abs(point.down()), both = point.ofBoth();
  std::ostringstream text;
  if (both > kUsualOfBoth && both > 0.5 * std::max(across, down)) {
    const double factor = 1.0 + point.across() + point.down();
    if (!(factor > 0.0)) return "";
    text << ": the calibration is likely of " << std::round(factor * size_px.width) << " x "
         << std::round(factor * size_px.height) << " px";
    return text.str();
  }
  const auto likely = [](double centre_px, double off, double usual, double size_px) {
    return off > usual ? 2.0 * std::round(centre_px) : size_px;
  };
  const double width_px = likely(point.cx_px, across, kUsualAcross, size_px.width);
  const double height_px = likely(point.cy_px, down, kUsualDown, size_px.height);
  if (width_px <= 0 || height_px <= 0) return "";
  text << ": the calibration is likely of " << width_px << " x " << height_px << " px"
       << likelyCrop("columns", size_px.width, width_px) << likelyCrop("rows", size_px.height, height_px);
  return text.str();
}

std::string describePrincipalPoint(const StereoCalibration& calibration, double across_most, double down_most) {
  const PrincipalPoint point(calibration);
  std::ostringstream text;
  text << "the principal point (" << calibration.cx_px << ", " << calibration.cy_px << ") is far from the middle of "
       << calibration.size_px.width << " x " << calibration.size_px.height << " px" << likelySize(point)
       << offMiddle("cx", "width", point.across(), across_most) << offMiddle("cy", "height", point.down(), down_most);
  return text.str();
}

/// Lens and rectification move it by so much at most, and along one side more than along both.
void requirePrincipalPoint(const StereoCalibration& calibration, std::string& faults) {
  if (!PrincipalPoint(calibration).exceeds(kMostAcross, kMostDown, kMostOfBoth)) return;
  faults += " " + describePrincipalPoint(calibration, kMostAcross, kMostDown) + ";";
}

std::string faultsOf(const StereoCalibration& calibration) {
  std::string faults;
  if (calibration.size_px.width < 2 || calibration.size_px.height < 2) {
    faults += " width and height must be 2 or more (" + std::to_string(calibration.size_px.width) + " x " +
              std::to_string(calibration.size_px.height) + ");";
  }
  requirePositive(calibration.fx_px, "fx", faults);
  requirePositive(calibration.fy_px, "fy", faults);
  requireBaseline(calibration.baseline_m, faults);
  requireFinite(calibration.cx_px, "cx", faults);
  requireFinite(calibration.cy_px, "cy", faults);
  requireFinite(calibration.cx_right_px, "right cx", faults);
  if (faults.empty()) requirePrincipalPoint(calibration, faults);
  if (!(std::abs(calibration.cx_px - calibration.cx_right_px) < calibration.size_px.width)) {
    faults += " the principal points must differ by less than the width;";
  }
  return faults;
}

}  // namespace

Eigen::Isometry3d opticalFromForward() {
  Eigen::Isometry3d T_C_F = Eigen::Isometry3d::Identity();
  T_C_F.linear() << 0, -1, 0,  // x right   = -left
      0, 0, -1,                // y down    = -up
      1, 0, 0;                 // z forward = forward
  return T_C_F;
}

std::string doubtsOf(const StereoCalibration& calibration) {
  const bool is_unusual = PrincipalPoint(calibration).exceeds(kUsualAcross, kUsualDown, kUsualOfBoth);
  return is_unusual ? describePrincipalPoint(calibration, kUsualAcross, kUsualDown) : "";
}

StereoGeometry::StereoGeometry(const StereoCalibration& calibration)
    : calibration_(calibration), focal_baseline_px_m_(calibration.fx_px * calibration.baseline_m) {
  const std::string faults = faultsOf(calibration);
  if (!faults.empty()) throw std::invalid_argument("impossible stereo calibration:" + faults);
}

Eigen::Vector2d StereoGeometry::project(const Eigen::Vector3d& p_C) const {
  if (!(p_C.z() > 0.0)) return {kNaN, kNaN};
  return {calibration_.fx_px * p_C.x() / p_C.z() + calibration_.cx_px,
          calibration_.fy_px * p_C.y() / p_C.z() + calibration_.cy_px};
}

Eigen::Matrix3d StereoGeometry::cameraMatrix() const {
  Eigen::Matrix3d K;
  K << calibration_.fx_px, 0.0, calibration_.cx_px, 0.0, calibration_.fy_px, calibration_.cy_px, 0.0, 0.0, 1.0;
  return K;
}

bool StereoGeometry::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= 0.0 && pixel.x() <= calibration_.size_px.width - 1 && pixel.y() >= 0.0 &&
         pixel.y() <= calibration_.size_px.height - 1;
}

}  // namespace flight_corridor
