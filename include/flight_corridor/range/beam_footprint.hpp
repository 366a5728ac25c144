#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// Section `lidar/` of doc/parameters.md: the one-dimensional LiDAR and its footprint in the left image.
struct LidarConfig {
  double min_range_m = 0.2;
  double max_range_m = 100.0;
  double min_beam_width_rad = 0.02;
  double min_valid_fraction = 0.3;
};
Violations check(const LidarConfig& config);

/// A patch of the left image that the beam covers at one range.
struct Footprint {
  Eigen::Vector2d centre_px;
  double radius_px;
};

/// Stereo's view of the surface that the beam meets.
struct FootprintReading {
  double disparity_px = kNaN;        ///< Median over the footprint.
  double disparity_sigma_px = kNaN;  ///< Robust spread (1.4826 * median absolute deviation) over the footprint.
  double range_m = kNaN;             ///< Of that disparity, uncorrected, along the beam from the LiDAR's origin.
  double unity = 0.0;                ///< Share of the matches within six radii on the same surface [0..1].
  Footprint footprint{};
};

/// The LiDAR's beam in the left image. LiDAR and camera are not at the same place, so the pixel moves with range.
class BeamFootprint {
 public:
  /// @param T_C_L LiDAR (beam along +x) to left optical frame.
  /// @param disparity_sigma_px of a match.
  /// @throws std::invalid_argument with every broken rule, or if the beam does not point ahead.
  BeamFootprint(const LidarConfig& config, const StereoGeometry& geometry, const Eigen::Isometry3d& T_C_L,
                double disparity_sigma_px);

  /// Whether a beam (along +x of L) points no more than 60 degrees off the optical axis: it can meet surfaces ahead.
  static bool looksAhead(const Eigen::Isometry3d& T_C_L);
  /// Whether the far end of a beam is on the left image, so that stereo sees the surface that it meets.
  static bool endsInView(const LidarConfig& config, const StereoGeometry& geometry, const Eigen::Isometry3d& T_C_L);

  /// Footprint at a range along the beam; nullopt if it lies outside the image or behind the camera.
  std::optional<Footprint> at(double range_m, double beam_width_rad) const;

  /// Point of C at a range along the beam [m].
  Eigen::Vector3d point(double range_m) const { return origin_C_ + range_m * direction_C_; }
  /// Depth (along z of C) of the beam's point at a range.
  double depth(double range_m) const { return point(range_m).z(); }
  /// Component of a vector of C along the beam.
  double along(const Eigen::Vector3d& vector_C) const { return direction_C_.dot(vector_C); }
  /// Range along the beam at which its point has this depth.
  double range(double depth_m) const { return (depth_m - origin_C_.z()) / direction_C_.z(); }

  /// Stereo's reading of the surface on the beam: the footprint depends on the range and the range on the footprint,
  /// so the two are iterated to agreement from a first guess.
  /// @param disparity_px CV_32FC1, NaN = no match.
  /// @param range_guess_m NaN: start at the far end.
  /// @return nullopt if too few pixels match or no self-consistent surface is found.
  std::optional<FootprintReading> read(const cv::Mat& disparity_px, double range_guess_m, double beam_width_rad);

  /// Matches within three radii of the beam at a range, where the beam's edge may have met a surface; empty if they are
  /// fewer than lidar/min_valid_fraction of the pixels.  @return valid until the next call.
  const std::vector<float>& matchesBeside(const cv::Mat& disparity_px, double range_m, double beam_width_rad);

  /// Whether two disparities can be of one surface that faces the camera: within three sigma of a match; far away a
  /// pixel is metres.
  bool isSameSurface(double a_px, double b_px) const { return std::abs(a_px - b_px) <= 3.0 * disparity_sigma_px_; }

 private:
  int collect(const cv::Mat& disparity_px, const Footprint& circle);
  std::optional<FootprintReading> readAt(const cv::Mat& disparity_px, const Footprint& footprint);

  LidarConfig config_;
  StereoGeometry geometry_;
  Eigen::Vector3d origin_C_;
  Eigen::Vector3d direction_C_;
  double disparity_sigma_px_;
  std::vector<float> scratch_;
};

}  // namespace flight_corridor
