#include <ros/ros.h>

#include <exception>

#include "ros/guard_node.hpp"
#include "ros/programs.hpp"

int flight_corridor_ros::programs::corridor_guard(int argc, char** argv) {
  ros::init(argc, argv, "corridor_guard");
  const ros::NodeHandle node;  // outlives the try: without a node nothing is logged
  try {
    const GuardNode guard(node, ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
