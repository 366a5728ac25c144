#include "tools/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace flight_corridor::tools {

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO)),
      start_(std::chrono::steady_clock::now()) {}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::advance() {
  if (done_ >= total_) return;
  ++done_;
  const int percent = static_cast<int>(100 * done_ / total_);
  const int shown = terminal_ ? percent : percent / 10 * 10;
  if (shown <= shown_percent_ || (!terminal_ && shown == 0)) return;
  shown_percent_ = shown;
  terminal_ ? drawBar() : printLine();
}

void Progress::drawBar() const {
  constexpr int kWidth = 30;
  const int filled = kWidth * shown_percent_ / 100;
  const double left_s = elapsed() * static_cast<double>(total_ - done_) / static_cast<double>(done_);
  std::fprintf(stderr, "\r%s [%s%s] %3d %%  %zu/%zu  %.0f s left ", what_.c_str(), std::string(filled, '#').c_str(),
               std::string(kWidth - filled, '.').c_str(), shown_percent_, done_, total_, left_s);
  if (done_ == total_) std::fprintf(stderr, "\r%s: %zu in %.1f s\033[K\n", what_.c_str(), total_, elapsed());
}

void Progress::printLine() const {
  std::fprintf(stderr, "%s: %3d %%  %zu/%zu  %.1f s\n", what_.c_str(), shown_percent_, done_, total_, elapsed());
}

}  // namespace flight_corridor::tools
