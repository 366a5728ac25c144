#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/corridor/safe_speed.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/motion/camera_motion.hpp"
#include "flight_corridor/motion/earlier_pairs.hpp"

namespace flight_corridor {

/// What moves by itself: patches that stand where rays were clear half a second ago (Dynablox, Schmid et al. 2023), and
/// whose place changes from pair to pair. The UAV must be able to stand before any of them can have come into its way
/// (passive motion safety, Bouraine, Fraichard and Salhi 2012). One object, one thread.
class Movers {
 public:
  explicit Movers(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// A pair, not older than the last.
  /// @param pose of the camera; absent: unknown. Then nothing new is seen to move, and while something did, nothing is
  /// free.
  /// @param depth_m CV_32FC1 of its matches [m], NaN = no match.  @param textured CV_8UC1: where they are no chance.
  /// @param earlier pairs, as seen from now.
  void look(double stamp_s, const std::optional<CameraPose>& pose, const cv::Mat& depth_m, const cv::Mat& textured,
            const EarlierPairs& earlier);

  /// How far a UAV may fly along a box's axis so that it stands before anything that moves can have come there, which
  /// may turn to anywhere at speed.mover_mps [m]; +inf: to the box's end.
  double freeUpTo(const Box& box_C, const SpeedConfig& speed) const;

 private:
  /// Matches side by side that stand where it was clear.
  struct Patch {
    std::vector<Eigen::Vector3d> points_C;
    double shown_m2 = 0.0;
  };
  /// A patch's centre, in the frame of the camera's motion.
  struct Sighting {
    double stamp_s;
    Eigen::Vector3d centre_V;
  };
  struct Track {
    std::deque<Sighting> sightings;         // of the last 0.8 s, the oldest first
    std::vector<Eigen::Vector3d> points_V;  // of the newest
    bool moves = false;                     // was seen to
  };

  void findArrivals(const cv::Mat& depth_m, const cv::Mat& textured, const EarlierPairs& earlier);
  void follow(const Patch& patch, const cv::Mat& depth_m);
  bool moves(const std::deque<Sighting>& sightings, const cv::Mat& depth_m) const;
  bool seesThrough(const Eigen::Vector3d& p_V, const cv::Mat& depth_m) const;
  bool isLost(const Track& track, const cv::Mat& depth_m) const;

  StereoGeometry geometry_;
  double stamp_s_ = kNaN;
  Eigen::Isometry3d T_V_C_ = Eigen::Isometry3d::Identity();
  bool has_pose_ = false;
  int series_ = 0;
  cv::Mat arrived_, labels_;  // of some of the matches
  std::vector<Patch> arrivals_;
  std::vector<Track> tracks_;
};

}  // namespace flight_corridor
