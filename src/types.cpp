#include "flight_corridor/types.hpp"

#include <sstream>
#include <stdexcept>

namespace flight_corridor {

void throwIfBroken(const Violations& broken, const std::string& title) {
  if (broken.empty()) return;
  std::string text = title + ":";
  for (const std::string& violation : broken) text += "\n  " + violation;
  throw std::invalid_argument(text);
}

void Rules::require(bool holds, const std::string& key, const std::string& rule, double value) {
  std::ostringstream text;
  text << value;
  require(holds, key, rule, text.str());
}

void Rules::require(bool holds, const std::string& key, const std::string& rule, const std::string& value) {
  if (!holds) broken_.push_back(section_ + "/" + key + ": " + rule + " (" + value + ")");
}

}  // namespace flight_corridor
