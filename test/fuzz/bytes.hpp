#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor::fuzz {

/// A fuzzer's input as numbers, in order; zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }

  /// Any bit pattern.
  template <typename T>
  T raw() {
    T value{};
    const std::size_t taken = std::min(size_, sizeof(T));
    if (taken > 0) std::memcpy(&value, data_, taken);
    skip(taken);
    return value;
  }

  bool flag() { return raw<std::uint8_t>() & 1u; }
  /// From low to high, both included.
  int integer(int low, int high) { return low + raw<std::uint16_t>() % (high - low + 1); }
  /// From low to high.
  double real(double low, double high) {
    return low + (high - low) * raw<std::uint16_t>() / std::numeric_limits<std::uint16_t>::max();
  }

  /// One that is usual, mostly; else any at all.
  double number(double low, double high) {
    constexpr std::array<double, 8> kOdd{0.0, -0.0, -1.0, 1e-310, 1e308, kInfinity, -kInfinity, kNaN};
    const auto kind = raw<std::uint8_t>();
    if (kind < 224) return real(low, high);
    return kind < 232 ? kOdd[kind % kOdd.size()] : raw<double>();
  }

  template <typename T, std::size_t n>
  const T& oneOf(const std::array<T, n>& choices) {
    return choices[raw<std::uint8_t>() % n];
  }

  /// Up to so many bytes.
  std::string text(std::size_t most) {
    const std::size_t taken = std::min({most, size_, static_cast<std::size_t>(raw<std::uint8_t>()), size_});
    const std::string text(reinterpret_cast<const char*>(data_), std::min(taken, size_));
    skip(text.size());
    return text;
  }

 private:
  void skip(std::size_t count) {
    data_ += count;
    size_ -= count;
  }

  const std::uint8_t* data_;
  std::size_t size_;
};

/// Ends the run with the law that is broken.
inline void require(bool holds, const char* law, const Verdict& verdict = {}) {
  if (holds) return;
  std::fprintf(stderr, "BROKEN LAW: %s: %s %s, clear %g m, unknown %g\n", law, toString(verdict.state),
               describeReasons(verdict.reasons).c_str(), verdict.clear_distance_m, verdict.unknown_fraction);
  std::abort();
}

/// What every verdict obeys.
inline void checkVerdict(const Verdict& verdict) {
  require(verdict.state == stateOf(verdict.reasons), "a state has its reasons", verdict);
  require(0.0 <= verdict.unknown_fraction && verdict.unknown_fraction <= 1.0, "a share is 0 to 1", verdict);
  require(!(verdict.clear_distance_m < 0.0), "a distance is not negative", verdict);
  require(verdict.state != State::Free || verdict.clear_distance_m == kInfinity, "FREE has no obstacle", verdict);
}

/// A small rig on which 4 m are 5 px: something is FREE, and something BLOCKED.
inline StereoCalibration smallRig() {
  StereoCalibration calibration;
  calibration.size_px = {64, 48};
  calibration.fx_px = calibration.fy_px = 40.0;
  calibration.cx_px = calibration.cx_right_px = 31.5;
  calibration.cy_px = 23.5;
  calibration.baseline_m = 0.5;
  return calibration;
}

/// The small rig, or one of any other numbers.
inline StereoCalibration anyRig(Bytes& bytes) {
  StereoCalibration calibration = smallRig();
  if (bytes.flag()) return calibration;
  calibration.size_px = {bytes.integer(2, 96), bytes.integer(2, 64)};
  calibration.fx_px = bytes.number(1.0, 200.0);
  calibration.fy_px = bytes.flag() ? calibration.fx_px : bytes.number(1.0, 200.0);
  calibration.cx_px = bytes.number(-50.0, 150.0);
  calibration.cy_px = bytes.number(-50.0, 100.0);
  calibration.cx_right_px = bytes.flag() ? calibration.cx_px : bytes.number(-50.0, 150.0);
  calibration.baseline_m = bytes.number(0.01, 2.0);
  return calibration;
}

/// Of the pipeline on small images, with a coarse map: fast.
inline Config smallConfig() {
  Config config;
  config.stereo.num_disparities_px = 32;
  config.map.resolution_m = 0.2;
  config.map.max_range_m = 6.0;
  return config;
}

inline cv::Mat noise(cv::Size size_px, std::uint64_t seed, double blur_px = 0.0) {
  cv::Mat image(size_px, CV_8UC1);
  cv::RNG(seed).fill(image, cv::RNG::UNIFORM, 0, 256);
  if (blur_px > 0.0) cv::GaussianBlur(image, image, {3, 3}, blur_px);
  return image;
}

/// A rectangle across the view; where in the left image, at which disparity.
struct Plate {
  cv::Rect area_px;
  int disparity_px;
};

/// Draws a textured plate into both images. Far ones first.
inline void draw(const Plate& plate, int principal_difference_px, std::uint64_t seed, StereoFrame& frame) {
  const cv::Mat texture = noise(plate.area_px.size(), seed, 0.8);
  const auto put = [&](cv::Mat& image, int shift_px) {
    const cv::Rect place = plate.area_px - cv::Point(shift_px, 0);
    const cv::Rect seen = place & cv::Rect({}, image.size());
    if (!seen.empty()) texture(seen - place.tl()).copyTo(image(seen));
  };
  put(frame.left, 0);
  put(frame.right, plate.disparity_px + principal_difference_px);
}

/// A textured wall across the view.
inline StereoFrame wall(const StereoGeometry& geometry, int disparity_px, double stamp_s, std::uint64_t seed) {
  StereoFrame frame{stamp_s, cv::Mat::zeros(geometry.size(), CV_8UC1), cv::Mat::zeros(geometry.size(), CV_8UC1)};
  const int difference_px = static_cast<int>(geometry.principalPointDifference());
  const int reach_px = std::abs(disparity_px + difference_px);
  const cv::Rect area(-reach_px, 0, geometry.size().width + 2 * reach_px, geometry.size().height);
  draw({area, disparity_px}, difference_px, seed, frame);
  return frame;
}

/// A pose; mostly one.
inline Eigen::Isometry3d pose(Bytes& bytes) {
  const auto angle = [&] { return bytes.number(-M_PI, M_PI); };
  const auto metres = [&] { return bytes.number(-5.0, 5.0); };
  const Eigen::Vector3d turn(angle(), angle(), angle());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(metres(), metres(), metres());
  T.linear() =
      (Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return T;
}

inline RangeReading reading(Bytes& bytes, double stamp_s) {
  return {stamp_s, bytes.number(0.0, 12.0), bytes.number(0.0, 0.5), bytes.number(5.0, 100.0), bytes.number(0.0, 0.1)};
}

}  // namespace flight_corridor::fuzz
