#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/motion/pair_ring.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// What earlier pairs saw clear: their clear rays, each with its pose, for places that the newest pair does not show
/// (a history of views instead of a fused map: NanoMap, Florence et al. 2018). A place was clear if the rays of two
/// earlier pairs were, so that one pair's mistake is not remembered. Where a surface that one
/// of them saw is seen no more, something may have come before it: there nothing is remembered. One object, one caller
/// at a time.
class EarlierPairs {
 public:
  explicit EarlierPairs(const StereoGeometry& geometry);

  /// A pair's rays: where they are clear, by disparity, see ClearRays. They are exchanged for buffers of an older pair.
  /// @param depth_m of its matches, CV_32FC1 [m], NaN = no match.  @param textured CV_8UC1: where they are no chance.
  void add(double stamp_s, const CameraPose& pose, const cv::Mat& depth_m, const cv::Mat& textured,
           cv::Mat& met_left_px, cv::Mat& met_right_px);

  /// From now on places are asked about as seen from this pose.
  /// @param memory_s older pairs are forgotten.
  void moveTo(double stamp_s, const std::optional<CameraPose>& pose, double memory_s) {
    pairs_.moveTo(stamp_s, pose, memory_s);
  }

  bool empty() const { return pairs_.views().empty(); }

  void forget() { pairs_.forget(); }

  /// The newest pair's matches, with which the surfaces that the earlier pairs saw are compared; they must stay as they
  /// are as long as hasVanished() is asked.
  /// @param textured CV_8UC1: where they are no chance.
  void look(const DisparityEvidence& matches, const cv::Mat& textured);
  /// Whether a surface that was seen at a pixel of the newest pair is seen no more. The first call compares: not from
  /// two threads.
  bool hasVanished(int u, int v) const {
    if (vanished_.empty()) findVanished();
    return vanished_.at<std::uint8_t>(v / kCell_px, u / kCell_px) != 0;
  }

  /// Whether the place of a point was clear before, by more than both its and the rays' errors, and so was what is
  /// around it: in as many pairs as must agree, none of them older than this.
  /// @param p_C [m].
  bool wasClear(const Eigen::Vector3d& p_C, double oldest_s) const;

  /// A plane of the camera at a depth, as earlier pairs see it.
  class Plane {
   public:
    /// Whether the place of a pixel at the plane's depth was clear.
    bool wasClear(int u, int v) const;

   private:
    friend class EarlierPairs;
    struct View {
      const cv::Mat *left, *right;
      Eigen::Vector3f corner, along_u, along_v;  // homogeneous pixel of (0, 0) there, what a pixel adds; z: depth [m]
      float error_m;                             // one sigma of the place
    };
    std::vector<View> views_;
    float focal_baseline_px_m_ = 0.0f, shift_px_ = 0.0f, focal_px_ = 0.0f;
  };
  Plane plane(double depth_m) const;

 private:
  void findVanished() const;

  struct Kept {  // of a pair
    cv::Mat met_left_px, met_right_px;
    std::vector<Eigen::Vector3f> surface_C;  // some of its matches
  };
  using Ring = PairRing<Kept>;

  static constexpr int kCell_px = 16;  // squares in which a surface is seen, or not

  StereoGeometry geometry_;
  mutable cv::Mat vanished_;                  // a square; empty: not compared yet
  cv::Mat best_px_, repeated_px_, textured_;  // of the newest pair
  Ring pairs_;
};

}  // namespace flight_corridor
