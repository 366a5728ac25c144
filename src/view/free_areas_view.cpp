#include "flight_corridor/view/free_areas_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/view/overlay.hpp"
#include "view/canvas.hpp"

namespace flight_corridor {

namespace {

constexpr double kTileShare = 0.9;        // of a step: a gap is left between tiles
constexpr double kNumbersFrom_px = 26.0;  // in narrower tiles no number is legible
const cv::Scalar kWhite(255, 255, 255), kBlack(0, 0, 0), kGoal(255, 140, 30);

std::string degrees(double angle_rad, const char* positive, const char* negative) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.0f deg %s", std::abs(angle_rad) * 180.0 / M_PI,
                angle_rad >= 0.0 ? positive : negative);
  return text.data();
}

std::string describe(const AreaGrid& areas) {
  if (areas.best < 0) return "no direction is free";
  const FreeArea& best = areas.areas[static_cast<std::size_t>(areas.best)];
  std::string text = "best:";
  constexpr double kAhead_rad = 0.5 * M_PI / 180.0;  // rounds to no degree
  const bool turns = std::abs(best.yaw_rad) > kAhead_rad, climbs = std::abs(best.pitch_rad) > kAhead_rad;
  if (turns) text += " " + degrees(best.yaw_rad, "left", "right");
  if (climbs) text += (turns ? ", " : " ") + degrees(best.pitch_rad, "up", "down");
  return turns || climbs ? text : text + " straight ahead";
}

void ring(cv::Mat& image, cv::Point at, int radius_px) {
  cv::circle(image, at, radius_px, kBlack, 6, cv::LINE_AA);
  cv::circle(image, at, radius_px, kWhite, 3, cv::LINE_AA);
  cv::circle(image, at, std::max(2, radius_px / 5), kBlack, cv::FILLED, cv::LINE_AA);
  cv::circle(image, at, std::max(1, radius_px / 5 - 1), kWhite, cv::FILLED, cv::LINE_AA);
}

void diamond(cv::Mat& image, cv::Point at, int radius_px) {
  const std::vector<cv::Point> corners{at + cv::Point(radius_px, 0), at + cv::Point(0, radius_px),
                                       at - cv::Point(radius_px, 0), at - cv::Point(0, radius_px)};
  cv::polylines(image, corners, true, kBlack, 6, cv::LINE_AA);
  cv::polylines(image, corners, true, kGoal, 3, cv::LINE_AA);
}

/// Where a direction's box ends.
Eigen::Vector3d endOf(const FreeArea& area, const Box& box_C) { return box_C.T_M_F * (box_C.size_m.x() * ahead(area)); }

}  // namespace

std::vector<Eigen::Vector3d> tileOf(const FreeArea& area, const Box& box_C, double step_rad, double distance_m) {
  const double half_rad = 0.5 * kTileShare * step_rad;
  std::vector<Eigen::Vector3d> corners;
  for (const auto& [left, up] : {std::pair(1, 1), std::pair(-1, 1), std::pair(-1, -1), std::pair(1, -1)}) {
    const FreeArea corner{area.yaw_rad + left * half_rad, area.pitch_rad + up * half_rad, {}};
    corners.emplace_back(box_C.T_M_F * (distance_m * ahead(corner)));
  }
  return corners;
}

void drawFreeAreas(const cv::Mat& left, const StereoGeometry& geometry, const Box& box_C, const AreaGrid& areas,
                   double step_rad, const std::optional<Eigen::Vector3d>& goal_C, cv::Mat& out) {
  toColour(left, out);
  const Canvas canvas(geometry, out);
  cv::Mat painted = out.clone();
  std::vector<std::vector<cv::Point>> tiles;
  for (const FreeArea& area : areas.areas) {
    tiles.push_back(canvas.outline(tileOf(area, box_C, step_rad, box_C.size_m.x())));
    if (!tiles.back().empty()) cv::fillConvexPoly(painted, tiles.back(), colour(area.verdict.state), cv::LINE_AA);
  }
  constexpr double kOpacity = 0.35;
  cv::addWeighted(painted, kOpacity, out, 1.0 - kOpacity, 0.0, out);

  const double tile_px = geometry.calibration().fx_px * step_rad;
  const auto middle = [&](const std::vector<cv::Point>& tile) { return (tile[0] + tile[1] + tile[2] + tile[3]) / 4; };
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].empty()) continue;
    const Verdict& verdict = areas.areas[i].verdict;
    cv::polylines(out, tiles[i], true, colour(verdict.state), 1, cv::LINE_AA);
    const bool has_number = static_cast<int>(i) / areas.columns == areas.rows / 2 && tile_px >= kNumbersFrom_px;
    if (verdict.state != State::Blocked || !has_number || !std::isfinite(verdict.clear_distance_m)) continue;
    std::array<char, 16> metres;
    std::snprintf(metres.data(), metres.size(), "%.1f", verdict.clear_distance_m);
    const double scale = tile_px / 90.0;
    write(out, metres.data(), middle(tiles[i]) + cv::Point(cvRound(-28 * scale), cvRound(10 * scale)), scale, kWhite);
  }
  const int radius_px = std::max(6, cvRound(0.4 * tile_px));
  if (goal_C) {
    const Eigen::Vector3d end_C = box_C.T_M_F.translation() + goal_C->stableNormalized() * box_C.size_m.x();
    if (Canvas::shows(end_C)) diamond(out, canvas.pixel(end_C), radius_px);
  }
  if (areas.best >= 0) {
    const Eigen::Vector3d end_C = endOf(areas.areas[static_cast<std::size_t>(areas.best)], box_C);
    if (Canvas::shows(end_C)) ring(out, canvas.pixel(end_C), radius_px);
  }
  const double scale = std::max(0.4, out.cols / 900.0);
  write(out, describe(areas), {cvRound(16 * scale), cvRound(32 * scale)}, scale,
        areas.best < 0 ? colour(State::Unknown) : kWhite);
}

}  // namespace flight_corridor
