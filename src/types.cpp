#include "flight_corridor/types.hpp"

#include <stdexcept>

namespace flight_corridor {

void throwIfBroken(const Violations& broken, const std::string& title) {
  if (broken.empty()) return;
  std::string text = title + ":";
  for (const std::string& violation : broken) text += "\n  " + violation;
  throw std::invalid_argument(text);
}

}  // namespace flight_corridor
