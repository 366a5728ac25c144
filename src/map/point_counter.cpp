#include "flight_corridor/map/point_counter.hpp"

#include <algorithm>
#include <string>

#include "flight_corridor/map/evidence_tree.hpp"
#include "flight_corridor/map/wide_registers.hpp"

namespace flight_corridor {

namespace {

constexpr unsigned kWindowBits = 10;  // of a cell's place on one axis of the window
constexpr int kWindowCells = 1 << kWindowBits;
constexpr std::uint32_t kNoCell = ~std::uint32_t{0};
constexpr std::uint32_t kParent =  // of a cell: its parent's lowest
    ~(1u | 1u << kWindowBits | 1u << 2 * kWindowBits);

/// Which child of its parent a cell of the window is.
unsigned childOfParent(std::uint32_t cell) {
  return (cell & 1u) | (cell >> (kWindowBits - 1) & 2u) | (cell >> (2 * kWindowBits - 2) & 4u);
}

}  // namespace

PointCounter::PointCounter(const MapConfig& config, const StereoGeometry& geometry)
    : config_(config), geometry_(geometry) {
  const cv::Size size = geometry.size();
  double longest_ray = 0.0;
  for (const int u : {0, size.width - 1}) {
    for (const int v : {0, size.height - 1}) longest_ray = std::max(longest_ray, geometry.point(u, v, 1).norm());
  }
  Rules rules("map");
  const double smallest_m = config.max_range_m * longest_ray / (kWindowCells / 2 - 2);
  rules.require(config.resolution_m >= smallest_m, "resolution_m",
                "at least " + std::to_string(smallest_m) + " with this max_range_m and field of view",
                config.resolution_m);
  throwIfBroken(rules.broken());
}

/// Neighbouring pixels mostly fall into one cell: runs of them are counted together.
void PointCounter::count(const cv::Mat& depth_m, const Eigen::Isometry3d& T_M_C) {
  points_.clear();
  const Eigen::Array3d camera_key =
      T_M_C.cast<float>().translation().cast<double>().array() / config_.resolution_m + EvidenceTree::kKeyOrigin;
  if (!(camera_key >= 0.0).all() || !(camera_key <= EvidenceTree::kLastKey).all()) return;
  window_key_ = (0.5 * camera_key).floor().cast<int>() * 2 - kWindowCells / 2;  // even: where a parent begins
  for (int v = 0; v < depth_m.rows; ++v) {
    findCells(depth_m.ptr<float>(v), v, T_M_C.cast<float>());
    findRuns();
    int begin = 0;
    for (const int end : run_ends_) {
      const std::uint32_t cell = row_cells_[begin];
      const auto points = static_cast<std::uint32_t>(end - begin);
      if (cell != kNoCell) points_.add(cell & kParent, childOfParent(cell), points);
      begin = end;
    }
  }
}

/// Where the cell changes along a row, without a branch that no processor could foretell.
void PointCounter::findRuns() {
  const int width = static_cast<int>(row_cells_.size());
  run_ends_.resize(width);
  const std::uint32_t* cells = row_cells_.data();
  int* ends = run_ends_.data();
  for (int u = 1; u < width; ++u) {
    *ends = u;
    ends += cells[u] != cells[u - 1];
  }
  *ends++ = width;
  run_ends_.resize(ends - run_ends_.data());
}

/// Cells of a row's points, in a plain loop over local values that the compiler vectorises.
FLIGHT_CORRIDOR_WIDE void PointCounter::findCells(const float* depth_m, int v, const Eigen::Isometry3f& T_M_C) {
  const int width = geometry_.size().width;
  row_cells_.resize(width);
  std::uint32_t* cells = row_cells_.data();
  const StereoGeometry geometry = geometry_;
  const double band_px = config_.hit_band_px;
  const auto max_range_m = static_cast<float>(config_.max_range_m);
  const double cells_per_m = 1.0 / config_.resolution_m;
  const Eigen::Vector3d at_first = T_M_C.linear().cast<double>() * geometry_.point(0, v, 1);
  const Eigen::Vector3d at_second = T_M_C.linear().cast<double>() * geometry_.point(1, v, 1);
  const Eigen::Vector3f first = (at_first * cells_per_m).cast<float>();
  const Eigen::Vector3f step = ((at_second - at_first) * cells_per_m).cast<float>();
  const Eigen::Vector3d camera = T_M_C.translation().cast<double>() * cells_per_m;
  const Eigen::Vector3f origin = (camera.array() + EvidenceTree::kKeyOrigin - window_key_.cast<double>()).cast<float>();
  const float first_x = first[0], first_y = first[1], first_z = first[2];
  const float step_x = step[0], step_y = step[1], step_z = step[2];
  const float origin_x = origin[0], origin_y = origin[1], origin_z = origin[2];
  for (int u = 0; u < width; ++u) {
    const float hit_m = geometry.shiftedDepth(depth_m[u], band_px);
    const float inside_m = std::min(max_range_m, hit_m);  // also of NaN
    const auto column = static_cast<float>(u);
    const auto x = static_cast<int>((first_x + step_x * column) * inside_m + origin_x);
    const auto y = static_cast<int>((first_y + step_y * column) * inside_m + origin_y);
    const auto z = static_cast<int>((first_z + step_z * column) * inside_m + origin_z);
    const auto place = static_cast<std::uint32_t>(x | y << kWindowBits | z << 2 * kWindowBits);
    cells[u] = place | -static_cast<std::uint32_t>(!(hit_m <= max_range_m));
  }
}

Eigen::Array3i PointCounter::lowestCell(const CellCounts::Cube& cube) const {
  const auto part = [&](unsigned axis) {
    return static_cast<int>(cube.key >> (kWindowBits * axis) & (kWindowCells - 1));
  };
  return window_key_ + Eigen::Array3i(part(0), part(1), part(2));
}

}  // namespace flight_corridor
