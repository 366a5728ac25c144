#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Range.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>

#include "flight_corridor/pipeline.hpp"
#include "ros/heartbeat.hpp"

namespace flight_corridor_ros {

/// The node's private topics. Messages are made only for subscribers.
class Publishers {
 public:
  Publishers(const ros::NodeHandle& private_node, const flight_corridor::Config& config);

  /// Sets the published corridor from now on. Any thread.
  void setCorridor(const flight_corridor::CorridorConfig& corridor);

  /// ~corridor and ~free.  @param header the left image's. Any thread.
  void publishVerdict(const std_msgs::Header& header, const flight_corridor::Report& report);

  /// All other topics: the evidence of the verdict.
  /// @param left CV_8UC1.
  /// @param lidar newest message of the LiDAR; null: ~range_fused has no frame.
  void publishProducts(const sensor_msgs::CameraInfo& left_info, const std_msgs::Header& header, const cv::Mat& left,
                       flight_corridor::Pipeline& pipeline, const flight_corridor::Report& report,
                       const sensor_msgs::RangeConstPtr& lidar);

  /// Removes the box from the screen: it is unknown whether it is free.
  void removeBox(const std_msgs::Header& header);

 private:
  /// Publishes make() if the topic has a subscriber.
  template <typename Make>
  void publish(const std::string& topic, Make make);
  void publishImages(const sensor_msgs::CameraInfo& left_info, const std_msgs::Header& header, const cv::Mat& left,
                     const flight_corridor::Pipeline& pipeline, const flight_corridor::Report& report);
  void publishMap(const std_msgs::Header& header, const flight_corridor::Pipeline& pipeline,
                  const flight_corridor::Report& report);

  void publishForCostmap(const std_msgs::Header& header, const flight_corridor::Pipeline& pipeline,
                         const flight_corridor::Report& report);

  std::string map_frame_;
  Eigen::Isometry3d T_M_G_;  // z up in the map's frame
  std::mutex corridor_mutex_;
  Eigen::Vector3d box_size_m_;
  flight_corridor::SpeedConfig speed_;
  std::atomic<double> marker_lifetime_s_;
  Throttle projection_warning_;
  std::map<std::string, ros::Publisher> publishers_;
  cv::Mat overlay_, evidence_;
};

}  // namespace flight_corridor_ros
