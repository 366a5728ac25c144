#include "ros/publishers.hpp"

#include <nav_msgs/OccupancyGrid.h>
#include <octomap_msgs/Octomap.h>
#include <ros/console.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/Bool.h>
#include <stereo_msgs/DisparityImage.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include "flight_corridor/view/evidence.hpp"
#include "flight_corridor/view/fill.hpp"
#include "flight_corridor/view/overlay.hpp"
#include "ros/clouds.hpp"
#include "ros/conversions.hpp"
#include "ros/map_conversions.hpp"

namespace flight_corridor_ros {

using flight_corridor::Pipeline;
using flight_corridor::Report;

namespace {

Eigen::Vector3d sizeOf(const flight_corridor::CorridorConfig& corridor) {
  return flight_corridor::corridorBox(corridor, Eigen::Isometry3d::Identity()).size_m;
}

}  // namespace

Publishers::Publishers(const ros::NodeHandle& private_node, const flight_corridor::Config& config)
    : map_frame_(config.map.frame_id),
      T_M_G_(map_frame_.empty() ? flight_corridor::opticalFromForward() : Eigen::Isometry3d::Identity()),
      box_size_m_(sizeOf(config.corridor)),
      speed_(config.speed),
      marker_lifetime_s_(config.corridor.max_age_s) {
  ros::NodeHandle node(private_node);
  const auto advertise = [this, &node](const std::string& topic, auto message) {
    publishers_[topic] = node.advertise<decltype(message)>(topic, 1);
  };
  advertise("corridor", flight_corridor::CorridorState());
  advertise("free", std_msgs::Bool());
  advertise("range_fused", sensor_msgs::Range());
  advertise("points", sensor_msgs::PointCloud2());
  advertise("obstacles", sensor_msgs::PointCloud2());
  advertise("clearing", sensor_msgs::PointCloud2());
  advertise("disparity", stereo_msgs::DisparityImage());
  advertise("depth/image_rect", sensor_msgs::Image());
  advertise("depth/camera_info", sensor_msgs::CameraInfo());
  advertise("evidence", sensor_msgs::Image());
  advertise("overlay", sensor_msgs::Image());
  advertise("octomap_binary", octomap_msgs::Octomap());
  advertise("octomap_full", octomap_msgs::Octomap());
  advertise("occupied_cells_vis_array", visualization_msgs::MarkerArray());
  advertise("free_cells_vis_array", visualization_msgs::MarkerArray());
  advertise("octomap_point_cloud_centers", sensor_msgs::PointCloud2());
  advertise("projected_map", nav_msgs::OccupancyGrid());
  advertise("corridor_marker", visualization_msgs::Marker());
}

template <typename Make>
void Publishers::publish(const std::string& topic, Make make) {
  ros::Publisher& publisher = publishers_.at(topic);
  if (publisher.getNumSubscribers() > 0) publisher.publish(make());
}

void Publishers::setCorridor(const flight_corridor::CorridorConfig& corridor) {
  const std::lock_guard<std::mutex> lock(corridor_mutex_);
  box_size_m_ = sizeOf(corridor);
  marker_lifetime_s_ = corridor.max_age_s;
}

void Publishers::publishVerdict(const std_msgs::Header& header, const Report& report) {
  const double latency_s = ros::Time::now().toSec() - header.stamp.toSec();
  publish("corridor", [&] {
    const std::lock_guard<std::mutex> lock(corridor_mutex_);
    return toMessage(header, report, box_size_m_, speed_, latency_s);
  });
  publish("free", [&] {
    std_msgs::Bool free;
    free.data = report.verdict.state == flight_corridor::State::Free;
    return free;
  });
}

void Publishers::publishProducts(const sensor_msgs::CameraInfo& left_info, const std_msgs::Header& header,
                                 const cv::Mat& left, Pipeline& pipeline, const Report& report,
                                 const sensor_msgs::RangeConstPtr& lidar) {
  if (lidar) {
    publish("range_fused", [&] { return toRange(header.stamp, report.range, pipeline.config().lidar, *lidar); });
  }
  publishImages(left_info, header, left, pipeline, report);
  publish("points", [&] { return toPointCloud(header, toCloud(pipeline)); });
  publishMap(header, pipeline, report);
  publishForCostmap(header, pipeline, report);
}

void Publishers::publishForCostmap(const std_msgs::Header& header, const Pipeline& pipeline, const Report& report) {
  const flight_corridor::MapConfig& config = pipeline.config().map;
  publish("obstacles",
          [&] { return toObstacles(header, pipeline.map().tree(), pipeline.T_M_C(), config.max_range_m); });
  publish("clearing", [&] {
    const bool clears = report.clears && pipeline.seesFromBlind();  // a ray clears from the camera on
    return toClearing(header, clears ? pipeline.texturedDepth() : cv::Mat(), pipeline.geometry(), config);
  });
}

void Publishers::publishImages(const sensor_msgs::CameraInfo& left_info, const std_msgs::Header& header,
                               const cv::Mat& left, const Pipeline& pipeline, const Report& report) {
  namespace encodings = sensor_msgs::image_encodings;
  publish("disparity", [&] {
    return toDisparityImage(header, filledDisparity(pipeline), pipeline.geometry(), pipeline.nearestDepth());
  });
  publish("depth/image_rect", [&] { return toImage(header, filledDepth(pipeline), encodings::TYPE_32FC1); });
  publish("depth/camera_info", [&] {
    sensor_msgs::CameraInfo info = left_info;
    info.header = header;
    return info;
  });
  publish("evidence", [&] {
    flight_corridor::drawEvidence(pipeline.left(), flight_corridor::evidenceOf(pipeline), evidence_);
    return toImage(header, evidence_, encodings::BGR8);
  });
  publish("overlay", [&] {
    drawOverlay(left, pipeline.covered(), pipeline.geometry(), pipeline.boxInCamera(), report.verdict, report.range,
                overlay_);
    return toImage(header, overlay_, encodings::BGR8);
  });
}

void Publishers::publishMap(const std_msgs::Header& left_header, const Pipeline& pipeline, const Report& report) {
  std_msgs::Header header = left_header;
  if (!map_frame_.empty()) header.frame_id = map_frame_;
  const auto tree = [&]() -> const octomap::OcTree& { return pipeline.map().tree(); };  // built where somebody listens
  publish("octomap_binary", [&] { return toBinaryOctomap(header, tree()); });
  publish("octomap_full", [&] { return toFullOctomap(header, tree()); });
  publish("occupied_cells_vis_array", [&] { return toMarkers(header, tree(), Cells::Occupied, T_M_G_); });
  publish("free_cells_vis_array", [&] { return toMarkers(header, tree(), Cells::Free, T_M_G_); });
  publish("octomap_point_cloud_centers", [&] { return toCellCentres(header, tree()); });
  publish("corridor_marker",
          [&] { return toMarker(header, pipeline.box(), report.verdict.state, marker_lifetime_s_); });
  if (!map_frame_.empty()) {
    publish("projected_map", [&] { return toProjectedMap(header, tree()); });
  } else if (publishers_.at("projected_map").getNumSubscribers() > 0 && projection_warning_.due()) {
    ROS_WARN(
        "projected_map needs a level frame: set map/frame_id (now \"\") to a fixed one, z up. It is not published");
  }
}

void Publishers::removeBox(const std_msgs::Header& header) {
  publish("corridor_marker", [&] {
    visualization_msgs::Marker marker = toMarker(header, {}, flight_corridor::State::Unknown, marker_lifetime_s_);
    marker.action = visualization_msgs::Marker::DELETE;
    return marker;
  });
}

}  // namespace flight_corridor_ros
