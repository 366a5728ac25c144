#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <stdexcept>

#include "fly_rules.hpp"
#include "sim/closed_loop.hpp"
#include "sim/corridor_rule.hpp"
#include "sim/worlds.hpp"
#include "tools/command_line.hpp"
#include "tools/fly_pictures.hpp"
#include "tools/programs.hpp"
#include "tools/replayer.hpp"

namespace flight_corridor::tools {
namespace {

constexpr double kWaySpare_m = 0.3;  // a way exists where the corridor is so much narrower and lower

struct FlyOptions {
  std::string world, table, rule = "corridor", lidar_fault = "none", config, video, pictures;
  std::uint64_t seed = 0;
  sim::ClosedLoopOptions loop;
  std::vector<std::string> overrides;
  int threads = 1;
};

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

void writeRow(const FlyOptions& options, const sim::Flown& flown, bool way_exists) {
  std::ofstream file(options.table);
  file << "world,seed,rule,outcome,way_exists,time_s,distance_m,mean_speed_mps,top_speed_mps,waited_s,stops,nearest_m,"
          "hit,stamp,image_scale,lidar_fault,baseline_error,hit_speed_mps,out_of_view_s,fault\n"
       << options.world << ',' << options.seed << ',' << options.rule << ',' << sim::toString(flown.ending) << ','
       << way_exists
       << cv::format(",%.2f,%.2f,%.3f,%.3f,%.2f,%d,%.3f,", flown.time_s, flown.distance_m,
                     flown.distance_m / flown.time_s, flown.top_speed_mps, flown.waited_s, flown.stops, flown.nearest_m)
       << (flown.hit ? describe(*flown.hit) : "") << cv::format(",%.2f,", sim::kFirstStamp_s + flown.time_s)
       << options.loop.image_scale << ',' << options.lidar_fault << ',' << options.loop.baseline_error
       << cv::format(",%.2f,%.2f,%s\n", flown.hit_speed_mps, flown.out_of_view_s, sim::toString(flown.fault));
  if (!file.flush()) throw std::runtime_error(options.table + ": cannot be written");
}

void fly(FlyOptions options) {
  cv::setNumThreads(options.threads);
  const sim::World world = sim::makeWorld(options.world, options.seed);
  const flight_corridor_ros::NodeConfig node_config = readConfig(options.config, options.overrides);
  if (!node_config.mask.empty()) throw std::invalid_argument("stereo/mask: no part of this quadrotor is in its view");
  const Config& given = node_config.core;
  requireDevice(given.stereo, {});  // the CPU's
  options.loop.lidar_fault.kind = sim::lidarFaultFromName(options.lidar_fault);
  options.loop.speed = given.speed;
  sim::ClosedLoop loop(world, options.loop, options.seed);
  const Config config = configFor(options.rule, given, loop.calibration(), options.loop.image_scale);
  const bool way_exists =
      sim::wayExists(world, config.corridor.width_m + kWaySpare_m, config.corridor.height_m + kWaySpare_m);

  sim::CorridorRule corridor(config, loop);
  sim::Rule rule = [&](const sim::Observation& seen) { return corridor.judge(seen); };
  const bool is_ours = options.rule == "corridor" || options.rule == "newest";
  if (!is_ours) rule = bench::yardstick(options.rule, loop, config.stereo.num_disparities_px);
  const std::string name = options.world + "_" + std::to_string(options.seed) + "_" + options.rule;
  if (!options.pictures.empty()) std::filesystem::create_directories(options.pictures);  // fails before the flight
  FlyPictures pictures(loop, name, options.video, options.loop.rate_hz);
  const bool draws = !options.video.empty() || !options.pictures.empty();
  const sim::Flown flown = loop.fly(rule, [&](const sim::Observation& seen, const sim::Way& way) {
    if (draws) pictures.add(seen, way, is_ours ? &corridor.areas() : nullptr, corridor.T_W_F());
  });
  writeRow(options, flown, way_exists);
  if (!options.pictures.empty()) {
    pictures.write(options.pictures + "/" + name + "_" + sim::toString(flown.ending) + ".png",
                   flown.hit ? "hit: " + describe(*flown.hit) : sim::toString(flown.ending));
  }
  std::printf("%s: %s after %.1f s and %.1f m, %.2f m/s\n", name.c_str(), sim::toString(flown.ending), flown.time_s,
              flown.distance_m, flown.distance_m / flown.time_s);
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::fly(int argc, char** argv) {
  using namespace tools;
  FlyOptions options;
  CLI::App app("Flies a simulated quadrotor through a world, by what its stereo rig and LiDAR see.", "fly");
  app.add_option("--world", options.world, "world to fly through, see --list")->type_name("NAME")->required();
  app.add_option("--csv", options.table, "table to write: one line, how the flight went")
      ->type_name("F.csv")
      ->check(outputFile())
      ->required();
  app.add_option("--seed", options.seed, "varies the world and the noise")
      ->type_name("N")
      ->check(wholeNumber(0, std::numeric_limits<std::uint64_t>::max()));
  app.add_option("--rule", options.rule,
                 "what decides: corridor (this package), newest (it, without memory),\npaper or stock")
      ->type_name("NAME");
  app.add_option("--rate", options.loop.rate_hz, "stereo pairs per second, 1 to 200")
      ->type_name("HZ")
      ->check(number(1.0, 200.0));
  app.add_option("--image-scale", options.loop.image_scale, "1 = 640x480, 0.5 = 320x240; 0.1 to 4")
      ->type_name("S")
      ->check(number(0.1, 4.0));
  app.add_option("--baseline-error", options.loop.baseline_error,
                 "(true - announced) / announced baseline, -0.5 to 0.5")
      ->type_name("E")
      ->check(number(-0.5, 0.5));
  app.add_option("--lidar-fault", options.lidar_fault, "fault of the LiDAR, as simulate --list-lidar-faults")
      ->type_name("NAME");
  app.add_option("--patience", options.loop.patience_s, "a flight is given up after so long")
      ->type_name("S")
      ->check(number(1.0));
  app.add_option("--config", options.config,
                 "configuration; image size, rule and quadrotor decide on\nstereo/num_disparities_px, map/frame_id and "
                 "speed/delay_s, and on the\nleast corridor/smallest_obstacle_m")
      ->type_name("F.yaml");
  app.add_option("--set", options.overrides, "overrides one key of it")
      ->type_name("key=value")
      ->allow_extra_args(false);
  app.add_option("--video", options.video, "the flight from the camera and from above")
      ->type_name("F.avi")
      ->check(outputFile());
  app.add_option("--pictures", options.pictures, "folder for the last picture of it")->type_name("DIR");
  app.add_option("--threads", options.threads, "of this program")
      ->type_name("N")
      ->check(wholeNumber(1, std::numeric_limits<int>::max()));
  app.add_flag_callback(
      "--list", [] { answer(sim::worldNames()); }, "print the names of the worlds");
  app.footer("The same options give the same flight.");
  return runTool(app, argc, argv, [&] { tools::fly(options); });
}
