#include "flight_corridor/geometry/stereo_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace flight_corridor {

namespace {

constexpr double kShortestBaseline_m = 0.01, kLongestBaseline_m = 2.0;  // that an aircraft, or a car, has room for
constexpr double kUsualBaselines_m[] = {0.03, 0.6};
constexpr double kMiddle = 0.063;  // of an image's width and height: nearer to the middle is the principal point

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

/// Lens and rectification move it by more than this along one side at most; a calibration of another image size moves
/// it along both, by one factor.
void requirePrincipalPoint(const StereoCalibration& calibration, std::string& faults) {
  const cv::Size& size_px = calibration.size_px;
  const double across = calibration.cx_px / size_px.width - 0.5, down = calibration.cy_px / size_px.height - 0.5;
  if (std::min(std::abs(across), std::abs(down)) <= kMiddle || across * down < 0.0) return;
  const double factor = 1.0 + across + down;
  std::ostringstream text;
  text << " the principal point (" << calibration.cx_px << ", " << calibration.cy_px << ") is far from the middle of "
       << size_px.width << " x " << size_px.height << " px";
  if (factor > 0.0) {
    text << ": the calibration is likely of " << std::lround(factor * size_px.width) << " x "
         << std::lround(factor * size_px.height) << " px";
  }
  faults += text.str() + ";";
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

bool StereoGeometry::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= 0.0 && pixel.x() <= calibration_.size_px.width - 1 && pixel.y() >= 0.0 &&
         pixel.y() <= calibration_.size_px.height - 1;
}

}  // namespace flight_corridor
