#pragma once

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/range/pending_readings.hpp"
#include "ros/stereo_subscriber.hpp"

namespace flight_corridor_ros {

/// What waits for the worker: the newest stereo pair (an older one gives way), the LiDAR's and the imu's readings (none
/// gets lost but those with an impossible stamp, see PendingReadings), and errands. Any thread may put; one thread
/// takes.
class Inbox {
 public:
  using Errand = std::packaged_task<void()>;

  void put(const StereoMessages& pair);
  void put(const sensor_msgs::RangeConstPtr& range);
  void put(const sensor_msgs::ImuConstPtr& imu);
  /// Work that the taker shall do while it takes, before the next pair; destroyed undone when closed.
  void put(Errand errand);

  /// Waits for a pair and does the errands that come meanwhile.  @return nullopt when closed.
  std::optional<StereoMessages> take();
  /// The readings not after a pair, in the order of arrival; later ones wait for a later pair.
  std::vector<sensor_msgs::RangeConstPtr> takeRanges(const ros::Time& pair);
  std::vector<sensor_msgs::ImuConstPtr> takeImu(const ros::Time& pair);

  /// Forgets the readings that wait, their frames, and the time of the pairs.
  void forgetReadings();

  /// Frames of the ranges that came, without a leading slash, the first one first.
  std::vector<std::string> rangeFrames() const;

  /// Readings that were refused for their stamps, and the last one's stamp less its pair's [s]; NaN: it had none.
  struct Refused {
    std::uint64_t count = 0;
    double difference_s = 0.0;
  };
  Refused refusedRanges() const;
  Refused refusedImu() const;

  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::optional<StereoMessages> pair_;
  std::deque<Errand> errands_;
  flight_corridor::PendingReadings<sensor_msgs::RangeConstPtr> ranges_;
  flight_corridor::PendingReadings<sensor_msgs::ImuConstPtr> imu_;
  std::vector<std::string> range_frames_;
};

/// Does work in the thread of the inbox's taker and waits for its result.
/// @throws what the work throws; std::runtime_error when the taker hangs or has ended.
template <typename Work>
auto inTakersThread(Inbox& inbox, Work work) {
  constexpr std::chrono::seconds kPatience(5);  // no pair takes so long: the taker hangs
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  inbox.put(Inbox::Errand(std::move(task)));
  if (result.wait_for(kPatience) != std::future_status::ready) throw std::runtime_error("the node is stuck");
  return result.get();
}

}  // namespace flight_corridor_ros
