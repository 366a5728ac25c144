#include <ros/ros.h>

#include <exception>

#include "ros/memory.hpp"
#include "ros/node.hpp"

int main(int argc, char** argv) {
  flight_corridor_ros::keepFreedMemory();
  ros::init(argc, argv, "flight_corridor");
  const ros::NodeHandle node;  // outlives the try: without a node nothing is logged
  try {
    const flight_corridor_ros::Node corridor(node, ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
