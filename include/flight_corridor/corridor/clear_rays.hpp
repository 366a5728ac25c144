#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/stereo/disparity_evidence.hpp"

namespace flight_corridor {

/// How far the rays of both cameras are clear, by one pair: up to the surface that they meet. A match on texture is
/// that surface for its ray in either camera; of a repeated match it is the nearest candidate. A run of pixels without
/// texture is no nearer than the nearer of its two ends, if these are on texture and the right image shows the run
/// between the same two: an edge that crosses the rows belongs to the nearer of the two surfaces beside it. One object,
/// one caller at a time.
class ClearRays {
 public:
  explicit ClearRays(const StereoGeometry& geometry);

  static constexpr int kParts = 8;  ///< Of the rows, side by side.

  /// Looks at one part of the rows; all have to be looked at, in any order or at once.
  /// @param left, right CV_8UC1, masks of the images' texture, see Texture.
  void look(int part, const DisparityEvidence& evidence, const cv::Mat& left, const cv::Mat& right,
            const ScaleCorrection& correction);

  /// What the LiDAR's beam tells of a surface without texture: the connected textureless region in which it ends is one
  /// surface without a step, which slopes by at most 60 degrees. At an angle a from the beam it is no nearer than
  /// Z / (1 + tan(60 deg) tan(a)). Not where it is matched nearer than that.
  /// @param evidence, textured as of the last look().  @param met_C where the beam ends, in C [m].
  void clearPlainSurface(const DisparityEvidence& evidence, const cv::Mat& textured, const ScaleCorrection& correction,
                         const Eigen::Vector3d& met_C);

  /// Of pixels that show nothing, black or white because they are clipped, no ray is clear.
  /// @param clipped CV_8UC1, see Texture.
  void hide(const cv::Mat& clipped) { met_left_px_.setTo(kInfinity, clipped); }

  /// Leaves what a match or the LiDAR shows: runs that only their ends clear are not clear any more. A thing as plain
  /// as what is behind it has no end, so such a run is no evidence for later.
  void keepSeen();

  /// Up to which disparity each pixel's ray is clear, corrected, with noise, CV_32FC1; +inf: not clear. Whoever keeps
  /// one may put another image of that size in its place before the next look().
  cv::Mat& metLeft() { return met_left_px_; }
  cv::Mat& metRight() { return met_right_px_; }
  const cv::Mat& metLeft() const { return met_left_px_; }
  const cv::Mat& metRight() const { return met_right_px_; }

  /// Whether the ray of a left pixel, or that of the right camera to the same point, is clear there.
  /// @param at_px disparity of the point, corrected.  @param shift_px offset of the right pixel to the left of u.
  bool isClear(int u, int v, float at_px, int shift_px) const {
    return met_left_px_.at<float>(v, u) < at_px ||
           (shift_px <= u && u - shift_px < met_right_px_.cols && met_right_px_.at<float>(v, u - shift_px) < at_px);
  }

 private:
  void lookAlong(int v, const DisparityEvidence& evidence, const std::uint8_t* textured,
                 const ScaleCorrection& correction);
  void clearTexturelessRuns(int v, const DisparityEvidence& evidence, const std::uint8_t* left,
                            const std::uint8_t* right);

  StereoGeometry geometry_;
  double first_px_;          // smallest disparity searched
  cv::Mat closed_, region_;  // of the beam's surface
  cv::Mat kept_px_;  // CV_32FC1: up to which disparity at most a ray is clear for later, where its ends clear it
  cv::Mat met_left_px_,
      met_right_px_;  // up to which disparity a pixel's ray is clear, corrected, with noise; +inf: not clear
};

}  // namespace flight_corridor
