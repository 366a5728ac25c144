#include "flight_corridor/config.hpp"

#include <algorithm>

#include "flight_corridor/stereo/matching_rules.hpp"

namespace flight_corridor {

namespace {

constexpr double kMostCells = 160.0;       // of the map along an axis: twice as many take ten seconds
constexpr double kMostDirections = 400.0;  // limit of a pair's time and memory

Rule frameOrNone(const std::string& name) {
  return Rule().where(name.empty() || name.find_first_not_of('/') != std::string::npos, "a frame's name");
}

// The table: key and field, rule, unit and meaning, tier.
#define FIELD(name) #name, &c.name

ParameterTable tableOf(StereoConfig& c) {
  const bool is_searchable =
      0 < c.num_disparities_px && c.num_disparities_px <= kLargestDisparities && c.num_disparities_px % 32 == 0;
  const bool is_device = c.device == "cpu" || c.device == "gpu" || c.device == "auto";
  return {"stereo",
          "Disparity: semi-global matching",
          {{FIELD(num_disparities_px), Rule().where(is_searchable, "a multiple of 32, up to 256"),
            "[px] search range, a multiple of 32, up to 256, in pixels at ros/scale; nearest depth = focal length * "
            "baseline / this",
            Tier::Tune},
           {FIELD(min_matched_fraction), from(0).upTo(1), "[0..1] fewer matched pixels: UNKNOWN (NO_DISPARITY)"},
           {FIELD(device), Rule().where(is_device, "cpu, gpu or auto"),
            "cpu, gpu (by OpenCL, bit-identical results), or auto: a GPU if there is one", Tier::Configure}}};
}

ParameterTable tableOf(LidarConfig& c) {
  return {"lidar",
          "The one-dimensional LiDAR and its footprint in the left image",
          {{FIELD(min_range_m), from(0), "[m] nearer readings are refused, even if the message allows them",
            Tier::Configure},
           {FIELD(max_range_m), Rule().where(c.max_range_m > c.min_range_m, "above min_range_m"),
            "[m] farther readings mean \"nothing in range\"", Tier::Configure},
           {FIELD(min_beam_width_rad), above(0).below(1),
            "[rad] width of the footprint when the message's field_of_view is smaller"},
           {FIELD(min_valid_fraction), above(0).upTo(1),
            "[0..1] share of the footprint's pixels that must carry disparity"}}};
}

ParameterTable tableOf(FusionConfig& c) {
  return {
      "fusion",
      "Kalman filter of the range on the beam: d_K",
      {{FIELD(acceleration_sigma_mps2), from(0), "[m/s^2 per sqrt(Hz)] process noise; 0 only to reproduce the paper",
        Tier::Tune},
       {FIELD(lidar_variance_m2), above(0), "[m^2] measurement noise of the LiDAR", Tier::Configure},
       {FIELD(stereo_variance_m2), from(0), "[m^2] constant part of the stereo range's measurement noise"},
       {FIELD(disparity_sigma_px),
        from(0).where(c.stereo_variance_m2 + c.disparity_sigma_px > 0.0, "positive if stereo_variance_m2 is 0"),
        "[px] sigma of a match; adds (depth^2 / (focal length * baseline) * this)^2 to stereo_variance_m2", Tier::Tune},
       {FIELD(gate_sigma), above(0), "[sigma] readings farther from the prediction are gated; .inf: no gate"},
       {FIELD(lasting_s), above(0),
        "[s] a sensor that measures another surface for this long is in persistent disagreement"},
       {FIELD(max_gap_s), above(0), "[s] a surface is forgotten after this long without readings of it"},
       {FIELD(buffer_s), above(0), "[s] readings that come up to this late are inserted at their own stamps"}}};
}

ParameterTable tableOf(ScaleConfig& c) {
  return {"scale",
          "Correction of stereo's depth with d_K",
          {{FIELD(enabled), Rule(), "false: depth is f*B/d as calibrated", Tier::Tune},
           {FIELD(max_correction), from(0).below(0.5), "[-] largest relative change of a depth", Tier::Tune},
           {FIELD(prior_sigma), above(0), "[-] expected error of the calibration's scale", Tier::Tune},
           {FIELD(offset_prior_sigma_px), above(0), "[px] expected error of its disparity offset", Tier::Tune},
           {FIELD(disparity_sigma_px), above(0), "[px] sigma of the match in a pair of ranges to learn from"},
           {FIELD(drift_sigma_per_sqrt_s), from(0),
            "[1/sqrt(s)] slow forgetting of the learnt scale; the offset's is in the priors' proportion"},
           {FIELD(gate_sigma), above(0), "[sigma] pairs of ranges farther from the model are not learnt from"}}};
}

ParameterTable tableOf(CloudConfig& c) {
  return {"cloud",
          "The published point cloud",
          {{FIELD(max_range_m), above(0), "[m] farther points are left out", Tier::Tune},
           {FIELD(min_neighbours), from(0).upTo(8),
            "[0..8] neighbouring pixels at the same depth; a point with fewer is noise", Tier::Tune},
           {FIELD(disparity_sigma_px), above(0), "[px] what \"the same depth\" means: within three sigma of this"}}};
}

/// @param box_end_m what the map shall reach, if known.
ParameterTable tableOf(MapConfig& c, double box_end_m = 0.0) {
  return {
      "map",
      "OctoMap",
      {{FIELD(frame_id), frameOrNone(c.frame_id),
        "fixed frame, by tf, in which the map remembers; \"\": the camera's frame, one image, built on demand",
        Tier::Configure},
       {FIELD(resolution_m), from(0.01).upTo(1), "[m] edge of a cell", Tier::Tune},
       {FIELD(max_range_m),
        Rule()
            .where(c.max_range_m > c.resolution_m && c.max_range_m <= 100.0, "above resolution_m, up to 100")
            .where(c.max_range_m <= kMostCells * c.resolution_m, "up to 160 cells of resolution_m")
            .where(c.max_range_m >= box_end_m,
                   "no less than corridor/length_m + corridor/margin_m + corridor/offset_m ahead"),
        "[m] depth up to which evidence is used", Tier::Tune},
       {FIELD(hit_fraction), above(0).upTo(1),
        "[0..1] a cell is hit by at least this share of the points that a full face would show there"},
       {FIELD(min_hit_points), from(1), "a cell is hit by at least this many points"},
       {FIELD(hit_band_px), Rule().where(0.0 <= c.hit_band_px && c.hit_band_px <= c.free_band_px, "0 to free_band_px"),
        "[px] surfaces are moved nearer by this disparity: a match's error"},
       {FIELD(free_band_px), from(0), "[px] space within this disparity before a surface is not cleared"},
       {FIELD(min_ray_fraction), above(0).upTo(1),
        "[0..1] share of a cell's view that must hold depth, all past the cell, to clear it"},
       {FIELD(log_odds_hit),
        above(0).where(c.log_odds_hit + c.log_odds_min >= 0.0,
                       "no less than -log_odds_min, so that one hit makes a free cell occupied"),
        "[-] added for a hit; one hit makes a cell occupied"},
       {FIELD(log_odds_miss), below(0), "[-] added for a miss; two make an occupied cell free"},
       {FIELD(log_odds_min), from(-10).below(0), "[-] clamping limit below"},
       {FIELD(log_odds_max), above(0).upTo(10), "[-] clamping limit above"},
       {FIELD(forget_s), above(0), "[s] in a fixed frame: space without evidence for this long becomes unknown again",
        Tier::Tune}}};
}

ParameterTable tableOf(CorridorConfig& c) {
  return {
      "corridor",
      "The UAV-sized box ahead",
      {{FIELD(frame_id), frameOrNone(c.frame_id),
        "frame, by tf at each stamp, along whose +x the corridor points; \"\": along the left camera's optical axis",
        Tier::Configure},
       {FIELD(level), Rule(),
        "true: level with gravity and along the heading while the UAV rolls and pitches; by tf (ros/gravity_frame), "
        "else by the imu's attitude",
        Tier::Configure},
       {FIELD(width_m), above(0).upTo(20).inFlight(0.1, 5.0),
        "[m] of the UAV and the clearance that it needs beside it", Tier::Configure},
       {FIELD(height_m), above(0).upTo(20).inFlight(0.1, 5.0),
        "[m] of the UAV and the clearance that it needs above and below", Tier::Configure},
       {FIELD(length_m), above(0).upTo(100).inFlight(0.5, 20.0), "[m] D_min: nearer obstacles block", Tier::Configure},
       {FIELD(offset_m), from(-10).upTo(10), "[m] shift of the box's start: forward, left, up", Tier::Configure},
       {FIELD(margin_m), from(0).upTo(5).inFlight(0.0, 2.0), "[m] added on every side and at the end", Tier::Configure},
       {FIELD(blind_m), Rule().where(0.0 <= c.blind_m && c.blind_m < c.length_m, "0 to below length_m"),
        "[m] space nearer to the camera need not have been observed", Tier::Configure},
       {FIELD(max_unknown_fraction), from(0).upTo(1),
        "[0..1] if more of what both cameras see of it is unobserved: UNKNOWN, even without a hole"},
       {FIELD(smallest_obstacle_m), from(0).upTo(1).inFlight(0.0, 0.5),
        "[m] edge of a square: half its area blocks, a hole 1.6 times as wide is UNOBSERVED, a patch that fits in the "
        "box as well as behind it is AMBIGUOUS; smaller patches of matches are dropped as mismatches; 0: nothing is "
        "dropped",
        Tier::Tune},
       {FIELD(hold_s), from(0).upTo(10).inFlight(0.0, 5.0),
        "[s] no FREE for this long where something blocked, unless a large patch is seen to have gone: images miss "
        "thin obstacles now and then",
        Tier::Tune},
       {FIELD(memory_s), from(0).upTo(10),
        "[s] space that two earlier pairs saw clear counts as clear for so long, if the camera's motion is known and "
        "nothing is seen there since; 0: each pair by itself",
        Tier::Tune},
       {FIELD(max_age_s), above(0).inFlight(0.05, 5.0), "[s] older evidence: UNKNOWN", Tier::Tune}}};
}

/// @param box_m length of the box, if known.
ParameterTable tableOf(SpeedConfig& c, double box_m = kInfinity) {
  return {
      "speed",
      "How the UAV brakes: safe_speed",
      {{FIELD(delay_s), from(0).upTo(5),
        "[s] from a verdict until the UAV begins to brake; the verdict's own age is added", Tier::Configure},
       {FIELD(acceleration_mps2), above(0).upTo(100), "[m/s^2] deceleration when it brakes", Tier::Configure},
       {FIELD(jerk_mps3), above(0).upTo(1000), "[m/s^3] jerk with which the deceleration builds up", Tier::Configure},
       {FIELD(margin_m),
        from(0).upTo(5).where(c.margin_m < box_m,
                              "below corridor/length_m + corridor/margin_m, else no speed is ever safe"),
        "[m] distance kept between the stopped UAV and space that is not free", Tier::Configure},
       {FIELD(mover_mps), from(0).upTo(10), "[m/s] speed at which others may move; 0: nothing is taken to move",
        Tier::Configure}}};
}

ParameterTable tableOf(FreeAreasConfig& c) {
  const double directions = (2.0 * c.yaw_rad / c.step_rad + 1.0) * (2.0 * c.pitch_rad / c.step_rad + 1.0);
  return {
      "free_areas",
      "The directions that are judged, a grid about the corridor's axis",
      {{FIELD(yaw_rad), from(0).upTo(1.2), "[rad] largest angle to the left and to the right", Tier::Tune},
       {FIELD(pitch_rad), from(0).upTo(0.8), "[rad] largest angle up and down", Tier::Tune},
       {FIELD(step_rad),
        from(0.02).upTo(1).where(directions <= kMostDirections, "so large that there are no more than 400 directions"),
        "[rad] from one direction to the next", Tier::Tune}}};
}

template <typename SomeConfig>
Violations checked(SomeConfig copy) {
  return brokenRules(parametersOf({tableOf(copy)}));
}

#undef FIELD

}  // namespace

Violations check(const StereoConfig& config) { return checked(config); }
Violations check(const LidarConfig& config) { return checked(config); }
Violations check(const FusionConfig& config) { return checked(config); }
Violations check(const ScaleConfig& config) { return checked(config); }
Violations check(const MapConfig& config) { return checked(config); }
Violations check(const CorridorConfig& config) { return checked(config); }
Violations check(const SpeedConfig& config) { return checked(config); }
Violations check(const FreeAreasConfig& config) { return checked(config); }

std::vector<ParameterTable> tablesOf(Config& c) {
  const double box_m = c.corridor.length_m + c.corridor.margin_m;
  return {tableOf(c.stereo),   tableOf(c.lidar),        tableOf(c.fusion),
          tableOf(c.scale),    tableOf(c.cloud),        tableOf(c.map, std::max(0.0, c.corridor.offset_m.x()) + box_m),
          tableOf(c.corridor), tableOf(c.speed, box_m), tableOf(c.free_areas)};
}

Violations check(const Config& config) {
  Config copy = config;
  return brokenRules(parametersOf(tablesOf(copy)));
}

}  // namespace flight_corridor
