#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <functional>

#include "ros/inbox.hpp"
#include "ros/params.hpp"

namespace flight_corridor_ros {

/// The rows of the parameters that may change in flight: all are numbers.
flight_corridor::Parameters changeable(NodeConfig& config);

/// A configuration with the values of a request.
/// @throws std::invalid_argument naming every key that may not change in flight, else every broken rule.
NodeConfig changed(const NodeConfig& config, const dynamic_reconfigure::Config& request);

/// dynamic_reconfigure's interface to them: ~set_parameters, ~parameter_descriptions, ~parameter_updates, under the
/// YAML's keys. A request with a broken rule changes nothing and is named in the log. The parameter server holds the
/// effective configuration, at the start and after each change.
class Reconfigure {
 public:
  /// Makes a configuration effective, in the thread of the inbox's taker.
  /// @throws std::invalid_argument if it cannot; then nothing has changed.
  using Apply = std::function<void(const NodeConfig&)>;

  Reconfigure(const ros::NodeHandle& private_node, const NodeConfig& config, Inbox& inbox, Apply apply);

 private:
  bool answer(dynamic_reconfigure::ReconfigureRequest& request, dynamic_reconfigure::ReconfigureResponse& response);
  void announce();

  ros::CallbackQueue questions_;  // a call that waits for a pair must not block the next pair
  ros::NodeHandle node_;
  NodeConfig config_;  // effective; only answer() changes it
  Inbox& inbox_;
  Apply apply_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_{1, &questions_};  // ends before the members that it calls
};

}  // namespace flight_corridor_ros
