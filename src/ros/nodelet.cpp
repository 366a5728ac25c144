#include <nodelet/nodelet.h>

#include <exception>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "ros/node.hpp"

namespace flight_corridor_ros {

/// The node inside a nodelet manager: images come without copies.
class CorridorNodelet : public nodelet::Nodelet {
 private:
  void onInit() override try {
    node_.emplace(getNodeHandle(), getPrivateNodeHandle());
  } catch (const std::exception& error) {
    NODELET_FATAL("%s", error.what());
    throw;  // the manager refuses the nodelet and lives on
  }

  std::optional<Node> node_;
};

}  // namespace flight_corridor_ros

PLUGINLIB_EXPORT_CLASS(flight_corridor_ros::CorridorNodelet, nodelet::Nodelet)
