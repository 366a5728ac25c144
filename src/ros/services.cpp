#include "ros/services.hpp"

#include <stdexcept>
#include <utility>

#include "ros/conversions.hpp"
#include "ros/map_conversions.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::QueryCorridor;
using flight_corridor::QueryCorridorRequest;
using flight_corridor::QueryCorridorResponse;

Eigen::Vector3d sizeOf(const QueryCorridorRequest& request) { return {request.length, request.width, request.height}; }

}  // namespace

Services::Services(const ros::NodeHandle& private_node, const Transforms& transforms, Inbox& inbox,
                   Processor& processor, IsFresh is_fresh)
    : node_(private_node),
      transforms_(transforms),
      inbox_(inbox),
      processor_(processor),
      is_fresh_(std::move(is_fresh)) {
  node_.setCallbackQueue(&questions_);
  offer<std_srvs::Empty>("reset", &Services::reset);
  offer<octomap_msgs::BoundingBoxQuery>("clear_bbx", &Services::clear);
  offer<octomap_msgs::GetOctomap>("octomap_binary", &Services::binaryOctomap);
  offer<octomap_msgs::GetOctomap>("octomap_full", &Services::fullOctomap);
  offer<QueryCorridor>("query_corridor", &Services::queryCorridor);
  spinner_.start();
}

template <typename Service>
void Services::offer(const std::string& name, Answer<Service> answer) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  servers_.push_back(
      node_.advertiseService<Request, Response>(name, [this, answer](const Request& request, Response& response) {
        response = inTakersThread(inbox_, [this, answer, request] { return (this->*answer)(request); });
        return true;
      }));
}

std_srvs::EmptyResponse Services::reset(const std_srvs::EmptyRequest&) {
  inbox_.forgetReadings();
  processor_.reset();
  return {};
}

octomap_msgs::BoundingBoxQueryResponse Services::clear(const octomap_msgs::BoundingBoxQueryRequest& request) {
  processor_.clear(toBox(request));
  return {};
}

octomap_msgs::GetOctomapResponse Services::binaryOctomap(const octomap_msgs::GetOctomapRequest&) {
  octomap_msgs::GetOctomapResponse response;
  response.map = toBinaryOctomap(processor_.mapHeader(), processor_.map());
  return response;
}

octomap_msgs::GetOctomapResponse Services::fullOctomap(const octomap_msgs::GetOctomapRequest&) {
  octomap_msgs::GetOctomapResponse response;
  response.map = toFullOctomap(processor_.mapHeader(), processor_.map());
  return response;
}

QueryCorridorResponse Services::queryCorridor(const QueryCorridorRequest& request) try {
  const flight_corridor::Box anywhere{Eigen::Isometry3d::Identity(), sizeOf(request)};
  flight_corridor::throwIfBroken(check(anywhere, processor_.cell()),
                                 "impossible box");           // also while there is no map
  const Eigen::Isometry3d T_P_F = toPose(request.pose.pose);  // refuses an invalid pose, also while there is no map
  const ros::Time stamp = processor_.mapHeader().stamp;
  const auto* pipeline = processor_.pipeline();
  if (!pipeline || stamp.isZero())
    return toResponse(stamp, refusal(stamp, processor_.report().verdict.reasons).verdict);
  const flight_corridor::Box box = boxOf(request, T_P_F);
  if (!is_fresh_(stamp)) return toResponse(stamp, refusal(stamp, flight_corridor::kNoData).verdict);
  flight_corridor::Verdict verdict = pipeline->query(box);
  if (!processor_.products()) {  // the newest pair was refused
    verdict.reasons |= processor_.report().verdict.reasons;
    verdict.state = flight_corridor::stateOf(verdict.reasons);
  }
  return toResponse(stamp, verdict);
} catch (const std::invalid_argument& error) {
  QueryCorridorResponse response = toResponse(processor_.mapHeader().stamp, {});
  response.success = false;
  response.message = error.what();
  return response;
}

flight_corridor::Box Services::boxOf(const QueryCorridorRequest& request, const Eigen::Isometry3d& T_P_F) const {
  const std_msgs::Header& map = processor_.mapHeader();
  const std::string& frame = request.pose.header.frame_id;
  const auto T_M_P = transforms_.find(map.frame_id, frame, map.stamp);
  if (!T_M_P) {
    throw std::invalid_argument("tf knows no pose of \"" + frame + "\" in \"" + map.frame_id + "\" at " +
                                std::to_string(map.stamp.toSec()));
  }
  return {*T_M_P * T_P_F, sizeOf(request)};
}

}  // namespace flight_corridor_ros
