#pragma once

#include <ros/message_traits.h>
#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <exception>
#include <map>
#include <stdexcept>
#include <string>

namespace flight_corridor::tools {

/// Opens a recorded bag.
/// @throws std::runtime_error naming the file when it is missing, something else than a bag, or damaged, with the
/// remedy.
void openBag(const std::string& path, rosbag::Bag& bag);

/// Type of each topic of which the bag holds messages.
std::map<std::string, std::string> typesByTopic(const rosbag::Bag& bag);

/// @throws std::runtime_error naming the bag and the missing topics, with the existing ones.
[[noreturn]] void failMissing(const rosbag::Bag& bag, const std::string& what);

/// @throws std::runtime_error naming the bag and its damage, with the remedy.
[[noreturn]] void failDamaged(const std::string& path, const std::string& what);

/// @throws std::runtime_error naming the bag and the topic when the message is damaged or of another type.
template <typename Message>
boost::shared_ptr<Message> read(const rosbag::Bag& bag, const rosbag::MessageInstance& message) {
  boost::shared_ptr<Message> read;
  if (message.size() == 0) {  // rosbag would read before its buffer
    failDamaged(bag.getFileName(), "topic " + message.getTopic() + ": a message is empty");
  }
  try {
    read = message.instantiate<Message>();
  } catch (const std::exception& error) {
    failDamaged(bag.getFileName(), "topic " + message.getTopic() + ": " + error.what());
  }
  if (!read) {
    throw std::runtime_error(bag.getFileName() + ": topic " + message.getTopic() + " holds " + message.getDataType() +
                             " besides " + ros::message_traits::datatype<Message>());
  }
  return read;
}

}  // namespace flight_corridor::tools
