#pragma once

#include <sensor_msgs/Range.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "ros/stereo_subscriber.hpp"

namespace flight_corridor_ros {

/// What waits for the worker: the newest stereo pair (an older one gives way) and the LiDAR readings (none gets lost).
/// Any thread may put; one thread takes.
class Inbox {
 public:
  /// @param range_capacity without a taker, the newest readings that are kept.
  explicit Inbox(std::size_t range_capacity) : range_capacity_(range_capacity) {}

  void put(const StereoMessages& pair);
  void put(const sensor_msgs::RangeConstPtr& range);

  /// Waits for a pair.  @return nullopt when closed.
  std::optional<StereoMessages> take();
  /// The readings not after a stamp, in the order of arrival; later ones wait for a later pair.
  std::vector<sensor_msgs::RangeConstPtr> takeRanges(const ros::Time& until);

  /// The reading that came last, taken or not; null when none came.
  sensor_msgs::RangeConstPtr newestRange() const;

  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::optional<StereoMessages> pair_;
  std::deque<sensor_msgs::RangeConstPtr> ranges_;
  sensor_msgs::RangeConstPtr newest_range_;
  std::size_t range_capacity_;
};

}  // namespace flight_corridor_ros
