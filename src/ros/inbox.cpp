#include "ros/inbox.hpp"

#include <utility>

namespace flight_corridor_ros {

namespace {

constexpr double kLongestDelay_s = 1.0;  // a stamp further back than this means that time was set back

bool isBefore(const sensor_msgs::RangeConstPtr& a, const sensor_msgs::RangeConstPtr& b) {
  return a->header.stamp.toSec() + kLongestDelay_s < b->header.stamp.toSec();
}

}  // namespace

void Inbox::put(const StereoMessages& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pair_ = pair;
  changed_.notify_one();
}

void Inbox::put(const sensor_msgs::RangeConstPtr& range) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (newest_range_ && isBefore(range, newest_range_)) ranges_.clear();
  if (ranges_.size() == range_capacity_) ranges_.pop_front();
  ranges_.push_back(range);
  newest_range_ = range;
}

std::optional<StereoMessages> Inbox::take() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || pair_; });
  return closed_ ? std::nullopt : std::exchange(pair_, std::nullopt);
}

std::vector<sensor_msgs::RangeConstPtr> Inbox::takeRanges(const ros::Time& until) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<sensor_msgs::RangeConstPtr> taken;
  while (!ranges_.empty() && ranges_.front()->header.stamp <= until) {
    taken.push_back(ranges_.front());
    ranges_.pop_front();
  }
  return taken;
}

sensor_msgs::RangeConstPtr Inbox::newestRange() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_range_;
}

void Inbox::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  changed_.notify_one();
}

}  // namespace flight_corridor_ros
