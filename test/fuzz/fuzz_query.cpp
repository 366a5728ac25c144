// Any box at all, asked of a pipeline that has seen something: an answer or std::invalid_argument, and no FREE where a
// part of it is BLOCKED.

#include <optional>
#include <stdexcept>

#include "bytes.hpp"

namespace flight_corridor::fuzz {
namespace {

constexpr int kMostQueries = 8;

std::optional<Verdict> ask(const Pipeline& pipeline, const Box& box) {
  try {
    const Verdict verdict = pipeline.query(box);
    checkVerdict(verdict);
    return verdict;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

Box anyBox(Bytes& bytes) {
  Box box{opticalFromForward(), {bytes.number(0.1, 6.0), bytes.number(0.1, 2.0), bytes.number(0.1, 2.0)}};
  switch (bytes.integer(0, 3)) {
    case 0:
      box.T_M_F = pose(bytes);
      break;
    case 1:  // no pose at all
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 3; ++j) box.T_M_F.matrix()(j, i) = bytes.number(-1.0, 1.0);
      }
      break;
    default:
      box.T_M_F.translation() += Eigen::Vector3d(bytes.real(-1, 1), bytes.real(-1, 1), bytes.real(0, 4));
  }
  return box;
}

/// One that holds the box.
Box around(const Box& box, Bytes& bytes) {
  const auto more = [&] { return bytes.real(0.0, 2.0); };
  const double before_m = more();
  Box larger = box;
  larger.T_M_F.translation() -= before_m * box.T_M_F.linear().col(0);
  larger.size_m += Eigen::Vector3d(before_m + more(), more(), more());
  return larger;
}

void question(Bytes& bytes) {
  const StereoGeometry geometry(smallRig());
  Config config = smallConfig();
  if (bytes.flag()) config.map.frame_id = "odom";
  Pipeline pipeline(config, geometry, Rig());
  for (int frames = bytes.integer(0, 2); frames > 0; --frames) {
    StereoFrame frame = wall(geometry, bytes.integer(0, 31), 10.0 - frames, bytes.raw<std::uint16_t>());
    const cv::Rect area(bytes.integer(0, 60), bytes.integer(0, 44), bytes.integer(1, 64), bytes.integer(1, 48));
    if (bytes.flag()) draw({area, bytes.integer(0, 31)}, 0, bytes.raw<std::uint16_t>(), frame);
    checkVerdict(pipeline.process(frame, bytes.flag() ? pose(bytes) : Eigen::Isometry3d::Identity()).verdict);
    pipeline.clear({Eigen::Vector3d(-1, -1, bytes.number(0.0, 4.0)), Eigen::Vector3d(1, 1, 5)});
  }
  for (int i = 0; i < kMostQueries && !bytes.empty(); ++i) {
    const Box box = anyBox(bytes);
    const auto verdict = ask(pipeline, box), of_larger = ask(pipeline, around(box, bytes));
    const bool is_freed = verdict && of_larger && verdict->state == State::Blocked && of_larger->state == State::Free;
    require(!is_freed, "what blocks a box blocks one that holds it", of_larger.value_or(Verdict()));
  }
}

}  // namespace
}  // namespace flight_corridor::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flight_corridor::fuzz::Bytes bytes(data, size);
  flight_corridor::fuzz::question(bytes);
  return 0;
}
