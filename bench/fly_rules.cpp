#include "fly_rules.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "filled_disparity.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "sim/corridor_rule.hpp"
#include "stock_octomap.hpp"

namespace flight_corridor::bench {
namespace {

constexpr double kLength_m = 4.0;        // D_min
constexpr double kKeepsHeading_s = 2.0;  // after it turned on the spot
constexpr double kBend_rad = 0.09;       // from pair to pair, back to the goal

const FusionConfig kPaperFusion = paperFusion();

/// The paper's verdict.
class PaperRule {
 public:
  PaperRule(const StereoGeometry& geometry, int disparities_px) : geometry_(geometry), filled_(disparities_px) {}

  bool isFree(const sim::Observation& seen) {
    for (const RangeReading& lidar : seen.ranges) {
      if (!(lidar.min_range_m <= lidar.range_m && lidar.range_m <= lidar.max_range_m)) continue;
      fusion_.add(Sensor::Lidar, lidar.stamp_s, lidar.range_m, kPaperFusion.lidar_variance_m2);
    }
    filled_.compute(seen.pair.left, seen.pair.right, geometry_, disparity_px_);
    const StereoCalibration& rig = geometry_.calibration();
    const double stereo_m = geometry_.depth(disparity_px_.at<float>(cv::Point(cvRound(rig.cx_px), cvRound(rig.cy_px))));
    if (std::isfinite(stereo_m)) {
      fusion_.add(Sensor::Stereo, seen.pair.stamp_s, stereo_m, kPaperFusion.stereo_variance_m2);
    }
    return fusion_.at(seen.pair.stamp_s).range_m >= kLength_m;
  }

 private:
  StereoGeometry geometry_;
  FilledDisparity filled_;
  RangeFusion fusion_{kPaperFusion};
  cv::Mat disparity_px_;
};

class StockRule {
 public:
  StockRule(const sim::ClosedLoop& loop, int disparities_px)
      : T_B_C_(loop.T_B_C()), octomap_(StereoGeometry(loop.calibration()), disparities_px) {}

  bool isFree(const sim::Observation& seen) {
    octomap_.insert(seen.pair.left, seen.pair.right);
    const Eigen::Isometry3d& T_W_B = seen.own.T_W_B;
    const Eigen::Isometry3d T_C_F = (T_W_B * T_B_C_).inverse() * sim::levelFrame(T_W_B, T_B_C_);
    return !octomap_.empty() && octomap_.clearDistance(corridorBox(CorridorConfig(), T_C_F), 1) >= kLength_m;
  }

 private:
  Eigen::Isometry3d T_B_C_;
  StockOctomap octomap_;
};

/// Makes a way of a verdict.
class StraightAhead {
 public:
  sim::Way operator()(const sim::Observation& seen, bool is_free) {
    sim::Way way;
    if (!is_free) {
      blocked_s_ = seen.pair.stamp_s;
      return way;
    }
    const Eigen::Isometry3d& T_W_B = seen.own.T_W_B;
    double yaw_rad = std::atan2(T_W_B(1, 0), T_W_B(0, 0));
    if (seen.pair.stamp_s - blocked_s_ > kKeepsHeading_s) {
      yaw_rad += std::clamp(sim::yawTo(T_W_B, seen.goal_W - T_W_B.translation()), -kBend_rad, kBend_rad);
    }
    way.direction_W = Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
    way.free_m = way.free_ahead_m = kLength_m;
    return way;
  }

 private:
  double blocked_s_ = -kInfinity;
};

template <class Verdict>
sim::Rule ruleOf(std::shared_ptr<Verdict> verdict) {
  return [verdict, ahead = StraightAhead()](const sim::Observation& seen) mutable {
    return ahead(seen, verdict->isFree(seen));
  };
}

}  // namespace

sim::Rule yardstick(const std::string& name, const sim::ClosedLoop& loop, int disparities_px) {
  if (name == "paper") return ruleOf(std::make_shared<PaperRule>(StereoGeometry(loop.calibration()), disparities_px));
  if (name == "stock") return ruleOf(std::make_shared<StockRule>(loop, disparities_px));
  throw std::invalid_argument("unknown rule '" + name + "'; known are: corridor newest paper stock");
}

}  // namespace flight_corridor::bench
