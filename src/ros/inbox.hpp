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

/// Inputs that wait for the worker: the newest stereo pair (it replaces an older one), the LiDAR's and the imu's
/// readings (only those with an impossible stamp are lost, see PendingReadings), and errands. Any thread may put; one
/// thread takes.
class Inbox {
 public:
  using Errand = std::packaged_task<void()>;

  void put(const StereoMessages& pair);
  void put(const sensor_msgs::RangeConstPtr& range);
  void put(const sensor_msgs::ImuConstPtr& imu);
  /// Work for the taker, done before the next pair; destroyed undone when closed.
  void put(Errand errand);

  /// Waits for a pair and does the errands that come in the meantime.  @return nullopt when closed.
  std::optional<StereoMessages> take();
  /// The readings not after a pair, in the order of arrival; later ones wait for a later pair.
  std::vector<sensor_msgs::RangeConstPtr> takeRanges(const ros::Time& pair);
  std::vector<sensor_msgs::ImuConstPtr> takeImu(const ros::Time& pair);

  /// Forgets the waiting readings, their frames, and the time of the pairs.
  void forgetReadings();

  /// Frames of the received ranges, without a leading slash, in order of arrival.
  std::vector<std::string> rangeFrames() const;

  /// Readings that were refused for their stamps, and the last one's stamp less its pair's [s]; NaN: without a stamp.
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
/// @throws what the work throws; std::runtime_error if the taker hangs or has ended.
template <typename Work>
auto inTakersThread(Inbox& inbox, Work work) {
  constexpr std::chrono::seconds kPatience(5);  // no pair takes this long: the taker hangs
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  inbox.put(Inbox::Errand(std::move(task)));
  if (result.wait_for(kPatience) != std::future_status::ready) throw std::runtime_error("the node is stuck");
  return result.get();
}

}  // namespace flight_corridor_ros
