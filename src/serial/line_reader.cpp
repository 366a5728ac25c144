#include "serial/line_reader.hpp"

#include <utility>

namespace flight_corridor::serial {

std::optional<LineReader::Line> LineReader::add(std::uint8_t byte, double arrival_s) {
  const bool is_end = byte == '\n';
  if (skipping_) {
    ++skipped_;
    skipping_ = !is_end;
    return std::nullopt;
  }
  if (text_.empty()) stamp_s_ = arrival_s;
  if (is_end) {
    const std::size_t bytes = text_.size() + 1;
    if (!text_.empty() && text_.back() == '\r') text_.pop_back();
    return Line{std::exchange(text_, std::string()), bytes, stamp_s_};
  }
  text_.push_back(static_cast<char>(byte));
  if (text_.size() > kLongest) {
    skipped_ += text_.size();
    text_.clear();
    skipping_ = true;
  }
  return std::nullopt;
}

}  // namespace flight_corridor::serial
