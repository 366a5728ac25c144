#pragma once

#include <cv_bridge/cv_bridge.h>
#include <flight_corridor/CorridorState.h>
#include <flight_corridor/QueryCorridor.h>
#include <geometry_msgs/Pose.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Range.h>
#include <std_msgs/Header.h>
#include <stereo_msgs/DisparityImage.h>
#include <visualization_msgs/Marker.h>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor_ros {

// Messages in.

/// Numbers of a rectified pair: projection matrices P, baseline = (P_left[3] - P_right[3]) / fx.
/// @throws std::invalid_argument naming every misfit: sizes, fx, fy or cy that differ, other entries of P, binning,
/// region of interest.
/// StereoGeometry refuses impossible numbers.
flight_corridor::StereoCalibration toCalibration(const sensor_msgs::CameraInfo& left,
                                                 const sensor_msgs::CameraInfo& right);

flight_corridor::RangeReading toReading(const sensor_msgs::Range& message);

/// Which of 16 bits are read as 8: (value - least) >> shift.
struct EightOfSixteen {
  int least = 0, shift = 8;
};

/// The upper 8 bits, unless they hold fewer than 16 grey levels of the values that both images use, as of a thermal
/// camera: then those bits in which these values fit, alike for left and right. Depends on these two images alone.
EightOfSixteen bitsOf(const sensor_msgs::Image& left, const sensor_msgs::Image& right);

/// The image as CV_8UC1; shared if it is already grey.
/// @param bits of 16 that are read.
/// @throws std::invalid_argument naming frame and encoding if the encoding is not an image's, the data is too short, or
/// 16 bits hold at most 12.
cv_bridge::CvImageConstPtr toGrey(const sensor_msgs::ImageConstPtr& message, EightOfSixteen bits);

/// An image alone.
inline cv_bridge::CvImageConstPtr toGrey(const sensor_msgs::ImageConstPtr& message) {
  return toGrey(message, bitsOf(*message, *message));
}

/// @throws std::invalid_argument unless the position is finite and the orientation a unit quaternion (to 1 %).
Eigen::Isometry3d toPose(const geometry_msgs::Pose& message);

// Messages out: each gets the header of its data.

/// @param latency_s from the left image's stamp to now.
flight_corridor::CorridorState toMessage(const std_msgs::Header& header, const flight_corridor::Report& report,
                                         const Eigen::Vector3d& box_size_m, const flight_corridor::SpeedConfig& speed,
                                         double latency_s);

/// The answer to a query of a box.  @param stamp of the pair that was judged.
flight_corridor::QueryCorridorResponse toResponse(const ros::Time& stamp, const flight_corridor::Verdict& verdict);

/// d_K as a reading of the LiDAR.
/// @param lidar a message of the LiDAR: its frame and beam are also the fused range's.
sensor_msgs::Range toRange(const ros::Time& stamp, const flight_corridor::RangeEstimate& estimate,
                           const flight_corridor::LidarConfig& config, const sensor_msgs::Range& lidar);

/// @param image CV_8UC1, CV_8UC3 or CV_32FC1, according to the encoding.
sensor_msgs::ImagePtr toImage(const std_msgs::Header& header, const cv::Mat& image, const std::string& encoding);

/// Disparity with Z = f*T/d; no match: below min_disparity, as the message defines.
/// @param disparity_px CV_32FC1, NaN = no match.
/// @param nearest_m depth of the largest disparity that is searched.
stereo_msgs::DisparityImage toDisparityImage(const std_msgs::Header& header, const cv::Mat& disparity_px,
                                             const flight_corridor::StereoGeometry& geometry, double nearest_m);

/// The corridor's box, coloured by state.
/// @param lifetime_s after which it vanishes from the screen.
visualization_msgs::Marker toMarker(const std_msgs::Header& header, const flight_corridor::Box& box,
                                    flight_corridor::State state, double lifetime_s);

}  // namespace flight_corridor_ros
