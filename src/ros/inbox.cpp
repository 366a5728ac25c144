#include "ros/inbox.hpp"

#include <algorithm>
#include <utility>

#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::PendingReadings;

constexpr std::size_t kMostFrames = 16;  // of sensors that share a topic; names that never end must not fill the memory

double secondsOf(const ros::Time& stamp) { return stamp.isZero() ? flight_corridor::kNaN : stamp.toSec(); }

template <typename Message>
Inbox::Refused refusedOf(const PendingReadings<Message>& readings) {
  return {readings.refused(), readings.refusedDifference()};
}

}  // namespace

void Inbox::put(const StereoMessages& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pair_ = pair;
  changed_.notify_one();
}

void Inbox::put(const sensor_msgs::RangeConstPtr& range) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string frame = withoutSlash(range->header.frame_id);
  const bool is_new = std::find(range_frames_.begin(), range_frames_.end(), frame) == range_frames_.end();
  if (is_new && range_frames_.size() < kMostFrames) range_frames_.push_back(frame);
  ranges_.put(secondsOf(range->header.stamp), range);
}

void Inbox::put(const sensor_msgs::ImuConstPtr& imu) {
  const std::lock_guard<std::mutex> lock(mutex_);
  imu_.put(secondsOf(imu->header.stamp), imu);
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

std::vector<sensor_msgs::RangeConstPtr> Inbox::takeRanges(const ros::Time& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ranges_.take(pair.toSec());
}

std::vector<sensor_msgs::ImuConstPtr> Inbox::takeImu(const ros::Time& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return imu_.take(pair.toSec());
}

void Inbox::forgetReadings() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ranges_.forget();
  imu_.forget();
  range_frames_.clear();
}

std::vector<std::string> Inbox::rangeFrames() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return range_frames_;
}

Inbox::Refused Inbox::refusedRanges() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return refusedOf(ranges_);
}

Inbox::Refused Inbox::refusedImu() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return refusedOf(imu_);
}

void Inbox::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  errands_.clear();  // whoever waits for one learns that it will not be done
  changed_.notify_one();
}

}  // namespace flight_corridor_ros
