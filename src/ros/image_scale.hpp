#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core/mat.hpp>

namespace flight_corridor_ros {

/// Whether `ros/scale` may have this value: 1, 0.5, 0.25 or 0.125. Whole squares of pixels become one, so that no pixel
/// is shared between two and disparities scale exactly.
bool isImageScale(double scale);

/// The image with each square of 1/scale by 1/scale pixels averaged into one; shared at scale 1. Pixels at the right
/// and lower edge that fill no square are left out.
cv::Mat scaled(const cv::Mat& image, double scale);

/// CameraInfo of the scaled image; shared at scale 1. Model: with pixel centres at whole numbers f' = s f, c' = s (c +
/// 1/2) - 1/2, Tx' = s Tx, so the baseline is kept. Distortion, rotation and binning are kept; the region of interest
/// is scaled.
sensor_msgs::CameraInfoConstPtr scaled(const sensor_msgs::CameraInfoConstPtr& info, double scale);

}  // namespace flight_corridor_ros
