// One pair, seen by pipelines that know nothing else: what is put into the corridor takes its FREE away, and so does a
// larger corridor that holds what blocks the smaller one.

#include "bytes.hpp"

namespace flight_corridor::fuzz {
namespace {

// A plate that cannot be missed on so few pixels, by all of its sides; smaller ones are among the README's known
// limits.
constexpr int kLeast_px = 10;
constexpr double kLeast_m = 0.4, kWellInside_m = 0.3;

Verdict see(const Config& config, const StereoGeometry& geometry, const StereoFrame& frame) {
  Pipeline pipeline(config, geometry, Rig());
  const Verdict verdict = pipeline.process(frame).verdict;
  checkVerdict(verdict);
  return verdict;
}

/// Whether enough of what both cameras see of a plate is in the corridor.
bool blocks(const Plate& plate, const CorridorConfig& corridor, const StereoGeometry& geometry) {
  const double depth_m = geometry.depth(plate.disparity_px);
  const auto corner = [&](const cv::Point& pixel) { return geometry.point(pixel.x, pixel.y, depth_m); };
  const cv::Rect image({}, geometry.size());
  const cv::Rect seen = plate.area_px & image & (image + cv::Point(plate.disparity_px, 0));
  if (seen.width < kLeast_px || seen.height < kLeast_px) return false;
  const Eigen::Vector3d low = corner(seen.tl()), high = corner(seen.br());
  const auto common = [](double low_m, double high_m, double side_m) {
    return std::min(high_m, 0.5 * side_m) - std::max(low_m, -0.5 * side_m);
  };
  return depth_m <= corridor.length_m - kWellInside_m &&
         std::min(common(low.x(), high.x(), corridor.width_m), common(low.y(), high.y(), corridor.height_m)) >=
             kLeast_m;
}

void look(Bytes& bytes) {
  const StereoGeometry geometry(smallRig());
  Config config = smallConfig();
  config.corridor.width_m = bytes.real(0.4, 2.0);
  config.corridor.height_m = bytes.real(0.4, 2.0);
  config.corridor.length_m = bytes.real(3.0, 4.5);
  const auto seed = static_cast<std::uint64_t>(bytes.raw<std::uint16_t>()) << 8;
  const auto plate = [&](int nearest_px) {
    return Plate{
        {bytes.integer(-20, 60), bytes.integer(-20, 44), bytes.integer(kLeast_px, 64), bytes.integer(kLeast_px, 48)},
        bytes.integer(0, nearest_px)};
  };
  StereoFrame frame = wall(geometry, bytes.integer(0, 4), 1.0, seed);
  for (int plates = bytes.integer(0, 3); plates > 0; --plates) {
    draw(plate(8), 0, seed + static_cast<std::uint64_t>(plates), frame);
  }
  const Verdict before = see(config, geometry, frame);

  Config larger = config;
  larger.corridor.width_m += bytes.real(0.0, 1.0);
  larger.corridor.height_m += bytes.real(0.0, 1.0);
  larger.corridor.length_m += bytes.real(0.0, 1.5);
  if (before.state == State::Blocked) {
    require(see(larger, geometry, frame).state != State::Free, "what blocks a corridor blocks a larger one", before);
  }

  const Plate obstacle = plate(28);
  if (!blocks(obstacle, config.corridor, geometry)) return;
  draw(obstacle, 0, ~seed, frame);
  const Verdict verdict = see(config, geometry, frame);
  require(verdict.state != State::Free, "an obstacle takes FREE away", verdict);
}

}  // namespace
}  // namespace flight_corridor::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flight_corridor::fuzz::Bytes bytes(data, size);
  flight_corridor::fuzz::look(bytes);
  return 0;
}
