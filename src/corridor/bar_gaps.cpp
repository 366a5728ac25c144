#include "flight_corridor/corridor/bar_gaps.hpp"

#include <algorithm>
#include <cmath>

#include "flight_corridor/stereo/match_error.hpp"

namespace flight_corridor {

namespace {

constexpr double kWidest = 4.0;                      // times the smallest obstacle: a wider thing is no bar
constexpr int kNarrowest_px = 3;                     // fewer matches of a row are chance
constexpr int kRows = 4;                             // of a piece at least; up to so many rows may be missing in it
constexpr float kApart_px = 2.0f * kSameSurface_px;  // a bar is so much nearer than what is beside it
constexpr double kLean = 0.35;                       // of a gap's height: so far aside a bar may go on

}  // namespace

void BarGaps::find(const cv::Mat& disparity_px, const cv::Mat& textured, const ScaleCorrection& correction,
                   double smallest_m) {
  matches_px_.create(disparity_px.size(), CV_32FC1);
  matches_px_.setTo(kNaN);
  disparity_px.copyTo(matches_px_, textured);
  findRuns(correction, smallest_m);
  join();
  gaps_C_.clear();
  for (const Piece& piece : pieces_) {
    if (const Piece* next = below(piece)) {
      gaps_C_.push_back(between(piece, *next, correction, smallest_m));
    }
  }
}

void BarGaps::findRuns(const ScaleCorrection& correction, double smallest_m) {
  runs_.clear();
  rows_.clear();
  const int width = matches_px_.cols;
  for (int v = 0; v < matches_px_.rows; ++v) {
    rows_.push_back(runs_.size());
    const auto* row = matches_px_.ptr<float>(v);
    const auto isFarther = [&](int u, int step, float bar_px) {
      for (int i = 0; i < kEdgeWidth_px; ++i, u += step) {
        if (u < 0 || u >= width) return false;
        if (!std::isnan(row[u])) return row[u] < bar_px - kApart_px;
      }
      return true;
    };
    for (int u = 0; u < width;) {
      const int begin = u;
      float sum_px = row[u++];
      if (std::isnan(sum_px)) continue;
      while (u < width && std::abs(row[u] - row[u - 1]) <= kSameSurface_px) sum_px += row[u++];
      const float mean_px = sum_px / static_cast<float>(u - begin);
      if (u - begin < kNarrowest_px || !isFarther(begin - 1, -1, mean_px) || !isFarther(u, 1, mean_px)) continue;
      const double px_per_m = geometry_.calibration().fx_px / geometry_.depth(correction.correct(mean_px));
      if (u - begin <= kEdgeWidth_px + kWidest * smallest_m * px_per_m) runs_.push_back({v, begin, u, mean_px, -1});
    }
  }
  rows_.push_back(runs_.size());
}

void BarGaps::join() {
  pieces_.clear();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    Run& run = runs_[i];
    for (int v = run.v - 1; v >= std::max(0, run.v - kRows) && run.piece < 0; --v) {
      for (std::size_t j = rows_[v]; j < rows_[v + 1] && run.piece < 0; ++j) {
        const Run& above = runs_[j];
        const bool touches = above.begin < run.end && run.begin < above.end;
        if (touches && std::abs(above.disparity_px - run.disparity_px) <= kSameSurface_px) run.piece = above.piece;
      }
    }
    if (run.piece < 0) {
      run.piece = static_cast<int>(pieces_.size());
      pieces_.push_back({run.v, run.v - 1});
    }
    Piece& piece = pieces_[run.piece];
    piece.rows += piece.last_v != run.v;
    piece.last_v = run.v;
    piece.runs.push_back(static_cast<int>(i));
  }
  const auto is_chance = [](const Piece& piece) { return piece.rows < kRows; };
  pieces_.erase(std::remove_if(pieces_.begin(), pieces_.end(), is_chance), pieces_.end());
  for (Piece& piece : pieces_) measure(piece);
}

void BarGaps::measure(Piece& piece) const {
  const std::size_t count = piece.runs.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Run& run = runs_[piece.runs[i]];
    piece.disparity_px += run.disparity_px / static_cast<double>(count);
    piece.width_px += static_cast<double>(run.end - run.begin) / static_cast<double>(count);
    const double middle_u = 0.5 * (run.begin + run.end - 1);
    if (i < kRows) piece.first_u += middle_u / kRows;
    if (i + kRows >= count) piece.last_u += middle_u / kRows;
  }
}

/// The next piece of the same bar; null: there is none.
const BarGaps::Piece* BarGaps::below(const Piece& piece) const {
  const Piece* next = nullptr;
  for (const Piece& other : pieces_) {
    const int rows = other.first_v - piece.last_v;
    const double aside_px = std::abs(other.first_u - piece.last_u);
    const bool is_of_it = rows > 1 && std::abs(other.disparity_px - piece.disparity_px) <= kApart_px &&
                          aside_px <= 0.5 * kEdgeWidth_px + kLean * rows;
    if (is_of_it && (!next || other.first_v < next->first_v)) next = &other;
  }
  return next;
}

/// As near as its nearer piece, as wide as the bar without the matches beside its edges; where something is matched as
/// near, there is no gap.
std::vector<PatchPoint> BarGaps::between(const Piece& above, const Piece& below, const ScaleCorrection& correction,
                                         double smallest_m) const {
  std::vector<PatchPoint> points_C;
  const double bar_px = std::max(above.disparity_px, below.disparity_px) + kMatchNoise_px;
  const double depth_m = geometry_.depth(correction.correct(bar_px)), pixel_m = depth_m / geometry_.calibration().fx_px;
  const double pixel_m2 = pixel_m * std::max(pixel_m, smallest_m / kEdgeWidth_px);
  const double half_px = std::max(1.0, 0.5 * (std::min(above.width_px, below.width_px) - kEdgeWidth_px));
  for (int v = above.last_v + 1; v < below.first_v; ++v) {
    const double along = static_cast<double>(v - above.last_v) / (below.first_v - above.last_v);
    const double u = above.last_u + along * (below.first_u - above.last_u);
    const int first = std::max(0, static_cast<int>(std::lround(u - half_px)));
    const int last = std::min(matches_px_.cols - 1, static_cast<int>(std::lround(u + half_px)));
    for (int i = first; i <= last; ++i) {
      if (matches_px_.at<float>(v, i) > bar_px - kSameSurface_px) continue;
      points_C.push_back({geometry_.point(i, v, depth_m).cast<float>(), static_cast<float>(pixel_m2)});
    }
  }
  return points_C;
}

std::vector<double> BarGaps::freeUpTo(const Fan& fan_C, double smallest_m) const {
  std::vector<double> free_m(fan_C.size(), kInfinity);
  for (const std::vector<PatchPoint>& gap_C : gaps_C_) shorten(fan_C, fan_C.T_F_C(), gap_C, smallest_m, free_m);
  return free_m;
}

}  // namespace flight_corridor
