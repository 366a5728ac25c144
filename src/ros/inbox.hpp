#pragma once

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <memory>
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
/// @param patience until the taker must have begun; no pair takes so long. What has begun is waited for.
/// @throws what the work throws; std::runtime_error, and the work is never done, if the taker does not begin in time;
/// std::future_error if it has ended.
template <typename Work>
auto inTakersThread(Inbox& inbox, Work work, std::chrono::milliseconds patience = std::chrono::seconds(5)) {
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  const auto is_settled = std::make_shared<std::atomic<bool>>(false);  // by who is first: the taker, or who gives up
  inbox.put(Inbox::Errand([task = std::move(task), is_settled]() mutable {
    if (!is_settled->exchange(true)) task();
  }));
  const bool is_late = result.wait_for(patience) != std::future_status::ready;
  if (is_late && !is_settled->exchange(true)) throw std::runtime_error("the node is stuck: nothing was done");
  return result.get();
}

}  // namespace flight_corridor_ros
