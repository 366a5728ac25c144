#pragma once

#include <octomap/OcTree.h>

#include <opencv2/calib3d.hpp>
#include <unordered_map>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"

namespace flight_corridor::bench {

constexpr int kDisparities_px = 128;

/// Pixels of OpenCV's fixed-point disparities, principal-point difference removed.
void toPixels(const cv::Mat& fixed, const StereoGeometry& geometry, cv::Mat& disparity_px);

/// What one would put together from stock parts: the matcher of stereo_image_proc with its defaults, but for the search
/// range, and its cloud by insertPointCloud into an empty OctoMap of 0.10 m, out to 8 m.
class StockOctomap {
 public:
  explicit StockOctomap(const StereoGeometry& geometry, int disparities_px = kDisparities_px)
      : geometry_(geometry),
        matcher_(
            cv::StereoSGBM::create(0, disparities_px, 15, 200, 400, 0, 31, 15, 100, 4, cv::StereoSGBM::MODE_SGBM)) {}

  /// Builds cloud and map of one pair.  @param left, right CV_8UC1.
  void insert(const cv::Mat& left, const cv::Mat& right);

  /// Whether nothing was matched.
  bool empty() const { return cloud_.size() == 0; }

  /// To the nearest occupied leaf in the box that holds enough points; +inf when there is none [m].
  double clearDistance(const Box& box_C, int enough) const;

 private:
  void makeCloud();

  static constexpr double kResolution_m = 0.10, kMaxRange_m = 8.0;

  StereoGeometry geometry_;
  cv::Ptr<cv::StereoSGBM> matcher_;
  cv::Mat fixed_, disparity_px_;
  octomap::Pointcloud cloud_;
  octomap::OcTree tree_{kResolution_m};
};

}  // namespace flight_corridor::bench
