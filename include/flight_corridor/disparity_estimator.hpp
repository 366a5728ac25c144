#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/ximgproc/disparity_filter.hpp>
#include <string>

#include "flight_corridor/disparity_refiner.hpp"
#include "flight_corridor/island_filter.hpp"
#include "flight_corridor/level_matcher.hpp"
#include "flight_corridor/stereo_geometry.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

struct StereoConfig {
  std::string mode = "3way";     ///< sgbm, hh, 3way or hh4 (cv::StereoSGBM modes).
  int num_disparities_px = 128;  ///< Search range, a multiple of 32; nearest depth = f*B/num_disparities.
  int block_size_px = 3;         ///< Odd.
  int smoothness_small = 4;      ///< SGBM P1 per pixel of the block (Hirschmueller 2008, eq. 13).
  int smoothness_large = 12;     ///< SGBM P2 per pixel of the block.
  int uniqueness_percent = 10;   ///< The best match must beat the second by this much.
  int left_right_max_px = 1;     ///< Largest left-right inconsistency; -1 switches the check off.
  int speckle_window_px = 100;   ///< Smaller islands of disparity are removed, unless they are a thing; 0: none is.
  int speckle_range_px = 2;
  double texture_min = 1.5;            ///< Smallest local grey gradient that counts as texture [grey levels]; a dim
                                       ///< image has less noise, there down to two thirds of this.
  double wls_lambda = 8000.0;          ///< Weight of smoothness in the WLS filter (Min et al. 2014).
  double wls_sigma = 1.5;              ///< Sensitivity to image edges in the WLS filter.
  double wls_min_confidence = 0.5;     ///< Below, a WLS value is invented, not measured [0..1].
  double min_matched_fraction = 0.08;  ///< Fewer matched pixels, of an image or where a box is seen: no evidence.
};
Violations check(const StereoConfig& config);

/// What the matcher saw. All maps have the image's size; principal-point difference removed; NaN = nothing.
struct Disparity {
  cv::Mat matched_px;             ///< CV_32FC1: unique, left-right consistent, textured matches. The evidence.
  cv::Mat filtered_px;            ///< CV_32FC1: edge-preserving WLS fill between the matches, confident pixels only.
  cv::Mat confidence;             ///< CV_32FC1 [0..1]: of filtered_px.
  double matched_fraction = 0.0;  ///< Share of pixels with a match.
  cv::Mat small;                  ///< CV_8U: 255 where a match is of a thing smaller than stereo/speckle_window_px.
  cv::Mat thin;                   ///< CV_8U: 255 where most matches around are of other surfaces, and draw it to them.
  cv::Mat level;                  ///< CV_8U: 255 where a level edge is ranged by its slope alone.
  cv::Mat texture;  ///< CV_32FC1: mean absolute gradient along the row, over the matcher's block [grey levels].
  double least_texture = 0.0;  ///< Less may be noise [grey levels].
};

/// Dense disparity of a rectified pair: semi-global matching (Hirschmueller 2008) and weighted least squares
/// filtering (Min et al. 2014) by OpenCV. One object, one thread; scratch images are reused.
class DisparityEstimator {
 public:
  /// @throws std::invalid_argument with every broken rule.
  DisparityEstimator(const StereoConfig& config, const StereoGeometry& geometry);

  /// @param frame both images CV_8UC1 of geometry.size().
  /// @param out refilled.
  void estimate(const StereoFrame& frame, Disparity& out);

  /// Where in C a surface is on both images. Also where it is too near for the disparities searched.
  ConvexRegion observable() const;

  /// Nothing nearer is found: a smaller disparity is taken for it, or none [m].
  double nearestDepth() const;

 private:
  void pad(const cv::Mat& image, cv::Mat& padded) const;
  void match(const cv::Mat& left, Disparity& out);
  void measureTexture(const cv::Mat& image, cv::Mat& texture);
  void rejectBare(double least_texture);
  double leastTexture(const cv::Mat& image) const;
  void fill(Disparity& out);
  void rejectInvented(Disparity& out);
  void alignFill(Disparity& out);
  void toPixels(const cv::Mat& fixed, const cv::Mat& keep, cv::Mat& disparity_px) const;
  void removeDifference(cv::Mat& disparity_px) const;

  StereoConfig config_;
  StereoGeometry geometry_;
  int min_disparity_px_;  // of the matcher: room below zero for a rig whose offset is wrong
  int pad_left_px_,
      pad_right_px_;     // the matcher skips columns that cannot see its whole search range: padding brings them back
  cv::Rect image_area_;  // of the padded images
  cv::Ptr<cv::StereoSGBM> matcher_;
  IslandFilter island_filter_;
  LevelMatcher level_matcher_;
  DisparityRefiner refiner_;
  cv::Ptr<cv::StereoSGBM> wls_left_matcher_;
  cv::Ptr<cv::StereoMatcher> wls_right_matcher_;
  cv::Ptr<cv::ximgproc::DisparityWLSFilter> wls_;
  cv::Mat balanced_right_, left_padded_, right_padded_, left_half_, right_half_;
  cv::Mat left_fixed_, matched_fixed_, right_fixed_, filtered_fixed_, gradient_, right_texture_, keep_;
  cv::Mat support_, lowest_, highest_, difference_, weight_;
};

}  // namespace flight_corridor
