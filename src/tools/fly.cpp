#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <stdexcept>

#include "fly_rules.hpp"
#include "sim/closed_loop.hpp"
#include "sim/corridor_rule.hpp"
#include "sim/worlds.hpp"
#include "tools/command_line.hpp"
#include "tools/fly_pictures.hpp"
#include "tools/replayer.hpp"

namespace flight_corridor::tools {
namespace {

constexpr double kWaySpare_m = 0.3;  // a way exists where the corridor is so much narrower and lower

std::string lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

sim::ClosedLoopOptions loopOptions(const CommandLine& options, const SpeedConfig& speed) {
  sim::ClosedLoopOptions loop;
  loop.rate_hz = options.number("rate", 1.0, 200.0);
  loop.image_scale = options.number("image-scale", 0.1, 4.0);
  loop.baseline_error = options.number("baseline-error", -0.5, 0.5);
  loop.lidar_fault.kind = sim::lidarFaultFromName(options.text("lidar-fault"));
  loop.patience_s = options.number("patience", 1.0);
  loop.speed = speed;
  return loop;
}

/// For images of another size: the same nearest depth, and no obstacle asked for below 3.5 px at the corridor's end.
/// With a map that remembers, whatever the configuration says, or without: what turns on the spot turns away from what
/// it has seen.
Config configFor(const std::string& rule, Config config, const StereoCalibration& rig, double image_scale) {
  constexpr double kSmallest_px = 3.5;
  constexpr int kStep_px = 32;
  config.stereo.num_disparities_px =
      static_cast<int>(std::ceil(config.stereo.num_disparities_px * image_scale / kStep_px)) * kStep_px;
  config.corridor.smallest_obstacle_m =
      std::max(config.corridor.smallest_obstacle_m, kSmallest_px * config.corridor.length_m / rig.fx_px);
  config.map.frame_id = rule == "newest" ? "" : "odom";
  return config;
}

std::string describe(const sim::Primitive& hit) {
  static constexpr const char* kShapes[] = {"box", "cylinder", "sphere", "foliage"};
  const Eigen::Vector3d& at_W = hit.T_W_O.translation();
  return cv::format("%s%s of half %.2f x %.2f x %.2f m at %.2f %.2f %.2f", hit.velocity_W.isZero() ? "" : "moving ",
                    kShapes[static_cast<int>(hit.shape)], hit.half_m.x(), hit.half_m.y(), hit.half_m.z(), at_W.x(),
                    at_W.y(), at_W.z());
}

void writeRow(const CommandLine& options, const sim::Flown& flown, bool way_exists) {
  std::ofstream file(options.text("csv"));
  file << "world,seed,rule,outcome,way_exists,time_s,distance_m,mean_speed_mps,top_speed_mps,waited_s,stops,nearest_m,"
          "hit,stamp,image_scale,lidar_fault,baseline_error,hit_speed_mps,unseen_s\n"
       << options.text("world") << ',' << options.integer("seed", 0) << ',' << options.text("rule") << ','
       << sim::toString(flown.ending) << ',' << way_exists
       << cv::format(",%.2f,%.2f,%.3f,%.3f,%.2f,%d,%.3f,", flown.time_s, flown.distance_m,
                     flown.distance_m / flown.time_s, flown.top_speed_mps, flown.waited_s, flown.stops, flown.nearest_m)
       << (flown.hit ? describe(*flown.hit) : "") << cv::format(",%.2f,", sim::kFirstStamp_s + flown.time_s)
       << options.text("image-scale") << ',' << options.text("lidar-fault") << ',' << options.text("baseline-error")
       << cv::format(",%.2f,%.2f\n", flown.hit_speed_mps, flown.unseen_s);
  if (!file.flush()) throw std::runtime_error(options.text("csv") + ": cannot be written");
}

int fly(const CommandLine& options) {
  cv::setNumThreads(static_cast<int>(options.integer("threads", 1)));
  const auto seed = static_cast<std::uint64_t>(options.integer("seed", 0));
  const sim::World world = sim::makeWorld(options.text("world"), seed);
  const Config given = readConfig(options.text("config"), options.all("set")).core;
  const sim::ClosedLoopOptions loop_options = loopOptions(options, given.speed);
  sim::ClosedLoop loop(world, loop_options, seed);
  const Config config = configFor(options.text("rule"), given, loop.calibration(), loop_options.image_scale);
  const bool way_exists =
      sim::wayExists(world, config.corridor.width_m + kWaySpare_m, config.corridor.height_m + kWaySpare_m);

  sim::CorridorRule corridor(config, loop);
  sim::Rule rule = [&](const sim::Observation& seen) { return corridor.judge(seen); };
  const bool is_ours = options.text("rule") == "corridor" || options.text("rule") == "newest";
  if (!is_ours) rule = bench::yardstick(options.text("rule"), loop, config.stereo.num_disparities_px);
  const std::string name = options.text("world") + "_" + options.text("seed") + "_" + options.text("rule");
  FlyPictures pictures(loop, name, options.text("video"), loop_options.rate_hz);
  const bool draws = options.given("video") || options.given("pictures");
  const sim::Flown flown = loop.fly(rule, [&](const sim::Observation& seen, const sim::Way& way) {
    if (draws) pictures.add(seen, way, is_ours ? &corridor.areas() : nullptr, corridor.T_W_F());
  });
  writeRow(options, flown, way_exists);
  if (options.given("pictures")) {
    std::filesystem::create_directories(options.text("pictures"));
    pictures.write(options.text("pictures") + "/" + name + "_" + sim::toString(flown.ending) + ".png",
                   flown.hit ? "hit: " + describe(*flown.hit) : sim::toString(flown.ending));
  }
  std::printf("%s: %s after %.1f s and %.1f m, %.2f m/s\n", name.c_str(), sim::toString(flown.ending), flown.time_s,
              flown.distance_m, flown.distance_m / flown.time_s);
  return 0;
}

}  // namespace
}  // namespace flight_corridor::tools

int main(int argc, char** argv) {
  using namespace flight_corridor::tools;
  CommandLine options("fly", "Flies a simulated quadrotor through a world, by what its stereo rig and LiDAR see.");
  options.required("world", "NAME", "world to fly through, see --list")
      .required("csv", "F.csv", "table to write: one line, how the flight went")
      .optional("seed", "N", "varies the world and the noise", "0")
      .optional("rule", "NAME", "what decides: corridor (this package), newest (it, without memory), paper or stock",
                "corridor")
      .optional("rate", "HZ", "stereo pairs per second, 1 to 200", "10")
      .optional("image-scale", "S", "1 = 640x480, 0.5 = 320x240; 0.1 to 4", "0.5")
      .optional("baseline-error", "E", "(true - announced) / announced baseline, -0.5 to 0.5", "0")
      .optional("lidar-fault", "NAME", "fault of the LiDAR, as simulate --list-lidar-faults", "none")
      .optional("patience", "S", "a flight is given up after so long", "60")
      .optional("config", "F.yaml",
                "configuration; image size, rule and quadrotor decide on stereo/num_disparities_px, map/frame_id and "
                "speed/delay_s, and on the least corridor/smallest_obstacle_m",
                "")
      .repeatable("set", "key=value", "override one key of it")
      .optional("video", "F.avi", "the flight from the camera and from above")
      .optional("pictures", "DIR", "the last picture of it")
      .optional("threads", "N", "of this program", "1")
      .question("list", "print the names of the worlds", [] { return lines(flight_corridor::sim::worldNames()); })
      .notes("The same options give the same flight.");
  return runTool(options, argc, argv, [&] { return fly(options); });
}
