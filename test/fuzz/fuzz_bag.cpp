// A bag, replayed: verdicts, or std::runtime_error. The input is either a bag's file, or says what becomes of each
// message of a small flight: lost, cut off, altered, or recorded at another time.

#include <rosbag/view.h>
#include <topic_tools/shape_shifter.h>

#include <new>
#include <stdexcept>
#include <vector>

#include "bytes.hpp"
#include "scratch.hpp"
#include "silence.hpp"
#include "tools/replayer.hpp"
#include "tools/stereo_bag_writer.hpp"

/// As on a machine with little memory: a damaged message may announce any length.
void* operator new(std::size_t size) {
  constexpr std::size_t kMost = std::size_t{256} << 20;
  void* memory = size <= kMost ? std::malloc(size) : nullptr;
  if (!memory) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
extern "C" const char* __asan_default_options() { return "alloc_dealloc_mismatch=0"; }  // of the other operators new

namespace flight_corridor::tools {
namespace {

constexpr char kMagic[] = "#ROSBAG";
const ros::Time kStart(100, 0);

struct Recorded {
  std::string topic;
  ros::Time time;
  topic_tools::ShapeShifter message;
  std::vector<std::uint8_t> content;
};

/// Two pairs of a wall, with all that may be recorded besides.
std::string writeFlight() {
  const std::string path = fuzz::scratchFolder().path("flight.bag");
  BagRig rig;
  rig.calibration = fuzz::smallRig();
  rig.calibration.size_px = {16, 12};
  rig.calibration.cx_px = rig.calibration.cx_right_px = 7.5;
  rig.calibration.cy_px = 5.5;
  rig.T_B_C = opticalFromForward().inverse();
  StereoBagWriter bag(path, rig, kStart);
  for (int i = 0; i < 2; ++i) {
    const ros::Time stamp = kStart + ros::Duration(0.1 * i);
    const StereoFrame frame = fuzz::wall(StereoGeometry(rig.calibration), 5, 0.0, static_cast<std::uint64_t>(i));
    bag.writePose(stamp, Eigen::Isometry3d::Identity());
    bag.writeImu(stamp, {0.0, 0.0, 9.8});
    bag.writeRange(stamp, {0.0, 7.2, 0.2, 100.0, 0.03});
    bag.writePair(stamp, frame.left, frame.right);
  }
  bag.close();
  return path;
}

std::vector<Recorded> readFlight() {
  const rosbag::Bag bag(writeFlight());
  std::vector<Recorded> flight;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    Recorded recorded{message.getTopic(), message.getTime(), *message.instantiate<topic_tools::ShapeShifter>(), {}};
    recorded.content.resize(recorded.message.size());
    ros::serialization::OStream stream(recorded.content.data(), recorded.message.size());
    recorded.message.write(stream);
    flight.push_back(recorded);
  }
  return flight;
}

void damage(fuzz::Bytes& bytes, std::vector<std::uint8_t>& content) {
  for (int edits = bytes.integer(0, 3); edits > 0; --edits) {
    const auto place = static_cast<std::size_t>(bytes.integer(0, static_cast<int>(content.size()) - 1));
    for (std::size_t i = place; i < content.size() && bytes.flag(); ++i) content[i] = bytes.raw<std::uint8_t>();
  }
  if (bytes.integer(0, 7) == 0) content.resize(static_cast<std::size_t>(bytes.integer(0, 2000)));
}

std::string writeDamaged(fuzz::Bytes& bytes) {
  static const std::vector<Recorded> flight = readFlight();
  const std::string path = fuzz::scratchFolder().path("damaged.bag");
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  for (Recorded recorded : flight) {
    const int fate = bytes.integer(0, 7);
    if (fate == 0) continue;
    if (fate == 1) recorded.time += ros::Duration(bytes.real(-5.0, 5.0));
    if (fate <= 3) damage(bytes, recorded.content);
    ros::serialization::IStream stream(recorded.content.data(), static_cast<std::uint32_t>(recorded.content.size()));
    recorded.message.read(stream);
    bag.write(recorded.topic, recorded.time, recorded.message);
  }
  return path;
}

void replay(const std::string& path) try {
  flight_corridor_ros::NodeConfig config;
  config.core = fuzz::smallConfig();
  const StereoBagReader bag(path, {});
  bag.rate();
  Replayer replayer(bag, config);
  fuzz::silenceRos();
  const PairStamps heard = replayer.run([](const Answer& answer) { fuzz::checkVerdict(answer.report.verdict); });
  describeLostPairs(0, heard, config.ros);
} catch (const std::runtime_error&) {
}

}  // namespace
}  // namespace flight_corridor::tools

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace flight_corridor;
  const std::string file(reinterpret_cast<const char*>(data), size);
  fuzz::Bytes bytes(data, size);
  const bool is_bag = file.rfind(tools::kMagic, 0) == 0;
  tools::replay(is_bag ? fuzz::scratchFile("file.bag", file) : tools::writeDamaged(bytes));
  return 0;
}
