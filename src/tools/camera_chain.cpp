#include "tools/camera_chain.hpp"

#include <algorithm>
#include <stdexcept>

#include "ros/transforms.hpp"
#include "tools/topic_finder.hpp"

namespace flight_corridor::tools {
namespace {

std::string plain(const std::string& topic) { return withoutCompression(flight_corridor_ros::withoutSlash(topic)); }

std::string folderOf(const std::string& topic) {
  const std::string name = plain(topic);
  const std::size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

/// The only camera whose topic has this in common with another; "" if no camera has, or several have.
std::string cameraOf(const std::vector<NamedCamera>& cameras, const std::string& topic) {
  for (const auto part : {plain, folderOf}) {
    const auto is_same = [&](const NamedCamera& camera) {
      return !part(topic).empty() && part(camera.topic) == part(topic);
    };
    const auto found = std::find_if(cameras.begin(), cameras.end(), is_same);
    if (found != cameras.end()) return std::count_if(cameras.begin(), cameras.end(), is_same) == 1 ? found->name : "";
  }
  return "";
}

std::string listed(const std::vector<NamedCamera>& cameras) {
  std::string list;
  for (const NamedCamera& camera : cameras) {
    list += (list.empty() ? "" : ", ") + camera.name + (camera.topic.empty() ? "" : " (" + camera.topic + ")");
  }
  return list.empty() ? "none" : list;
}

void requireName(const std::vector<NamedCamera>& cameras, const std::string& name) {
  const auto is_it = [&](const NamedCamera& camera) { return camera.name == name; };
  if (name.empty() || std::any_of(cameras.begin(), cameras.end(), is_it)) return;
  throw std::runtime_error("holds no camera " + name + "; it has " + listed(cameras));
}

}  // namespace

PairNames choosePair(const std::vector<NamedCamera>& cameras, const PairNames& named, const PairNames& topics) {
  requireName(cameras, named.left);
  requireName(cameras, named.right);
  if (cameras.size() < 2) throw std::runtime_error("holds fewer than two cameras: " + listed(cameras));
  PairNames pair{named.left.empty() ? cameraOf(cameras, topics.left) : named.left,
                 named.right.empty() ? cameraOf(cameras, topics.right) : named.right};
  if (cameras.size() == 2) {
    const auto other = [&](const std::string& name) { return cameras[name == cameras[0].name ? 1 : 0].name; };
    if (pair.left.empty()) pair.left = other(pair.right.empty() ? cameras[1].name : pair.right);
    if (pair.right.empty()) pair.right = other(pair.left);
  }
  if (!pair.left.empty() && !pair.right.empty() && pair.left != pair.right) return pair;
  const bool have_topics = !topics.left.empty() || !topics.right.empty();
  throw std::runtime_error("which of its cameras are left and right" +
                           (have_topics ? " (" + topics.left + ", " + topics.right + ")" : "") +
                           " is not known: " + listed(cameras) + ". Name them: --calib-left NAME --calib-right NAME");
}

}  // namespace flight_corridor::tools
