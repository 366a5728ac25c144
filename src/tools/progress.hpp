#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace flight_corridor::tools {

/// Progress of long work on stderr: a bar on a terminal, a line for every 10 % elsewhere.
class Progress {
 public:
  Progress(std::string what, std::size_t total);
  /// One more of the total is done.
  void advance();

 private:
  double elapsed() const;
  void drawBar() const;
  void printLine() const;

  std::string what_;
  std::size_t total_, done_ = 0;
  int shown_percent_ = -1;
  bool terminal_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace flight_corridor::tools
