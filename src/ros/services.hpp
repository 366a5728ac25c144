#pragma once

#include <flight_corridor/QueryCorridor.h>
#include <octomap_msgs/BoundingBoxQuery.h>
#include <octomap_msgs/GetOctomap.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Empty.h>

#include <functional>
#include <string>
#include <vector>

#include "ros/inbox.hpp"
#include "ros/processor.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

/// The node's private services. The inbox's taker answers, between two pairs: a query never meets a half-built map, and
/// waits for one pair at most, even if no pairs come. An exception of an answer is the caller's error message.
class Services {
 public:
  using IsFresh = std::function<bool(const ros::Time& stamp)>;

  /// @param is_fresh whether the evidence of a pair with this stamp is recent enough for FREE; called in the taker's
  /// thread.
  Services(const ros::NodeHandle& private_node, const Transforms& transforms, Inbox& inbox, Processor& processor,
           IsFresh is_fresh);

 private:
  template <typename Service>
  using Answer = typename Service::Response (Services::*)(const typename Service::Request& request);
  template <typename Service>
  void offer(const std::string& name, Answer<Service> answer);

  std_srvs::EmptyResponse reset(const std_srvs::EmptyRequest& request);
  octomap_msgs::BoundingBoxQueryResponse clear(const octomap_msgs::BoundingBoxQueryRequest& request);
  octomap_msgs::GetOctomapResponse binaryOctomap(const octomap_msgs::GetOctomapRequest& request);
  octomap_msgs::GetOctomapResponse fullOctomap(const octomap_msgs::GetOctomapRequest& request);
  flight_corridor::QueryCorridorResponse queryCorridor(const flight_corridor::QueryCorridorRequest& request);
  flight_corridor::Box boxOf(const flight_corridor::QueryCorridorRequest& request,
                             const Eigen::Isometry3d& T_P_F) const;

  ros::CallbackQueue questions_;  // calls that wait for a pair must not block the next pair
  ros::NodeHandle node_;
  const Transforms& transforms_;
  Inbox& inbox_;
  Processor& processor_;
  IsFresh is_fresh_;
  std::vector<ros::ServiceServer> servers_;
  ros::AsyncSpinner spinner_{1, &questions_};  // ends before the members that it calls
};

}  // namespace flight_corridor_ros
