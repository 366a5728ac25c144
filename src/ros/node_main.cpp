#include <ros/ros.h>

#include <exception>

#include "ros/memory.hpp"
#include "ros/node.hpp"
#include "ros/programs.hpp"

int flight_corridor_ros::programs::corridor_node(int argc, char** argv) {
  keepFreedMemory();
  ros::init(argc, argv, "flight_corridor");
  const ros::NodeHandle node;  // outlives the try: without a node nothing is logged
  try {
    const Node corridor(node, ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
