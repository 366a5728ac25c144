#include "flight_corridor/image_watch.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <string_view>

namespace flight_corridor {

namespace {

std::size_t fingerprint(const cv::Mat& image) {
  std::size_t hash = 0;
  for (int v = 0; v < image.rows; ++v) {
    const std::string_view row(image.ptr<char>(v), static_cast<std::size_t>(image.cols));
    hash = 31 * hash + std::hash<std::string_view>()(row);
  }
  return hash;
}

}  // namespace

std::uint32_t ImageWatch::faults(const StereoFrame& frame) {
  const Seen now{frame.stamp_s, fingerprint(frame.left), fingerprint(frame.right)};
  const bool is_frozen = std::any_of(seen_.begin(), seen_.end(), [&](const Seen& before) {
    const bool is_another = std::isfinite(before.stamp_s) && before.stamp_s != now.stamp_s;
    return is_another && (before.left == now.left || before.right == now.right);
  });
  seen_[oldest_] = now;
  oldest_ = (oldest_ + 1) % seen_.size();
  return (is_frozen ? kFrozenImage : 0u) | (now.left == now.right ? kBadImage : 0u);
}

}  // namespace flight_corridor
