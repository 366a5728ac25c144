#include "ros/direction_publishers.hpp"

#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/image_encodings.h>

#include "flight_corridor/view/free_areas_view.hpp"
#include "ros/conversions.hpp"
#include "ros/free_areas_messages.hpp"
#include "ros/scans.hpp"

namespace flight_corridor_ros {

namespace {

bool isHeard(const ros::Publisher& publisher) { return publisher.getNumSubscribers() > 0; }

}  // namespace

DirectionPublishers::DirectionPublishers(const ros::NodeHandle& private_node, const flight_corridor::Config& config,
                                         GoalDirection& goal)
    : config_(config.free_areas), length_m_(config.corridor.length_m), goal_(goal) {
  ros::NodeHandle node(private_node);
  areas_ = node.advertise<flight_corridor::FreeAreas>("free_areas", 1);
  image_ = node.advertise<sensor_msgs::Image>("free_areas/image", 1);
  markers_ = node.advertise<visualization_msgs::MarkerArray>("free_areas/marker", 1);
  scan_ = node.advertise<sensor_msgs::LaserScan>("scan", 1);
  obstacle_distance_ = node.advertise<sensor_msgs::LaserScan>("obstacle_distance", 1);
}

void DirectionPublishers::publish(const std_msgs::Header& header, const cv::Mat& left,
                                  flight_corridor::Pipeline& pipeline, const Level& level) {
  if (isHeard(areas_) || isHeard(image_) || isHeard(markers_)) publishAreas(header, left, pipeline);
  if (!isHeard(scan_) && !isHeard(obstacle_distance_)) return;
  const auto R_C_H = level();  // warns
  if (!R_C_H) return publishUnknownScans(header);
  if (!broadcaster_) broadcaster_.emplace();
  broadcaster_->sendTransform(scanFrames(header, *R_C_H));
  publishScans(header, pipeline.levelScan(*R_C_H));
}

void DirectionPublishers::publishAreas(const std_msgs::Header& header, const cv::Mat& left,
                                       flight_corridor::Pipeline& pipeline) {
  const auto goal_C = goal_.find(header);
  const flight_corridor::AreaGrid& areas = pipeline.freeAreas(goal_C);
  const flight_corridor::Config& config = pipeline.config();
  const flight_corridor::Box box_C = pipeline.boxInCamera();
  const double step_rad = config.free_areas.step_rad;
  if (isHeard(areas_)) {
    const double latency_s = ros::Time::now().toSec() - header.stamp.toSec();
    areas_.publish(toMessage(header, areas, box_C.T_M_F.linear(), goal_C, config.speed, latency_s));
  }
  if (isHeard(image_)) {
    drawFreeAreas(left, pipeline.geometry(), box_C, areas, step_rad, goal_C, picture_);
    image_.publish(toImage(header, picture_, sensor_msgs::image_encodings::BGR8));
  }
  if (isHeard(markers_)) {
    markers_.publish(toMarkers(header, areas, box_C, step_rad, goal_C, config.corridor.max_age_s));
  }
}

void DirectionPublishers::publishScans(const std_msgs::Header& header, const flight_corridor::LevelScan& scan) {
  if (isHeard(scan_)) scan_.publish(toScan(header, scan));
  if (isHeard(obstacle_distance_)) obstacle_distance_.publish(toObstacleDistance(header, scan));
}

void DirectionPublishers::publishUnknownScans(const std_msgs::Header& header) {
  if (header.frame_id.empty()) return;  // no camera yet, of whose frame its own is named
  publishScans(header, flight_corridor::unknownScan(config_.step_rad, length_m_));
}

void DirectionPublishers::publishRefusal(const std_msgs::Header& header, std::uint32_t reasons) {
  if (isHeard(areas_)) areas_.publish(toRefusal(header, config_, reasons));
  if (isHeard(markers_)) markers_.publish(withoutMarkers(header));
  publishUnknownScans(header);
}

}  // namespace flight_corridor_ros
