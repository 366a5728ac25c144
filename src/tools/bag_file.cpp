#include "tools/bag_file.hpp"

#include <rosbag/view.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "tools/bag_records.hpp"

namespace flight_corridor::tools {
namespace {

void requireMagic(const std::string& path) {
  const std::string magic = "#ROSBAG ";
  std::string begin(magic.size(), ' ');
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin != magic) throw std::runtime_error(path + ": cannot be read: is not a bag");
}

}  // namespace

void openBag(const std::string& path, rosbag::Bag& bag) {
  requireMagic(path);
  try {
    requireSoundRecords(path);
    bag.open(path, rosbag::bagmode::Read);
  } catch (const std::exception& error) {
    failDamaged(path, error.what());
  }
}

std::map<std::string, std::string> typesByTopic(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : view.getConnections())
    types[connection->topic] = connection->datatype;
  return types;
}

void failMissing(const rosbag::Bag& bag, const std::string& what) {
  const std::map<std::string, std::string> types = typesByTopic(bag);
  std::string message = bag.getFileName() + ": " + what + "; it has";
  if (types.empty()) message += " no messages";
  for (const auto& [name, datatype] : types) message += "\n  " + name + " " + datatype;
  throw std::runtime_error(message);
}

void failDamaged(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": cannot be read: " + what + "; if it is damaged or was cut off: rosbag reindex " +
                           path);
}

}  // namespace flight_corridor::tools
