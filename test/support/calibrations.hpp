#pragma once

#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor::test_support {

/// The paper's rig in round numbers: VGA, f = 350 px, B = 0.12 m.
inline StereoCalibration vgaCalibration() {
  StereoCalibration calibration;
  calibration.size_px = {640, 480};
  calibration.fx_px = calibration.fy_px = 350.0;
  calibration.cx_px = calibration.cx_right_px = 319.5;
  calibration.cy_px = 239.5;
  calibration.baseline_m = 0.12;
  return calibration;
}

/// The same view with a quarter of the pixels, for tests that need many images.
inline StereoCalibration smallCalibration() {
  StereoCalibration calibration = vgaCalibration();
  calibration.size_px = {320, 240};
  calibration.fx_px = calibration.fy_px = 175.0;
  calibration.cx_px = calibration.cx_right_px = 159.5;
  calibration.cy_px = 119.5;
  return calibration;
}

inline const StereoGeometry kVgaGeometry{vgaCalibration()};
inline const StereoGeometry kSmallGeometry{smallCalibration()};  // f*B = 21 px m

}  // namespace flight_corridor::test_support
