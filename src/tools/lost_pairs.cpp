#include "tools/lost_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "flight_corridor/types.hpp"
#include "tools/score.hpp"

namespace flight_corridor::tools {
namespace {

std::string seconds(double value_s) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g s", value_s);
  return text.data();
}

double distance(const ros::Time& a, const ros::Time& b) {
  return 1e-9 * std::abs(static_cast<double>(static_cast<std::int64_t>(a.toNSec() - b.toNSec())));
}

std::vector<ros::Time> sortedStamps(const TopicStamps& heard) {
  std::vector<ros::Time> stamps;
  for (const ros::Time& stamp : heard.stamps) {
    if (!stamp.isZero()) stamps.push_back(stamp);
  }
  std::sort(stamps.begin(), stamps.end());
  return stamps;
}

/// Distance from a stamp to the nearest of others, +inf without any [s].
double nearest(const ros::Time& stamp, const std::vector<ros::Time>& sorted) {
  const auto after = std::lower_bound(sorted.begin(), sorted.end(), stamp);
  double nearest_s = kInfinity;
  if (after != sorted.end()) nearest_s = distance(*after, stamp);
  if (after != sorted.begin()) nearest_s = std::min(nearest_s, distance(*(after - 1), stamp));
  return nearest_s;
}

/// One topic's partners for the left images.
struct Partners {
  std::size_t unstamped = 0;
  std::size_t found = 0;  ///< Left images of whose stamp there is a message.
  double offset_s = 0.0;  ///< Of the other left images to the nearest message, median.
};

/// @param tolerance_s up to which stamps count as one.
Partners partnersOf(const std::vector<ros::Time>& left, const TopicStamps& other, double tolerance_s) {
  const std::vector<ros::Time> stamps = sortedStamps(other);
  Partners partners;
  partners.unstamped = other.stamps.size() - stamps.size();
  std::vector<double> offsets_s;
  for (const ros::Time& stamp : left) {
    const double offset_s = nearest(stamp, stamps);
    offset_s <= tolerance_s ? static_cast<void>(++partners.found) : offsets_s.push_back(offset_s);
  }
  if (!offsets_s.empty()) partners.offset_s = quantile(offsets_s, 0.5);
  return partners;
}

/// @return "" if the topic lacks nothing.
std::string describe(const TopicStamps& heard, const Partners& partners, std::size_t left_images) {
  std::string text = heard.topic + ": " + std::to_string(heard.stamps.size()) + " messages, ";
  if (partners.unstamped > 0) return text + std::to_string(partners.unstamped) + " without a stamp (0)";
  if (partners.found >= left_images) return "";
  text += "with the stamps of " + std::to_string(partners.found) + " left images";
  if (std::isfinite(partners.offset_s)) text += ", off the others by " + seconds(partners.offset_s) + " (median)";
  return text;
}

/// Median time between images, +inf when there are not two [s].
double periodOf(const std::vector<ros::Time>& sorted) {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < sorted.size(); ++i) periods_s.push_back(distance(sorted[i], sorted[i - 1]));
  return periods_s.empty() ? kInfinity : quantile(periods_s, 0.5);
}

/// For stamps that differ. Partners further off than half a period are those of other images: no setting helps.
std::string remedyForOffset(double offset_s, double period_s, const flight_corridor_ros::RosConfig& pairing) {
  const std::string approximate = "--set ros/approximate_sync=true", slop = seconds(pairing.sync_slop_s);
  if (offset_s > period_s / 2) return "No setting pairs them: they were not recorded, or the cameras' clocks differ";
  if (offset_s <= pairing.sync_slop_s) return approximate + " pairs stamps that differ by up to " + slop;
  return (pairing.approximate_sync ? "A" : approximate + " with a") + " ros/sync_slop_s above that (it is " + slop +
         ") pairs them; while the rig moves, their depth is wrong";
}

}  // namespace

std::string describeLostPairs(std::size_t pairs, const PairStamps& heard,
                              const flight_corridor_ros::RosConfig& pairing) {
  const std::size_t left_images = heard.front().stamps.size();
  if (pairs >= left_images) return "";
  const std::vector<ros::Time> left = sortedStamps(heard.front());
  const double tolerance_s = pairing.approximate_sync ? pairing.sync_slop_s : 0.0;
  std::string lacks;
  std::size_t unstamped = 0;
  double offset_s = 0.0;
  for (const TopicStamps& topic : heard) {
    const Partners partners = partnersOf(left, topic, tolerance_s);
    const std::string lack = describe(topic, partners, left.size());
    if (!lack.empty()) lacks += (lacks.empty() ? ": " : "; ") + lack;
    unstamped += partners.unstamped;
    offset_s = std::max(offset_s, partners.offset_s);
  }
  std::string remedy;
  if (unstamped > 0) {
    remedy = "The driver must stamp them";
  } else if (offset_s > 0.0) {
    remedy = remedyForOffset(offset_s, periodOf(left), pairing);
  } else if (pairs == 0) {
    remedy = "Messages with one stamp are farther apart in the bag than ros/sync_queue (" +
             std::to_string(pairing.sync_queue) + ") allows: a larger one pairs them";
  } else if (left_images - pairs > 1) {  // one may wait for its successor when the bag ends
    remedy = "Partners that come after a later pair is complete are too late, for the node as well";
  }
  return std::to_string(pairs) + " of " + std::to_string(left_images) +
         " left images found their right image and both CameraInfos" + lacks + (remedy.empty() ? "" : ". " + remedy);
}

}  // namespace flight_corridor::tools
