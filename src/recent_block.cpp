#include "flight_corridor/recent_block.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace flight_corridor {

namespace {

constexpr double kEdge_m = 0.15;         // so far from a box's side noise may have moved what stands in it
constexpr double kLarge_m2 = 0.035;      // face of a group of hit cells: a smaller one, or one of fewer cells,
constexpr std::size_t kLarge_cells = 4;  // may be hit nowhere in the next image

using Cells = std::vector<OccupancyMap::Seen>;

/// The newest image's hits that share a point with a box, cells being taken to be so large.
Cells hitsIn(const OccupancyMap& newest, const Box& box, double cell_m) {
  Cells hits;
  std::copy_if(newest.seen().begin(), newest.seen().end(), std::back_inserter(hits),
               [&](const OccupancyMap::Seen& cell) { return cell.is_hit && intersects(box, cell.centre_M, cell_m); });
  return hits;
}

bool touch(const OccupancyMap::Seen& a, const OccupancyMap::Seen& b, double cell_m) {
  return (a.centre_M - b.centre_M).lpNorm<Eigen::Infinity>() < 1.5 * cell_m;
}

/// Whether a cell touches one that is solid, or lies behind its outline: half hidden, matches are mistaken there.
bool isEdgeOf(const OccupancyMap::Seen& solid, const OccupancyMap::Seen& cell, double cell_m) {
  if (touch(solid, cell, cell_m)) return true;
  const double nearer = solid.depth_m / cell.depth_m;
  const Eigen::Vector3d beside_C = nearer * cell.centre_M - solid.centre_M;
  return nearer < 1.0 && beside_C.head<2>().lpNorm<Eigen::Infinity>() < 1.5 * cell_m;
}

/// How far along the box's axis a cell begins.
double beginOf(const OccupancyMap::Seen& cell, const Box& box, double cell_m) {
  const Eigen::Vector3d forward = box.T_M_F.linear().col(0);
  return forward.dot(cell.centre_M - box.T_M_F.translation()) - 0.5 * cell_m * forward.lpNorm<1>();
}

}  // namespace

/// A cube's edge with which cells count up to kEdge_m, and at least the next cell, beside a box.
double RecentBlock::atEdge() const { return std::max(2.0 * kEdge_m, 3.0 * cell_m_); }

bool RecentBlock::isLarge(std::size_t cells) const {
  return cells >= kLarge_cells && static_cast<double>(cells) * cell_m_ * cell_m_ >= kLarge_m2;
}

void RecentBlock::note(const Verdict& verdict, const OccupancyMap& newest, const Box& box) {
  blocked_s_ = verdict.stamp_s;
  if (isMissable(verdict.clear_distance_m, newest, box)) {
    missable_s_ = verdict.stamp_s;
  } else if (isAtEdge(newest, box)) {
    edge_s_ = verdict.stamp_s;
  }
}

bool RecentBlock::isMissable(double clear_distance_m, const OccupancyMap& newest, const Box& box) const {
  Cells cells = hitsIn(newest, box, atEdge());  // how large a thing is does not end where the box does
  const auto is_in_box = [&](const OccupancyMap::Seen& cell) { return intersects(box, cell.centre_M, cell_m_); };
  // Something nearer than all that the image shows is the LiDAR's, or remembered, by one cell: of another grid.
  const bool is_shown = std::any_of(cells.begin(), cells.end(), [&](const OccupancyMap::Seen& cell) {
    return is_in_box(cell) && beginOf(cell, box, cell_m_) <= clear_distance_m + cell_m_;
  });
  if (!is_shown) return true;

  Cells solid;
  for (auto begin = cells.begin(); begin != cells.end();) {
    auto end = begin + 1;  // of the group, which draws what touches it to its end
    for (auto cell = begin; cell != end; ++cell) {
      end = std::partition(end, cells.end(), [&](const auto& other) { return touch(*cell, other, cell_m_); });
    }
    const bool is_large = isLarge(end - begin);
    std::copy_if(begin, end, std::back_inserter(solid), [&](const auto& cell) { return is_large && !cell.is_thin; });
    begin = end;
  }
  return std::any_of(cells.begin(), cells.end(), [&](const OccupancyMap::Seen& cell) {
    return is_in_box(cell) &&
           std::none_of(solid.begin(), solid.end(), [&](const auto& other) { return isEdgeOf(other, cell, cell_m_); });
  });
}

/// Whether no more than a small part of what is hit lies deeper in the box than its edge.
bool RecentBlock::isAtEdge(const OccupancyMap& newest, Box box) const {
  box.size_m = (box.size_m - kEdge_m * Eigen::Vector3d(1.0, 2.0, 2.0)).cwiseMax(0.0);
  return !isLarge(hitsIn(newest, box, cell_m_).size());
}

bool RecentBlock::mayRemain(double stamp_s, const OccupancyMap& newest, const Box& box) const {
  const auto is_recent = [&](double blocked_s) { return std::abs(stamp_s - blocked_s) <= hold_s_; };
  return is_recent(missable_s_) || (is_recent(edge_s_) && !hitsIn(newest, box, atEdge()).empty());
}

}  // namespace flight_corridor
