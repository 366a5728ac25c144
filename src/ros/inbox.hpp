#pragma once

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Range.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <vector>

#include "ros/params.hpp"
#include "ros/stereo_subscriber.hpp"

namespace flight_corridor_ros {

constexpr double kLongestDelay_s = 1.0;  ///< A stamp further back than this means that time was set back.

/// What waits for the worker: the newest stereo pair (an older one gives way), the LiDAR's and the imu's readings (none
/// gets lost), and errands. Any thread may put; one thread takes.
class Inbox {
 public:
  using Errand = std::packaged_task<void()>;

  /// @param config range_queue and imu_queue: without a taker, the newest readings that are kept.
  explicit Inbox(const RosConfig& config) : ranges_(config.range_queue), imu_(config.imu_queue) {}

  void put(const StereoMessages& pair);
  void put(const sensor_msgs::RangeConstPtr& range);
  void put(const sensor_msgs::ImuConstPtr& imu);
  /// Work that the taker shall do while it takes, before the next pair; destroyed undone when closed.
  void put(Errand errand);

  /// Waits for a pair and does the errands that come meanwhile.  @return nullopt when closed.
  std::optional<StereoMessages> take();
  /// The readings not after a stamp, in the order of arrival; later ones wait for a later pair.
  std::vector<sensor_msgs::RangeConstPtr> takeRanges(const ros::Time& until);
  std::vector<sensor_msgs::ImuConstPtr> takeImu(const ros::Time& until);

  /// The reading that came last, taken or not; null when none came.
  sensor_msgs::RangeConstPtr newestRange() const;

  void close();

 private:
  /// Readings of one sensor, in the order of arrival.
  template <typename MessageConstPtr>
  class Readings {
   public:
    explicit Readings(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {}
    void put(const MessageConstPtr& reading);
    std::vector<MessageConstPtr> take(const ros::Time& until);
    const MessageConstPtr& newest() const { return newest_; }

   private:
    std::deque<MessageConstPtr> waiting_;
    MessageConstPtr newest_;
    std::size_t capacity_;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::optional<StereoMessages> pair_;
  std::deque<Errand> errands_;
  Readings<sensor_msgs::RangeConstPtr> ranges_;
  Readings<sensor_msgs::ImuConstPtr> imu_;
};

}  // namespace flight_corridor_ros
