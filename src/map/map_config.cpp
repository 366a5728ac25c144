#include "flight_corridor/map/map_config.hpp"

#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {

namespace {

constexpr double kMostCells = 160.0;  // along an axis: twice as many take ten seconds

}  // namespace

Violations check(const MapConfig& config) {
  Rules rules("map");
  rules.require(0.01 <= config.resolution_m && config.resolution_m <= 1.0, "resolution_m", "0.01 to 1",
                config.resolution_m);
  rules.require(config.max_range_m > config.resolution_m && config.max_range_m <= 100.0, "max_range_m",
                "above resolution_m, up to 100", config.max_range_m);
  rules.require(config.max_range_m <= kMostCells * config.resolution_m, "max_range_m",
                "up to 160 cells of resolution_m", config.max_range_m);
  rules.require(0.0 < config.hit_fraction && config.hit_fraction <= 1.0, "hit_fraction", "above 0, up to 1",
                config.hit_fraction);
  rules.require(config.min_hit_points >= 1, "min_hit_points", "1 or more", config.min_hit_points);
  rules.require(0.0 <= config.hit_band_px && config.hit_band_px <= config.free_band_px, "hit_band_px",
                "0 to free_band_px", config.hit_band_px);
  rules.require(config.free_band_px >= 0.0, "free_band_px", "not negative", config.free_band_px);
  rules.require(0.0 < config.min_ray_fraction && config.min_ray_fraction <= 1.0, "min_ray_fraction", "above 0, up to 1",
                config.min_ray_fraction);
  rules.require(config.log_odds_hit > 0.0, "log_odds_hit", "positive", config.log_odds_hit);
  rules.require(config.log_odds_miss < 0.0, "log_odds_miss", "negative", config.log_odds_miss);
  rules.require(config.log_odds_min < 0.0 && config.log_odds_min >= -10.0, "log_odds_min", "-10 to below 0",
                config.log_odds_min);
  rules.require(config.log_odds_max > 0.0 && config.log_odds_max <= 10.0, "log_odds_max", "above 0, up to 10",
                config.log_odds_max);
  rules.require(config.log_odds_hit + config.log_odds_min >= 0.0, "log_odds_hit",
                "no less than -log_odds_min, so that one hit makes a free cell occupied", config.log_odds_hit);
  rules.require(config.forget_s > 0.0, "forget_s", "positive", config.forget_s);
  return rules.broken();
}

double mapReach(const MapConfig& config) { return EvidenceTree::kKeyOrigin * config.resolution_m; }

double farthestCamera(const MapConfig& config) { return mapReach(config) - config.max_range_m; }

}  // namespace flight_corridor
