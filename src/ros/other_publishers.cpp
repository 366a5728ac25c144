#include "ros/other_publishers.hpp"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcException.h>
#include <xmlrpcpp/XmlRpcValue.h>

namespace flight_corridor_ros {

std::vector<std::string> otherPublishers(const std::string& topic) try {
  XmlRpc::XmlRpcValue caller, response, state;
  caller[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", caller, response, state, false)) return {};
  std::vector<std::string> names;
  XmlRpc::XmlRpcValue& published = state[0];  // [topic, [node, ...]], ...
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) != topic) continue;
    XmlRpc::XmlRpcValue& nodes = published[i][1];
    for (int j = 0; j < nodes.size(); ++j) {
      const std::string name = nodes[j];
      if (name != ros::this_node::getName()) names.push_back(name);
    }
  }
  return names;
} catch (const XmlRpc::XmlRpcException& error) {
  ROS_WARN("the master's answer is not understood (%s): other senders are not looked for", error.getMessage().c_str());
  return {};
}

}  // namespace flight_corridor_ros
