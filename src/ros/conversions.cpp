#include "ros/conversions.hpp"

#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "flight_corridor/stereo/matching_rules.hpp"
#include "flight_corridor/view/overlay.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

constexpr double kSamePx = 0.01;             // rounding in a calibration file
constexpr double kLongestLifetime_s = 60.0;  // ros::Duration holds no infinity
constexpr int kFewCounts = 4096;             // of 65536: 16 grey levels of the upper byte, too few to be matched
constexpr double kBeyond = 0.001;            // share of the pixels, on each side, that may be dead ones
constexpr int kFit = 224, kStep = 32;  // grey levels for the counts in use, the rest: they may drift within a step

std::string differ(const char* name, double left, double right) {
  if (std::abs(left - right) <= kSamePx) return "";
  return std::string(" ") + name + " of left and right differ (" + std::to_string(left) + ", " + std::to_string(right) +
         "): the pair is not rectified together;";
}

/// Entries of a rectified pair's P besides fx, fy, cx, cy and the baseline.
std::string faultsOf(const char* side, const sensor_msgs::CameraInfo& info) {
  std::string faults;
  if (std::all_of(info.P.begin(), info.P.end(), [](double p) { return p == 0.0; })) {
    return std::string(" P of ") + side + " is all 0: the camera is not calibrated;";
  }
  for (const std::size_t i : {1u, 4u, 7u, 8u, 9u, 10u, 11u}) {
    const double expected = i == 10 ? 1.0 : 0.0;
    if (std::abs(info.P[i] - expected) <= kSamePx) continue;
    faults += " P[" + std::to_string(i) + "] of " + side + " is " + std::to_string(info.P[i]) + ", must be " +
              (i == 10  ? "1"
               : i == 7 ? "0: the cameras must sit side by side"
                        : "0") +
              ";";
  }
  return faults;
}

/// REP 104: (0, 0, 0, 0) means the full image.
bool isFullImage(const sensor_msgs::CameraInfo& info) {
  const auto& roi = info.roi;
  const bool offset = roi.x_offset != 0 || roi.y_offset != 0;
  const bool cropped = (roi.width != 0 && roi.width != info.width) || (roi.height != 0 && roi.height != info.height);
  return !offset && !cropped && info.binning_x <= 1 && info.binning_y <= 1;
}

/// Values of 10 or 12 bits in the low end of 16 would be darkness.
void requireSixteenBits(const cv::Mat& values) {
  double brightest = 0.0;
  cv::minMaxIdx(values, nullptr, &brightest);
  if (brightest >= kFewCounts) return;
  throw std::invalid_argument("every pixel is below " + std::to_string(kFewCounts) +
                              " of 65535: values of 10 or 12 bits? Shift them up, or send mono8");
}

/// The values of 16 bits, those of a pixel side by side.
cv::Mat valuesOf(const sensor_msgs::Image& message) {
  const int channels = sensor_msgs::image_encodings::numChannels(message.encoding);
  const std::size_t row = std::size_t{2} * static_cast<std::size_t>(channels) * message.width;
  if (row == 0 || message.step < row || message.data.size() < std::size_t{message.step} * message.height) {
    throw std::invalid_argument("it is empty, or has fewer bytes than its width and height require");
  }
  cv::Mat values(static_cast<int>(message.height), channels * static_cast<int>(message.width), CV_16UC1);
  for (int y = 0; y < values.rows; ++y) {
    const std::uint8_t* bytes = message.data.data() + std::size_t{message.step} * static_cast<std::size_t>(y);
    auto* to = values.ptr<std::uint16_t>(y);
    for (int x = 0; x < values.cols; ++x) {
      const int first = bytes[2 * x], second = bytes[2 * x + 1];
      to[x] = static_cast<std::uint16_t>(message.is_bigendian ? 256 * first + second : 256 * second + first);
    }
  }
  return values;
}

/// As an image of 8 bits: a mosaic, too, is read as one of them.
cv_bridge::CvImageConstPtr eightBits(const sensor_msgs::Image& message, EightOfSixteen bits) {
  const cv::Mat values = valuesOf(message);
  requireSixteenBits(values);
  const auto eight = boost::make_shared<cv_bridge::CvImage>();
  eight->header = message.header;
  eight->encoding = message.encoding.substr(0, message.encoding.size() - 2) + "8";  // mono16, bayer_rggb16, bgr16, ...
  cv::Mat grey(values.size(), CV_8UC1);
  for (int y = 0; y < values.rows; ++y) {
    const auto* from = values.ptr<std::uint16_t>(y);
    std::uint8_t* to = grey.ptr(y);
    for (int x = 0; x < values.cols; ++x) {
      to[x] = cv::saturate_cast<std::uint8_t>(std::max(from[x] - bits.least, 0) >> bits.shift);
    }
  }
  eight->image = grey.reshape(sensor_msgs::image_encodings::numChannels(message.encoding));
  return eight;
}

/// Least and greatest of the values that two images use, but for few pixels.
std::pair<int, int> usedCounts(const cv::Mat& left, const cv::Mat& right) {
  std::vector<std::size_t> pixels(65536);
  for (const cv::Mat& values : {left, right}) {
    for (const std::uint16_t value : cv::Mat_<std::uint16_t>(values)) ++pixels[value];
  }
  const auto beyond = static_cast<std::size_t>(kBeyond * static_cast<double>(left.total() + right.total()));
  int least = 0, greatest = 65535;
  for (std::size_t below = pixels[0]; below <= beyond && least < greatest; below += pixels[++least]) {
  }
  for (std::size_t above = pixels[65535]; above <= beyond && least < greatest; above += pixels[--greatest]) {
  }
  return {least, greatest};
}

bool hasSixteenBits(const std::string& encoding) {
  const bool is_colour = sensor_msgs::image_encodings::isColor(encoding);
  return sensor_msgs::image_encodings::bitDepth(encoding) == 16 &&
         (is_colour || sensor_msgs::image_encodings::isMono(encoding) ||
          sensor_msgs::image_encodings::isBayer(encoding));
}

}  // namespace

flight_corridor::StereoCalibration toCalibration(const sensor_msgs::CameraInfo& left,
                                                 const sensor_msgs::CameraInfo& right) {
  std::string faults = differ("fx", left.P[0], right.P[0]) + differ("fy", left.P[5], right.P[5]) +
                       differ("cy", left.P[6], right.P[6]) + differ("width", left.width, right.width) +
                       differ("height", left.height, right.height) + faultsOf("left", left) + faultsOf("right", right);
  if (!isFullImage(left) || !isFullImage(right)) faults += " binning or a region of interest is set: send full images;";
  if (!faults.empty()) throw std::invalid_argument("CameraInfo:" + faults);
  flight_corridor::StereoCalibration calibration;
  calibration.size_px = cv::Size(static_cast<int>(left.width), static_cast<int>(left.height));
  calibration.fx_px = left.P[0];
  calibration.fy_px = left.P[5];
  calibration.cx_px = left.P[2];
  calibration.cy_px = left.P[6];
  calibration.cx_right_px = right.P[2];
  calibration.baseline_m = (left.P[3] - right.P[3]) / left.P[0];
  return calibration;
}

flight_corridor::RangeReading toReading(const sensor_msgs::Range& message) {
  return {message.header.stamp.toSec(), message.range, message.min_range, message.max_range, message.field_of_view};
}

EightOfSixteen bitsOf(const sensor_msgs::Image& left, const sensor_msgs::Image& right) try {
  if (!hasSixteenBits(left.encoding) || !hasSixteenBits(right.encoding)) return {};
  const auto [least, greatest] = usedCounts(valuesOf(left), valuesOf(right));
  const int counts = greatest - least;
  if (counts == 0 || counts >= kFewCounts) return {};
  int shift = 0;
  while ((counts >> shift) > kFit) ++shift;
  return {least - least % (kStep << shift), shift};
} catch (const std::exception&) {  // toGrey() speaks
  return {};
}

cv_bridge::CvImageConstPtr toGrey(const sensor_msgs::ImageConstPtr& message, EightOfSixteen bits) try {
  namespace encodings = sensor_msgs::image_encodings;
  if (hasSixteenBits(message->encoding)) return cv_bridge::cvtColor(eightBits(*message, bits), encodings::MONO8);
  // 8UC1 is grey without saying so; cv_bridge does not convert it.
  const bool is_grey = message->encoding == encodings::TYPE_8UC1;
  return cv_bridge::toCvShare(message, is_grey ? message->encoding : encodings::MONO8);
} catch (const std::exception& error) {
  throw std::invalid_argument("image of " + message->header.frame_id + ", encoding \"" + message->encoding +
                              "\", cannot be read as grey: " + error.what());
}

Eigen::Isometry3d toPose(const geometry_msgs::Pose& message) {
  const Eigen::Vector3d position(message.position.x, message.position.y, message.position.z);
  const auto& q = message.orientation;
  const Eigen::Quaterniond orientation(q.w, q.x, q.y, q.z);
  if (!position.allFinite()) throw std::invalid_argument("pose: the position is not finite");
  if (!isUnit(orientation)) {
    throw std::invalid_argument("pose: the orientation is not a unit quaternion, its norm is " +
                                std::to_string(orientation.norm()));
  }
  return Eigen::Translation3d(position) * orientation.normalized();
}

flight_corridor::CorridorState toMessage(const std_msgs::Header& header, const flight_corridor::Report& report,
                                         const Eigen::Vector3d& box_size_m, const flight_corridor::SpeedConfig& speed,
                                         double latency_s) {
  flight_corridor::CorridorState message;
  message.header = header;
  message.state = static_cast<std::uint8_t>(report.verdict.state);
  message.clear_distance = report.verdict.clear_distance_m;
  message.unknown_fraction = report.verdict.unknown_fraction;
  message.safe_speed = flight_corridor::safeSpeed(report.verdict.free_distance_m, latency_s, speed);
  tf2::toMsg(box_size_m, message.box);
  message.range_fused = report.range.range_m;
  message.range_fused_sigma = report.range.sigma_m;
  message.range_lidar = report.range_lidar_m;
  message.range_stereo = report.range_stereo_m;
  message.scale = report.scale;
  message.scale_sigma = report.scale_sigma;
  message.reasons = report.verdict.reasons;
  message.latency = latency_s;
  return message;
}

flight_corridor::QueryCorridorResponse toResponse(const ros::Time& stamp, const flight_corridor::Verdict& verdict) {
  flight_corridor::QueryCorridorResponse response;
  response.success = true;
  response.stamp = stamp;
  response.state = static_cast<std::uint8_t>(verdict.state);
  response.clear_distance = verdict.clear_distance_m;
  response.unknown_fraction = verdict.unknown_fraction;
  response.reasons = verdict.reasons;
  return response;
}

sensor_msgs::Range toRange(const ros::Time& stamp, const flight_corridor::RangeEstimate& estimate,
                           const flight_corridor::LidarConfig& config, const sensor_msgs::Range& lidar) {
  sensor_msgs::Range message = lidar;
  message.header.stamp = stamp;
  message.header.frame_id = withoutSlash(lidar.header.frame_id);
  message.min_range = static_cast<float>(config.min_range_m);
  message.max_range = static_cast<float>(config.max_range_m);
  message.range = static_cast<float>(estimate.range_m);
  return message;
}

sensor_msgs::ImagePtr toImage(const std_msgs::Header& header, const cv::Mat& image, const std::string& encoding) {
  return cv_bridge::CvImage(header, encoding, image).toImageMsg();
}

stereo_msgs::DisparityImage toDisparityImage(const std_msgs::Header& header, const cv::Mat& disparity_px,
                                             const flight_corridor::StereoGeometry& geometry, double nearest_m) {
  stereo_msgs::DisparityImage message;
  message.header = header;
  message.f = static_cast<float>(geometry.calibration().fx_px);
  message.T = static_cast<float>(geometry.calibration().baseline_m);
  message.min_disparity = 0.0f;  // the principal points' difference is taken out
  message.max_disparity = static_cast<float>(geometry.disparity(nearest_m));
  message.delta_d = 1.0f / flight_corridor::kSubpixels;  // the matcher's step; averages are finer
  message.valid_window.width = static_cast<std::uint32_t>(disparity_px.cols);
  message.valid_window.height = static_cast<std::uint32_t>(disparity_px.rows);
  cv::Mat marked = disparity_px.clone();
  cv::patchNaNs(marked, -1.0);
  message.image = *toImage(header, marked, sensor_msgs::image_encodings::TYPE_32FC1);
  return message;
}

visualization_msgs::Marker toMarker(const std_msgs::Header& header, const flight_corridor::Box& box,
                                    flight_corridor::State state, double lifetime_s) {
  const cv::Scalar bgr = flight_corridor::colour(state) / 255.0;
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = "corridor";
  marker.type = visualization_msgs::Marker::CUBE;
  marker.action = visualization_msgs::Marker::ADD;
  marker.lifetime = ros::Duration(std::min(lifetime_s, kLongestLifetime_s));
  marker.pose = tf2::toMsg(box.T_M_F * Eigen::Translation3d(box.size_m.x() / 2, 0.0, 0.0));
  tf2::toMsg(box.size_m, marker.scale);
  marker.color.b = static_cast<float>(bgr[0]);
  marker.color.g = static_cast<float>(bgr[1]);
  marker.color.r = static_cast<float>(bgr[2]);
  marker.color.a = 0.4f;
  return marker;
}

}  // namespace flight_corridor_ros
