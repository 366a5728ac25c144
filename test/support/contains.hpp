#pragma once

#include <string>

namespace flight_corridor::test_support {

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace flight_corridor::test_support
