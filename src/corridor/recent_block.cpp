#include "flight_corridor/corridor/recent_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

namespace flight_corridor {

namespace {

constexpr double kEdge_m = 0.15;         // so far from a box's side noise may have moved what stands in it
constexpr double kLarge_m2 = 0.035;      // seen of a group of hit cells: a smaller one, or one of fewer cells,
constexpr std::size_t kLarge_cells = 4;  // may be hit nowhere in the next image

using Seen = OccupancyMap::Seen;
using SeenCells = std::pmr::vector<Seen>;

/// Whether a cell, taken to be so large, is a hit that shares a point with a box.
bool isHitIn(const Seen& cell, const Box& box, double cell_m) {
  return cell.is_hit && intersects(box, cell.centre_M, cell_m);
}

bool isLarge(const SeenCells& group, double cell_m) {
  double faces = 0.0;
  for (const Seen& cell : group) faces += std::min(1.0f, cell.face);
  return group.size() >= kLarge_cells && faces * cell_m * cell_m >= kLarge_m2;
}

/// Groups of cells that touch each other.
std::pmr::vector<SeenCells> groupsOf(const SeenCells& cells, double cell_m) {
  using Key = std::array<int, 3>;
  std::pmr::map<Key, Seen> rest(cells.get_allocator());
  for (const Seen& cell : cells) {
    const Eigen::Array3i place = (cell.centre_M / cell_m).array().floor().cast<int>();
    rest.emplace(Key{place.x(), place.y(), place.z()}, cell);
  }
  std::pmr::vector<SeenCells> groups(cells.get_allocator());
  std::pmr::vector<Key> open(cells.get_allocator());
  while (!rest.empty()) {
    SeenCells& group = groups.emplace_back();
    open.push_back(rest.begin()->first);
    while (!open.empty()) {
      const Key key = open.back();
      open.pop_back();
      const auto cell = rest.find(key);
      if (cell == rest.end()) continue;
      group.push_back(cell->second);
      rest.erase(cell);
      for (int i = 0; i < 27; ++i) open.push_back({key[0] + i % 3 - 1, key[1] + i / 3 % 3 - 1, key[2] + i / 9 - 1});
    }
  }
  return groups;
}

/// Whether a cell lies at the outline of a nearer one, where matches are half hidden and mistaken.
bool isBehindOutline(const Seen& cell, const Seen& nearer, double cell_m) {
  const double share = nearer.depth_m / cell.depth_m;
  const Eigen::Vector3d beside_C = share * cell.centre_M - nearer.centre_M;
  return share < 1.0 && beside_C.head<2>().lpNorm<Eigen::Infinity>() <= cell_m;
}

bool touch(const Seen& one, const Seen& other, double cell_m) {
  return (one.centre_M - other.centre_M).lpNorm<Eigen::Infinity>() < 1.5 * cell_m;
}

/// How far along the box's axis a cell begins.
double beginOf(const Seen& cell, const Box& box, double cell_m) {
  const Eigen::Vector3d forward = box.T_M_F.linear().col(0);
  return forward.dot(cell.centre_M - box.T_M_F.translation()) - 0.5 * cell_m * forward.lpNorm<1>();
}

}  // namespace

/// A cube's edge with which cells count up to kEdge_m, and at least the next cell, beside a box.
double RecentBlock::reach() const { return std::max(2.0 * kEdge_m, 3.0 * cell_m_); }

void RecentBlock::note(const Verdict& verdict, const std::optional<double>& beam_end_m, const OccupancyMap& newest,
                       const Box& box, std::pmr::memory_resource* memory) {
  const auto is_in_box = [&](const Seen& cell) {  // what begins at the far end is not
    return intersects(box, cell.centre_M, cell_m_) && beginOf(cell, box, cell_m_) < box.size_m.x() - kTouch_m;
  };
  Box middle = box;
  middle.size_m = (box.size_m - kEdge_m * Eigen::Vector3d(1.0, 2.0, 2.0)).cwiseMax(0.0);

  blocked_s_ = verdict.stamp_s;
  SeenCells hits(memory), large(memory), small(memory), in_middle(memory);
  const auto is_near = [&](const Seen& cell) { return isHitIn(cell, box, reach()); };  // large obstacles end beside it
  std::copy_if(newest.seen().begin(), newest.seen().end(), std::back_inserter(hits), is_near);
  for (const SeenCells& group : groupsOf(hits, cell_m_)) {
    const bool is_large = isLarge(group, cell_m_);
    SeenCells& kind = is_large ? large : small;
    kind.insert(kind.end(), group.begin(), group.end());
    in_middle.clear();
    std::copy_if(group.begin(), group.end(), std::back_inserter(in_middle),
                 [&](const Seen& cell) { return intersects(middle, cell.centre_M, cell_m_); });
    const bool is_in_the_way = std::any_of(group.begin(), group.end(), is_in_box);
    if (is_in_the_way && !isLarge(in_middle, cell_m_)) edge_s_ = verdict.stamp_s;
  }

  const auto is_missable = [&](const Seen& cell) {
    return is_in_box(cell) && std::none_of(large.begin(), large.end(), [&](const Seen& other) {
             return touch(cell, other, cell_m_) || isBehindOutline(cell, other, cell_m_);
           });
  };
  const auto is_shown = [&](double begin_m) {  // by one and a half cells: the map may have another grid
    return std::any_of(hits.begin(), hits.end(), [&](const Seen& cell) {
      return is_in_box(cell) && std::abs(beginOf(cell, box, cell_m_) - begin_m) <= 1.5 * cell_m_;
    });
  };
  if (!is_shown(verdict.clear_distance_m) || (beam_end_m && !is_shown(*beam_end_m)) ||
      std::any_of(small.begin(), small.end(), is_missable)) {
    missable_s_ = verdict.stamp_s;
  }
}

bool RecentBlock::mayRemain(double stamp_s, const OccupancyMap& newest, const Box& box) const {
  const auto is_recent = [&](double blocked_s) { return std::abs(stamp_s - blocked_s) <= hold_s_; };
  const auto is_hit = [&](double cell_m) {
    return std::any_of(newest.seen().begin(), newest.seen().end(),
                       [&](const Seen& cell) { return isHitIn(cell, box, cell_m); });
  };
  return is_recent(missable_s_) || (is_recent(edge_s_) && is_hit(reach())) ||
         (is_recent(blocked_s_) && is_hit(cell_m_));
}

}  // namespace flight_corridor
