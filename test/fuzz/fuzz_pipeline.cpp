// Whatever the cameras, the LiDAR and the pose source give, one after the other: no crash, and no FREE without
// evidence.

#include <stdexcept>
#include <vector>

#include "bytes.hpp"
#include "flight_corridor/view/cloud.hpp"
#include "flight_corridor/view/fill.hpp"

namespace flight_corridor::fuzz {
namespace {

constexpr int kMostFrames = 6;

/// A frame, and whether it may be FREE.
struct Shown {
  StereoFrame frame;
  bool is_evidence = true;
};

/// An image that no stereo pair can have, by the wrong size, type or nothing at all.
cv::Mat broken(Bytes& bytes, cv::Size size_px) {
  switch (bytes.integer(0, 3)) {
    case 0:
      return {};
    case 1:
      return noise(size_px + cv::Size(bytes.integer(1, 9), 0), 1);
    case 2:
      return cv::Mat(size_px, CV_16UC1, cv::Scalar(77));
    default:
      return cv::Mat(size_px, CV_8UC3, cv::Scalar(1, 2, 3));
  }
}

/// Pixels of the input, repeated where there are not enough.
cv::Mat drawn(Bytes& bytes, cv::Size size_px) {
  cv::Mat image(size_px, CV_8UC1);
  const std::string pixels = bytes.text(255) + '\0';
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(pixels[static_cast<std::size_t>(v * image.cols + u) % pixels.size()]);
    }
  }
  return image;
}

Shown show(Bytes& bytes, const StereoGeometry& geometry, double stamp_s, const std::vector<StereoFrame>& before) {
  const auto seed = static_cast<std::uint64_t>(bytes.raw<std::uint16_t>()) << 8 | before.size();
  Shown shown{wall(geometry, bytes.integer(0, 31), stamp_s, seed)};
  StereoFrame& frame = shown.frame;
  cv::Mat& one = bytes.flag() ? frame.left : frame.right;
  switch (bytes.integer(0, 8)) {
    case 0:  // a wall
      break;
    case 1:  // a wall and plates before it
      for (int plates = bytes.integer(1, 4); plates > 0; --plates) {
        const cv::Rect area(bytes.integer(0, 60), bytes.integer(0, 44), bytes.integer(1, 64), bytes.integer(1, 48));
        draw({area, bytes.integer(0, 31)}, 0, seed + 0x1000000u * static_cast<std::uint64_t>(plates), frame);
      }
      break;
    case 2:
      one = broken(bytes, geometry.size());
      shown.is_evidence = false;
      break;
    case 3:  // a covered lens
      one = cv::Mat(geometry.size(), CV_8UC1, cv::Scalar(bytes.integer(0, 255)));
      shown.is_evidence = false;
      break;
    case 4:  // one camera on both topics
      frame.right = frame.left;
      shown.is_evidence = false;
      break;
    case 5:  // a frozen camera, or both
      if (before.empty() || before.back().stamp_s == stamp_s) break;
      if (bytes.flag()) {
        frame.left = before.back().left;
        frame.right = before.back().right;
      } else {
        one = &one == &frame.left ? before.back().left : before.back().right;
      }
      shown.is_evidence = false;
      break;
    case 6:  // two cameras that look elsewhere
      one = noise(geometry.size(), ~seed);
      shown.is_evidence = false;
      break;
    default:
      frame.left = drawn(bytes, geometry.size());
      frame.right = drawn(bytes, geometry.size());
  }
  return shown;
}

Config anyConfig(Bytes& bytes) {
  Config config = smallConfig();
  if (bytes.flag()) config.map.frame_id = "odom";
  if (bytes.flag()) return config;
  config.corridor.smallest_obstacle_m = bytes.number(0.0, 0.2);
  config.corridor.width_m = bytes.number(0.05, 3.0);
  config.corridor.height_m = bytes.number(0.05, 3.0);
  config.corridor.length_m = bytes.number(0.5, 10.0);
  config.corridor.hold_s = bytes.number(0.0, 1.0);
  config.map.resolution_m = bytes.number(0.05, 0.4);
  config.map.max_range_m = bytes.number(1.0, 20.0);
  return config;
}

/// The clock goes on, mostly.
double tick(Bytes& bytes, double stamp_s) {
  switch (bytes.integer(0, 9)) {
    case 0:
      return bytes.number(0.0, 1e4);
    case 1:
      return stamp_s;
    default:
      return stamp_s + bytes.real(0.001, 0.3);
  }
}

void fly(Bytes& bytes) {
  Rig rig;
  if (bytes.flag()) rig.T_C_L = bytes.flag() ? opticalFromForward() : pose(bytes);
  if (bytes.flag()) rig.T_C_F = pose(bytes);
  const StereoGeometry geometry(anyRig(bytes));
  Pipeline pipeline(anyConfig(bytes), geometry, rig);
  std::vector<StereoFrame> before;
  double stamp_s = 100.0, newest_s = -kInfinity;
  for (int i = 0; i < kMostFrames && !bytes.empty(); ++i) {
    stamp_s = tick(bytes, stamp_s);
    for (int readings = bytes.integer(0, 3); readings > 0; --readings) {
      pipeline.addRange(reading(bytes, bytes.flag() ? stamp_s : tick(bytes, stamp_s)));
      if (bytes.flag()) pipeline.addAcceleration(tick(bytes, stamp_s), pose(bytes).translation());
    }
    const Shown shown = show(bytes, geometry, stamp_s, before);
    std::optional<Eigen::Isometry3d> T_W_C = Eigen::Isometry3d::Identity();
    if (bytes.flag()) T_W_C = bytes.flag() ? pose(bytes) : std::optional<Eigen::Isometry3d>();
    if (bytes.flag()) pipeline.pointAlong(pose(bytes));
    const Verdict verdict = pipeline.process(shown.frame, T_W_C).verdict;
    checkVerdict(verdict);
    require(verdict.state != State::Free || shown.is_evidence, "what shows nothing is not FREE", verdict);
    require(verdict.state != State::Free || stamp_s >= newest_s, "what is old is not FREE", verdict);
    if (!(verdict.reasons & (kNoData | kNoPose | kBadImage))) {
      newest_s = stamp_s;
      before.push_back(shown.frame);
    }
  }
  if (toCloud(pipeline).size() > 0) filledDepth(pipeline);  // of the last frame: a shorter input ends with another
}

}  // namespace
}  // namespace flight_corridor::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flight_corridor::fuzz::Bytes bytes(data, size);
  try {
    flight_corridor::fuzz::fly(bytes);
  } catch (const std::invalid_argument&) {  // of an impossible rig or configuration
  }
  return 0;
}
