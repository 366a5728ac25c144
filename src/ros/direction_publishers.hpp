#pragma once

#include <ros/node_handle.h>
#include <std_msgs/Header.h>
#include <tf2_ros/transform_broadcaster.h>

#include <atomic>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "flight_corridor/pipeline.hpp"
#include "ros/goal_direction.hpp"

namespace flight_corridor_ros {

/// The node's private topics of directions: ~free_areas with its image and markers, ~scan and ~obstacle_distance.
/// Topics without a subscriber cost no computation.
class DirectionPublishers {
 public:
  /// Turns vectors of a level frame, x along the corridor's heading, into C; nullopt: not known, and the scans are all
  /// NaN.
  using Level = std::function<std::optional<Eigen::Matrix3d>()>;

  DirectionPublishers(const ros::NodeHandle& private_node, const flight_corridor::Config& config, GoalDirection& goal);

  /// From now on this corridor is what unknown scans are of. Any thread.
  void setCorridor(const flight_corridor::CorridorConfig& corridor) { length_m_ = corridor.length_m; }

  /// By the pipeline's last pair.  @param header the left image's.  @param left CV_8UC1.
  void publish(const std_msgs::Header& header, const cv::Mat& left, flight_corridor::Pipeline& pipeline,
               const Level& level);

  /// Publishes that nothing is known: the pair was refused, or none came. Any thread.
  void publishRefusal(const std_msgs::Header& header, std::uint32_t reasons);

 private:
  void publishAreas(const std_msgs::Header& header, const cv::Mat& left, flight_corridor::Pipeline& pipeline);
  void publishScans(const std_msgs::Header& header, const flight_corridor::LevelScan& scan);
  void publishUnknownScans(const std_msgs::Header& header);

  const flight_corridor::FreeAreasConfig config_;
  std::atomic<double> length_m_;  // of the corridor
  GoalDirection& goal_;
  ros::Publisher areas_, image_, markers_, scan_, obstacle_distance_;
  std::optional<tf2_ros::TransformBroadcaster> broadcaster_;  // of the scan's frames, if there is a subscriber
  cv::Mat picture_;
};

}  // namespace flight_corridor_ros
