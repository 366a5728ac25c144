#include <ros/ros.h>

#include <exception>

#include "ros/range_serial.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "range_serial");
  const ros::NodeHandle node;  // outlives the try: without a node nothing is logged
  try {
    flight_corridor_ros::RangeSerial range_serial(node, ros::NodeHandle("~"));
    while (ros::ok()) range_serial.step();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
}
