#include "sim/worlds.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <stdexcept>

#include "sim/scene_parts.hpp"
#include "sim/truth.hpp"
#include "sim/world_builders.hpp"

namespace flight_corridor::sim {
namespace {

constexpr double kSearchCell_m = 0.1;

const std::map<std::string, WorldBuilder>& worldBuilders() {
  static const std::map<std::string, WorldBuilder> kBuilders = [] {
    std::map<std::string, WorldBuilder> by_name;
    for (const auto& kind : {outdoorBuilders(), indoorBuilders()}) by_name.insert(kind.begin(), kind.end());
    return by_name;
  }();
  return kBuilders;
}

/// A grid over the ground that remembers where the search has been.
class Search {
 public:
  Search(const World& world, double width_m, double height_m)
      : world_(world),
        size_m_(width_m, width_m, height_m),
        seen_(static_cast<int>(world.ground_W.sizes().y() / kSearchCell_m) + 1,
              static_cast<int>(world.ground_W.sizes().x() / kSearchCell_m) + 1, uchar{0}) {
    for (const Primitive& primitive : world.scene.world) {
      if (primitive.velocity_W.isZero()) standing_.push_back(primitive);
    }
  }

  bool run() {
    const cv::Point goal = cellOf(world_.goal_W);
    std::deque<cv::Point> open;
    const auto reach = [&](const cv::Point& cell) {
      if (!cv::Rect({}, seen_.size()).contains(cell) || seen_(cell) || !isFree(cell)) return;
      seen_(cell) = 1;
      open.push_back(cell);
    };
    for (reach(cellOf(world_.scene.flight.start_W)); !open.empty(); open.pop_front()) {
      if (open.front() == goal) return true;
      for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        reach(open.front() + step);
      }
    }
    return false;
  }

 private:
  cv::Point cellOf(const Eigen::Vector3d& p_W) const {
    const Eigen::Vector2d cell = (p_W.head<2>() - world_.ground_W.min()) / kSearchCell_m;
    return {static_cast<int>(std::lround(cell.x())), static_cast<int>(std::lround(cell.y()))};
  }

  /// A round body lies within a square, and within the same turned by 45 degrees: what meets it meets both.
  bool isFree(const cv::Point& cell) const {
    const Eigen::Vector2d p_W = world_.ground_W.min() + kSearchCell_m * Eigen::Vector2d(cell.x, cell.y);
    const Eigen::Vector3d middle_W(p_W.x(), p_W.y(), world_.scene.flight.start_W.z());
    const auto meets = [&](double turned_rad, const Primitive& primitive) {
      Eigen::Isometry3d T_W_F(Eigen::Translation3d(middle_W) * Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()));
      return overlaps(T_W_F * Eigen::Translation3d(-size_m_.x() / 2.0, 0.0, 0.0), size_m_, primitive);
    };
    const std::vector<Primitive> near = primitivesNear(standing_, middle_W, size_m_.norm() / 2.0);
    return std::none_of(near.begin(), near.end(), [&](const Primitive& primitive) {
      return meets(0.0, primitive) && meets(M_PI / 4.0, primitive);
    });
  }

  const World& world_;
  Eigen::Vector3d size_m_;
  cv::Mat_<uchar> seen_;
  std::vector<Primitive> standing_;
};

}  // namespace

std::vector<std::string> worldNames() {
  std::vector<std::string> names;
  for (const auto& [name, build] : worldBuilders()) names.push_back(name);
  return names;
}

World makeWorld(const std::string& name, std::uint64_t seed) {
  const auto found = worldBuilders().find(name);
  if (found == worldBuilders().end()) {
    std::string known;
    for (const std::string& world : worldNames()) known += " " + world;
    throw std::invalid_argument("unknown world '" + name + "'; known are:" + known);
  }
  std::uint64_t own = 0;  // of the name: no two worlds of a seed have their trunks at the same places
  for (const char letter : name) own = 31 * own + static_cast<unsigned char>(letter);
  Random random(streamSeed(seed, Stream::Scene, own), Stream::Scene);
  World world;
  Scene& scene = world.scene;
  scene.rig = defaultRig();
  scene.rig.left.gain = random.uniform(210.0, 250.0);
  scene.rig.right.gain = scene.rig.left.gain * random.uniform(0.93, 1.07);
  scene.rig.right.black_level += random.uniform(-2.0, 2.0);
  world.goal_W.y() = random.uniform(-2.0, 2.0);
  found->second(world, random);
  return world;
}

std::vector<Primitive> primitivesNear(const std::vector<Primitive>& primitives, const Eigen::Vector3d& p_W,
                                      double distance_m) {
  std::vector<Primitive> near;
  for (const Primitive& primitive : primitives) {
    const bool is_round = primitive.shape == Shape::Sphere || primitive.shape == Shape::Foliage;
    const double radius_m = is_round ? primitive.half_m.x() : primitive.half_m.norm();
    if ((primitive.T_W_O.translation() - p_W).norm() <= distance_m + radius_m) near.push_back(primitive);
  }
  return near;
}

bool wayExists(const World& world, double width_m, double height_m) { return Search(world, width_m, height_m).run(); }

}  // namespace flight_corridor::sim
