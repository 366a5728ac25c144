#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "sim/simulation.hpp"

namespace {
std::atomic<long> allocations{0};
}

// In place of glibc's, for operator new and OpenCV's images, too.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  *memory = aligned_alloc(alignment, size);
  return *memory ? 0 : ENOMEM;
}
}

namespace flight_corridor {
namespace {

/// The last seconds of a simulated flight, over and over again.
class Flight {
 public:
  explicit Flight(const std::string& scene) : simulation_(optionsOf(scene)) {
    const std::size_t all = simulation_.frameTimes().size();
    for (std::size_t i = all - kFrames; i < all; ++i) frames_.push_back(simulation_.frame(i));
    begin_s_ = frames_.front().stamp_s - 1.0 / kRate_hz;
    for (const StereoFrame& frame : frames_) T_W_C_.push_back(simulation_.T_W_B(frame.stamp_s) * simulation_.T_B_C());
    for (const RangeReading& reading : simulation_.ranges()) {
      if (isFlown(reading.stamp_s)) ranges_.push_back(reading);
    }
    for (const sim::ImuReading& reading : simulation_.imuReadings()) {
      if (isFlown(reading.stamp_s)) imu_.push_back(reading);
    }
  }

  Rig rig() const {
    Rig rig;
    rig.T_C_L = simulation_.T_B_C().inverse() * simulation_.T_B_L();
    return rig;
  }
  StereoGeometry geometry() const { return StereoGeometry(simulation_.calibration()); }

  /// @return allocations on the way.
  long fly(Pipeline& pipeline) {
    const long before = allocations;
    for (std::size_t i = 0; i < kFrames; ++i) {
      StereoFrame frame = frames_[i];
      for (RangeReading reading : ranges_) {
        if (!isBetween(reading.stamp_s, i)) continue;
        reading.stamp_s += later_s_;
        pipeline.addRange(reading);
      }
      for (const sim::ImuReading& reading : imu_) {
        if (isBetween(reading.stamp_s, i)) {
          pipeline.addAcceleration(reading.stamp_s + later_s_, reading.specific_force_B_mps2);
        }
      }
      frame.stamp_s += later_s_;
      const Verdict& verdict = pipeline.process(frame, T_W_C_[i]).verdict;
      seen_[static_cast<std::size_t>(verdict.state)] = true;
    }
    later_s_ += kFrames / kRate_hz;
    return allocations - before;
  }

  bool sawEveryState() const {
    return std::all_of(seen_.begin(), seen_.end(), [](bool seen) { return seen; });
  }

 private:
  static constexpr double kRate_hz = 5.0;
  static constexpr std::size_t kFrames = 12;  // more than ImageWatch remembers

  static sim::SimulationOptions optionsOf(const std::string& scene) {
    sim::SimulationOptions options;
    options.scene = scene;
    options.seed = 3;
    options.rate_hz = kRate_hz;
    options.image_scale = 0.5;
    return options;
  }

  bool isFlown(double stamp_s) const { return begin_s_ < stamp_s && stamp_s <= frames_.back().stamp_s; }
  bool isBetween(double stamp_s, std::size_t i) const {
    return (i == 0 ? begin_s_ : frames_[i - 1].stamp_s) < stamp_s && stamp_s <= frames_[i].stamp_s;
  }

  sim::Simulation simulation_;
  std::vector<StereoFrame> frames_;
  std::vector<Eigen::Isometry3d> T_W_C_;
  std::vector<RangeReading> ranges_;
  std::vector<sim::ImuReading> imu_;
  double begin_s_ = 0.0, later_s_ = 0.0;
  std::array<bool, 3> seen_{};
};

/// OpenCV works on this thread alone: its others allocate when they come to work for the first time, whenever that is.
class PipelineMemory : public testing::TestWithParam<const char*> {
 protected:
  PipelineMemory() { cv::setNumThreads(1); }
};

TEST_P(PipelineMemory, NothingIsAllocatedForWhatIsNoMoreThanWasSeenBefore) {
  for (const char* scene : {"foliage", "wall"}) {
    Flight flight(scene);
    Config config;
    config.map.frame_id = GetParam();
    Pipeline pipeline(config, flight.geometry(), flight.rig());
    ASSERT_GT(flight.fly(pipeline), 0) << "they are counted";
    for (int round = 0; round < 3; ++round) flight.fly(pipeline);
    EXPECT_EQ(flight.fly(pipeline), 0) << scene;
    EXPECT_EQ(flight.sawEveryState(), std::string(scene) == "foliage");
  }
}

INSTANTIATE_TEST_SUITE_P(MapOfOneImageAndOneThatRemembers, PipelineMemory, testing::Values("", "odom"));

}  // namespace
}  // namespace flight_corridor
