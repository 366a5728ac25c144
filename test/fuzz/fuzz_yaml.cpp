// Parameters from a file and from a command line: a configuration, or std::invalid_argument.

#include <fstream>
#include <stdexcept>

#include "ros/params.hpp"
#include "ros/values.hpp"
#include "scratch.hpp"

namespace flight_corridor_ros {
namespace {

void configure(const Values& values) {
  const NodeConfig config = makeConfig(values);
  if (toValues(makeConfig(toValues(config))) != toValues(config)) flight_corridor::fuzz::fail("values are kept");
}

void read(const std::string& text) try {
  configure(readYaml(flight_corridor::fuzz::scratchFile("parameters.yaml", text)));
} catch (const std::invalid_argument&) {
}

void set(const std::string& text) try {
  Values values;
  setParameter(values, text);
  for (const auto& [key, value] : values) describe(value);
  configure(values);
} catch (const std::invalid_argument&) {
}

}  // namespace
}  // namespace flight_corridor_ros

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  flight_corridor_ros::read(text);
  flight_corridor_ros::set(text);
  return 0;
}
