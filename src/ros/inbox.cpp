#include "ros/inbox.hpp"

#include <algorithm>
#include <utility>

namespace flight_corridor_ros {

template <typename MessageConstPtr>
void Inbox::Readings<MessageConstPtr>::put(const MessageConstPtr& reading) {
  const bool time_was_set_back =
      newest_ && reading->header.stamp.toSec() + kLongestDelay_s < newest_->header.stamp.toSec();
  if (time_was_set_back) waiting_.clear();
  if (waiting_.size() == capacity_) waiting_.pop_front();
  waiting_.push_back(reading);
  newest_ = reading;
}

template <typename MessageConstPtr>
std::vector<MessageConstPtr> Inbox::Readings<MessageConstPtr>::take(const ros::Time& until) {
  const auto later = std::stable_partition(
      waiting_.begin(), waiting_.end(), [&](const MessageConstPtr& reading) { return reading->header.stamp <= until; });
  std::vector<MessageConstPtr> taken(waiting_.begin(), later);
  waiting_.erase(waiting_.begin(), later);
  return taken;
}

void Inbox::put(const StereoMessages& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pair_ = pair;
  changed_.notify_one();
}

void Inbox::put(const sensor_msgs::RangeConstPtr& range) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ranges_.put(range);
}

void Inbox::put(const sensor_msgs::ImuConstPtr& imu) {
  const std::lock_guard<std::mutex> lock(mutex_);
  imu_.put(imu);
}

void Inbox::put(Errand errand) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return;
  errands_.push_back(std::move(errand));
  changed_.notify_one();
}

std::optional<StereoMessages> Inbox::take() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return closed_ || pair_ || !errands_.empty(); });
    if (closed_) return std::nullopt;
    if (errands_.empty()) return std::exchange(pair_, std::nullopt);
    Errand errand = std::move(errands_.front());
    errands_.pop_front();
    lock.unlock();
    errand();
    lock.lock();
  }
}

std::vector<sensor_msgs::RangeConstPtr> Inbox::takeRanges(const ros::Time& until) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ranges_.take(until);
}

std::vector<sensor_msgs::ImuConstPtr> Inbox::takeImu(const ros::Time& until) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return imu_.take(until);
}

sensor_msgs::RangeConstPtr Inbox::newestRange() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ranges_.newest();
}

void Inbox::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  errands_.clear();  // whoever waits for one learns that it will not be done
  changed_.notify_one();
}

}  // namespace flight_corridor_ros
