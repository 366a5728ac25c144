#include "tools/topic_finder.hpp"

#include <rosbag/view.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "tools/bag_file.hpp"

namespace flight_corridor::tools {
namespace {

using Types = std::map<std::string, std::string>;
using Pair = std::pair<std::string, std::string>;

constexpr char kNone[] = "none";
const StereoTopics kUsual;

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// Whether an image is called depth or disparity, or its folder is: above these a word names the rig.
bool isNamedDepth(const std::string& topic) {
  const std::size_t own = topic.rfind('/');
  const std::size_t folder = own == 0 || own == std::string::npos ? own : topic.rfind('/', own - 1);
  std::string name = folder == std::string::npos ? topic : topic.substr(folder);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return contains(name, "depth") || contains(name, "disparity");
}

/// Whether no camera sends such images.
bool holdsDepth(const rosbag::Bag& bag, const std::string& topic) {
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  if (view.size() == 0 || !view.begin()->isType<sensor_msgs::Image>()) return false;
  const std::string encoding = read<sensor_msgs::Image>(bag, *view.begin())->encoding;
  return encoding == sensor_msgs::image_encodings::TYPE_16UC1 || encoding == sensor_msgs::image_encodings::TYPE_32FC1;
}

/// Names of image topics, without that of their compression.
std::set<std::string> imageTopics(const rosbag::Bag& bag, const Types& types) {
  std::set<std::string> images;
  for (const auto& [topic, type] : types) {
    if (type != "sensor_msgs/Image" && type != "sensor_msgs/CompressedImage") continue;
    if (endsWith(topic, "/compressedDepth") || holdsDepth(bag, topic)) continue;
    images.insert(type == "sensor_msgs/CompressedImage" ? withoutCompression(topic) : topic);
  }
  return images;
}

bool isWordAt(const std::string& text, std::size_t at, std::size_t size) {
  const auto parts = [&](std::size_t i) { return i >= text.size() || text[i] == '/' || text[i] == '_'; };
  return (at == 0 || parts(at - 1)) && parts(at + size);
}

/// Names that a right camera's topic may have.
std::vector<std::string> partnersOf(const std::string& left) {
  static const std::array<Pair, 4> sides{{{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"l", "r"}}};
  std::vector<std::string> partners;
  for (const auto& [of_left, of_right] : sides) {
    std::string all = left;
    for (std::size_t at = 0; (at = all.find(of_left, at)) != std::string::npos; at += of_right.size()) {
      const bool is_word = of_left.size() > 1 || isWordAt(all, at, of_left.size());
      if (is_word) all.replace(at, of_left.size(), of_right);  // also where it is written twice
    }
    if (all != left) partners.push_back(all);
  }
  std::string all = left;
  for (std::size_t at = 0; at < left.size(); ++at) {
    if (left[at] < '0' || left[at] > '8') continue;
    std::string partner = left;
    ++partner[at];
    ++all[at];
    partners.push_back(partner);
  }
  if (all != left) partners.push_back(all);  // /cam0/image0
  return partners;
}

constexpr int kWorst = 4;  // of rank()

/// The smaller, the better it serves.
int rank(const Pair& pair) {
  if (isNamedDepth(pair.first)) return kWorst;
  const bool is_rectified = isNamedRectified(pair.first), is_colour = contains(pair.first, "color");
  if (is_rectified) return is_colour ? 1 : 0;
  return contains(pair.first, "raw") && !is_colour ? 2 : 3;
}

/// @param left, right the named topics; empty: any.
std::vector<Pair> findPairs(const std::set<std::string>& images, const std::string& left, const std::string& right) {
  std::set<Pair> pairs;
  int best = kWorst;
  for (const std::string& image : images) {
    for (const std::string& partner : partnersOf(image)) {
      const Pair pair{image, partner};
      if (images.count(partner) == 0 || (!left.empty() && image != left) || (!right.empty() && partner != right))
        continue;
      pairs.insert(pair);
      best = std::min(best, rank(pair));
    }
  }
  std::vector<Pair> served;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(served), [&](const Pair& p) { return rank(p) == best; });
  return served;
}

void findImages(const rosbag::Bag& bag, const Types& types, StereoTopics& topics) {
  if (!topics.left.empty() && !topics.right.empty()) return;
  const std::set<std::string> images = imageTopics(bag, types);
  const bool are_usual =
      topics.left.empty() && topics.right.empty() && images.count(kUsual.left) > 0 && images.count(kUsual.right) > 0;
  if (are_usual) {
    topics.left = kUsual.left;
    topics.right = kUsual.right;
    return;
  }
  const std::vector<Pair> pairs = findPairs(images, topics.left, topics.right);
  if (pairs.size() == 1) {
    std::tie(topics.left, topics.right) = pairs.front();
    return;
  }
  if (pairs.empty()) {
    failMissing(bag,
                "no two image topics whose names differ by left and right, or by a number: name them with --left "
                "TOPIC --right TOPIC");
  }
  std::string found;
  for (const Pair& pair : pairs) found += "\n  --left " + pair.first + " --right " + pair.second;
  throw std::runtime_error(bag.getFileName() + ": holds several stereo pairs: name one of them" + found);
}

/// camera_info in the folder of the image, as ROS's drivers write it.
std::string infoOf(const Types& types, const std::string& image, const std::string& usual) {
  const std::string beside = image.substr(0, image.rfind('/') + 1) + "camera_info";
  return types.count(beside) == 0 && types.count(usual) > 0 ? usual : beside;
}

void requireInfos(const rosbag::Bag& bag, const Types& types, const StereoTopics& topics) {
  for (const std::string& info : {topics.left_info, topics.right_info}) {
    if (types.count(info) > 0) continue;
    failMissing(bag, "no topic " + info +
                         " of type sensor_msgs/CameraInfo: name it with --left-info TOPIC, --right-info "
                         "TOPIC, or give the calibration with --calib FILE");
  }
}

std::vector<std::string> topicsOfType(const Types& types, const std::string& type) {
  std::vector<std::string> found;
  for (const auto& [topic, topic_type] : types) {
    if (topic_type == type) found.push_back(topic);
  }
  return found;
}

/// A topic that may be missing.
/// @return the usual one, or the only one of its type; the usual name if there is none, "" if there are several.
std::string findOne(const Types& types, const std::string& type, const std::string& usual) {
  const std::vector<std::string> found = topicsOfType(types, type);
  if (found.empty() || std::count(found.begin(), found.end(), usual) > 0) return usual;
  return found.size() == 1 ? found.front() : "";
}

}  // namespace

bool isNamedRectified(const std::string& topic) {
  std::size_t begin = 0;
  while (begin < topic.size()) {
    if (topic.compare(begin, 4, "rect") == 0) return true;
    begin = std::min(topic.find_first_of("/_", begin), topic.size()) + 1;
  }
  return false;
}

std::string withoutCompression(const std::string& topic) {
  const std::string end = "/compressed";
  return endsWith(topic, end) ? topic.substr(0, topic.size() - end.size()) : topic;
}

StereoTopics findTopics(const rosbag::Bag& bag, StereoTopics topics, bool needs_info) {
  const Types types = typesByTopic(bag);
  findImages(bag, types, topics);
  if (needs_info && (topics.left_info.empty() || topics.right_info.empty())) {
    if (topics.left_info.empty()) topics.left_info = infoOf(types, topics.left, kUsual.left_info);
    if (topics.right_info.empty()) topics.right_info = infoOf(types, topics.right, kUsual.right_info);
    requireInfos(bag, types, topics);
  }
  if (topics.range.empty()) {
    topics.range = findOne(types, "sensor_msgs/Range", kUsual.range);
    if (topics.range.empty()) {
      std::string found;
      for (const std::string& topic : topicsOfType(types, "sensor_msgs/Range")) found += "\n  --range " + topic;
      throw std::runtime_error(bag.getFileName() + ": holds several range sensors: name the LiDAR, or --range none" +
                               found);
    }
  }
  if (topics.range == kNone) topics.range = "";
  if (topics.imu.empty()) topics.imu = findOne(types, "sensor_msgs/Imu", kUsual.imu);
  if (topics.odom.empty()) topics.odom = findOne(types, "nav_msgs/Odometry", kUsual.odom);
  return topics;
}

std::string listTopics(const rosbag::Bag& bag) {
  std::string list;
  for (const auto& [topic, type] : typesByTopic(bag)) {
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    const double seconds = view.size() > 1 ? (view.getEndTime() - view.getBeginTime()).toSec() : 0.0;
    std::array<char, 64> numbers;
    std::snprintf(numbers.data(), numbers.size(), "%8u  %8.2f Hz  ", view.size(),
                  seconds > 0.0 ? (view.size() - 1) / seconds : 0.0);
    list += numbers.data() + topic + "  " + type + "\n";
  }
  return list;
}

}  // namespace flight_corridor::tools
