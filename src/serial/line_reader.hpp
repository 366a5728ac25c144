#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace flight_corridor::serial {

/// Cuts a stream of bytes into lines. A line counts only after a newline: a number whose first digits are missing still
/// looks like a number.
class LineReader {
 public:
  static constexpr std::size_t kLongest = 64;  ///< Longest line in characters.

  struct Line {
    std::string text;   ///< Without its end, \n or \r\n.
    std::size_t bytes;  ///< With it.
    double stamp_s;     ///< Time of arrival of its first byte.
  };

  /// @return the line that this byte completes, if any.
  std::optional<Line> add(std::uint8_t byte, double arrival_s);

  /// Bytes that belong to no line: begun before the first newline, or too long.
  std::uint64_t skipped() const { return skipped_; }
  /// Bytes of the incomplete line.
  std::size_t held() const { return text_.size(); }

 private:
  std::string text_;
  double stamp_s_ = 0.0;  // of its first byte
  bool skipping_ = true;  // up to the next newline
  std::uint64_t skipped_ = 0;
};

}  // namespace flight_corridor::serial
