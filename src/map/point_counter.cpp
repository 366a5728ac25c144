#include "flight_corridor/map/point_counter.hpp"

#include "flight_corridor/map/evidence_tree.hpp"

namespace flight_corridor {

/// Neighbouring pixels mostly fall into one cell: runs of them are counted together.
PointCounts countPoints(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C, const StereoGeometry& geometry,
                        const MapConfig& config) {
  PointCounts counts;
  const double cells_per_m = 1.0 / config.resolution_m;
  const Eigen::Vector3d camera = T_M_C.translation().array() * cells_per_m + EvidenceTree::kKeyOrigin;
  const Eigen::Matrix3d cells_per_depth = T_M_C.linear() * cells_per_m;
  octomap::OcTreeKey last;
  std::uint32_t run = 0;
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const double hit_m = geometry.shiftedDepth<double>(depth_m.at<float>(v, u), config.hit_band_px);
      if (!(hit_m <= config.max_range_m)) continue;
      const Eigen::Array3d cell = camera + cells_per_depth * geometry.point(u, v, hit_m);
      if (!(cell >= 0.0).all() || !(cell < EvidenceTree::kLastKey + 1).all()) continue;
      const Eigen::Array<octomap::key_type, 3, 1> k = cell.cast<octomap::key_type>();
      const octomap::OcTreeKey key(k[0], k[1], k[2]);
      if (run > 0 && key != last) {
        counts[last] += run;
        run = 0;
      }
      last = key;
      ++run;
    }
  }
  if (run > 0) counts[last] += run;
  return counts;
}

}  // namespace flight_corridor
