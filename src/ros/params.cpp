#include "ros/params.hpp"

#include "ros/fields.hpp"
#include "ros/image_scale.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::Rules;
using flight_corridor::Violations;

// The one place where a key meets its field.

Fields bind(flight_corridor::StereoConfig& c) {
  return {{"num_disparities_px", &c.num_disparities_px},
          {"min_matched_fraction", &c.min_matched_fraction},
          {"device", &c.device}};
}

Fields bind(flight_corridor::LidarConfig& c) {
  return {{"min_range_m", &c.min_range_m},
          {"max_range_m", &c.max_range_m},
          {"min_beam_width_rad", &c.min_beam_width_rad},
          {"min_valid_fraction", &c.min_valid_fraction}};
}

Fields bind(flight_corridor::FusionConfig& c) {
  return {{"acceleration_sigma_mps2", &c.acceleration_sigma_mps2},
          {"lidar_variance_m2", &c.lidar_variance_m2},
          {"stereo_variance_m2", &c.stereo_variance_m2},
          {"disparity_sigma_px", &c.disparity_sigma_px},
          {"gate_sigma", &c.gate_sigma},
          {"lasting_s", &c.lasting_s},
          {"max_gap_s", &c.max_gap_s},
          {"buffer_s", &c.buffer_s}};
}

Fields bind(flight_corridor::ScaleConfig& c) {
  return {{"enabled", &c.enabled},
          {"max_correction", &c.max_correction},
          {"prior_sigma", &c.prior_sigma},
          {"offset_prior_sigma_px", &c.offset_prior_sigma_px},
          {"disparity_sigma_px", &c.disparity_sigma_px},
          {"drift_sigma_per_sqrt_s", &c.drift_sigma_per_sqrt_s},
          {"gate_sigma", &c.gate_sigma}};
}

Fields bind(flight_corridor::CloudConfig& c) {
  return {{"max_range_m", &c.max_range_m},
          {"min_neighbours", &c.min_neighbours},
          {"disparity_sigma_px", &c.disparity_sigma_px}};
}

Fields bind(flight_corridor::MapConfig& c) {
  return {{"frame_id", &c.frame_id},
          {"resolution_m", &c.resolution_m},
          {"max_range_m", &c.max_range_m},
          {"hit_fraction", &c.hit_fraction},
          {"min_hit_points", &c.min_hit_points},
          {"hit_band_px", &c.hit_band_px},
          {"free_band_px", &c.free_band_px},
          {"min_ray_fraction", &c.min_ray_fraction},
          {"log_odds_hit", &c.log_odds_hit},
          {"log_odds_miss", &c.log_odds_miss},
          {"log_odds_min", &c.log_odds_min},
          {"log_odds_max", &c.log_odds_max},
          {"forget_s", &c.forget_s}};
}

Fields bind(flight_corridor::CorridorConfig& c) {
  return {{"frame_id", &c.frame_id},
          {"level", &c.level},
          {"width_m", &c.width_m},
          {"height_m", &c.height_m},
          {"length_m", &c.length_m},
          {"offset_m", &c.offset_m},
          {"margin_m", &c.margin_m},
          {"blind_m", &c.blind_m},
          {"max_unknown_fraction", &c.max_unknown_fraction},
          {"smallest_obstacle_m", &c.smallest_obstacle_m},
          {"hold_s", &c.hold_s},
          {"memory_s", &c.memory_s},
          {"max_age_s", &c.max_age_s}};
}

Fields bind(flight_corridor::SpeedConfig& c) {
  return {{"delay_s", &c.delay_s},
          {"acceleration_mps2", &c.acceleration_mps2},
          {"jerk_mps3", &c.jerk_mps3},
          {"margin_m", &c.margin_m},
          {"mover_mps", &c.mover_mps}};
}

Fields bind(flight_corridor::FreeAreasConfig& c) {
  return {{"yaw_rad", &c.yaw_rad}, {"pitch_rad", &c.pitch_rad}, {"step_rad", &c.step_rad}};
}

Fields bind(RosConfig& c) {
  return {{"approximate_sync", &c.approximate_sync},
          {"sync_slop_s", &c.sync_slop_s},
          {"sync_queue", &c.sync_queue},
          {"gravity_frame", &c.gravity_frame},
          {"watchdog_s", &c.watchdog_s},
          {"tf_timeout_s", &c.tf_timeout_s},
          {"image_transport", &c.image_transport},
          {"scale", &c.scale}};
}

Fields bind(NodeConfig& config) {
  Fields all;
  const auto add = [&all](const std::string& section, const Fields& fields) {
    for (const auto& [name, field] : fields) all.emplace(section + "/" + name, field);
  };
  add("stereo", bind(config.core.stereo));
  add("stereo", {{"mask", &config.mask}});
  add("lidar", bind(config.core.lidar));
  add("fusion", bind(config.core.fusion));
  add("scale", bind(config.core.scale));
  add("cloud", bind(config.core.cloud));
  add("map", bind(config.core.map));
  add("corridor", bind(config.core.corridor));
  add("speed", bind(config.core.speed));
  add("free_areas", bind(config.core.free_areas));
  add("ros", bind(config.ros));
  return all;
}

/// Frames are named as tf2 names them.
void takeFrame(const std::string& key, std::string& frame, Violations& broken) {
  const std::string plain = withoutSlash(frame);
  if (plain.empty() && !frame.empty()) broken.push_back(key + ": a frame's name (\"" + frame + "\")");
  frame = plain;
}

}  // namespace

Violations check(const RosConfig& config) {
  Rules rules("ros");
  rules.require(0.0 <= config.sync_slop_s && config.sync_slop_s <= 10.0, "sync_slop_s", "0 to 10", config.sync_slop_s);
  rules.require(config.sync_queue >= 1, "sync_queue", "1 or more", config.sync_queue);
  rules.require(!config.gravity_frame.empty(), "gravity_frame", "a frame's name", config.gravity_frame);
  rules.require(config.watchdog_s > 0.0, "watchdog_s", "positive", config.watchdog_s);
  rules.require(0.0 <= config.tf_timeout_s && config.tf_timeout_s <= 10.0, "tf_timeout_s", "0 to 10",
                config.tf_timeout_s);
  rules.require(!config.image_transport.empty(), "image_transport", "a transport's name", config.image_transport);
  rules.require(isImageScale(config.scale), "scale", "1, 0.5, 0.25 or 0.125", config.scale);
  return rules.broken();
}

NodeConfig makeConfig(const Values& values) {
  NodeConfig config;
  Violations broken = assign(values, bind(config));
  for (const Violations& section : {flight_corridor::check(config.core), check(config.ros)}) {
    broken.insert(broken.end(), section.begin(), section.end());
  }
  takeFrame("map/frame_id", config.core.map.frame_id, broken);
  takeFrame("corridor/frame_id", config.core.corridor.frame_id, broken);
  takeFrame("ros/gravity_frame", config.ros.gravity_frame, broken);
  flight_corridor::throwIfBroken(broken);
  return config;
}

Values toValues(const NodeConfig& config) {
  NodeConfig copy = config;
  return valuesOf(bind(copy));
}

}  // namespace flight_corridor_ros
