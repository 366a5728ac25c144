#pragma once

namespace flight_corridor_ros::programs {

// The node and the guard, named as the programs, each until ROS shuts down. @return exit code: 1, and a log line, if it
// cannot start.
int corridor_guard(int argc, char** argv);
int corridor_node(int argc, char** argv);

}  // namespace flight_corridor_ros::programs
