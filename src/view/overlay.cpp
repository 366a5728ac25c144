#include "flight_corridor/view/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "view/canvas.hpp"

namespace flight_corridor {

namespace {

std::string metres(const char* name, double value_m, const char* none) {
  if (!std::isfinite(value_m)) return std::string(name) + " " + none;
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%s %.2f m", name, value_m);
  return text.data();
}

/// Corner of the box's cross-section at a distance, in C; corners in order around it.
Eigen::Vector3d corner(const Box& box_C, double x_m, int index) {
  const double side = index == 0 || index == 3 ? 0.5 : -0.5;
  const double up = index < 2 ? 0.5 : -0.5;
  return box_C.T_M_F * Eigen::Vector3d(x_m, side * box_C.size_m.y(), up * box_C.size_m.z());
}

/// Oblique lines, black beside white: seen on any picture, by any eye.
void hatch(const cv::Mat& covered, cv::Mat& out) {
  constexpr int kPeriod_px = 12, kLine_px = 2;
  for (int v = 0; v < covered.rows; ++v) {
    for (int u = 0; u < covered.cols; ++u) {
      const int line = (u + v) % kPeriod_px / kLine_px;
      if (covered.at<std::uint8_t>(v, u) && line < 2) out.at<cv::Vec3b>(v, u) = cv::Vec3b::all(line == 0 ? 255 : 0);
    }
  }
}

}  // namespace

cv::Scalar colour(State state) {
  switch (state) {
    case State::Free:
      return {80, 200, 60};
    case State::Blocked:
      return {50, 50, 230};
    case State::Unknown:
      break;
  }
  return {0, 180, 255};
}

void drawOverlay(const cv::Mat& left, const cv::Mat& covered, const StereoGeometry& geometry, const Box& box_C,
                 const Verdict& verdict, const RangeEstimate& range, cv::Mat& out, double opacity) {
  toColour(left, out);
  hatch(covered, out);
  const cv::Scalar paint = colour(verdict.state);
  Canvas canvas(geometry, out);
  const double end_m = box_C.size_m.x();
  const double stop_m = std::min(end_m, verdict.clear_distance_m);  // the window moves to where the corridor ends
  std::vector<Eigen::Vector3d> window;
  for (int i = 0; i < 4; ++i) {
    canvas.line(corner(box_C, 0.0, i), corner(box_C, end_m, i), paint);
    canvas.line(corner(box_C, end_m, i), corner(box_C, end_m, (i + 1) % 4), paint);
    window.push_back(corner(box_C, stop_m, i));
  }
  if (opacity > 0.0) canvas.fill(window, paint, opacity);
  for (int i = 0; i < 4 && !(opacity > 0.0); ++i) canvas.line(window[i], window[(i + 1) % 4], paint);

  const double scale = std::max(0.4, out.cols / 900.0);
  const int line_px = cvRound(32 * scale);
  write(out, toString(verdict.state), {line_px / 2, line_px}, 1.2 * scale, paint);
  const char* all_clear = verdict.state == State::Free ? "to the end" : "distance unknown";
  write(out, metres("clear", verdict.clear_distance_m, all_clear), {line_px / 2, 2 * line_px}, 0.75 * scale,
        {255, 255, 255});
  write(out, metres("fused range", range.range_m, "unknown"), {line_px / 2, cvRound(2.8 * line_px)}, 0.75 * scale,
        {255, 255, 255});
  write(out, describeReasons(verdict.reasons), {line_px / 2, out.rows - line_px / 2}, 0.6 * scale, {255, 255, 255});
}

void writeCaption(const std::string& text, cv::Mat& image) {
  const double scale = std::max(0.4, image.cols / 1200.0);
  write(image, text, {cvRound(12 * scale), image.rows - cvRound(14 * scale)}, scale, {255, 255, 255});
}

void drawDepth(const cv::Mat& depth_m, double max_depth_m, cv::Mat& out) {
  cv::Mat grey;
  depth_m.convertTo(grey, CV_8U, -255.0 / max_depth_m, 255.0);  // near bright; further than the maximum saturates at 0
  cv::applyColorMap(grey, out, cv::COLORMAP_TURBO);
  out.setTo(cv::Scalar(0, 0, 0), ~(depth_m == depth_m));  // NaN != NaN is false in OpenCV's vector code
}

void drawMapFromAbove(const octomap::OcTree& tree, const Box& box, const Verdict& verdict, double ahead_m,
                      cv::Size size_px, cv::Mat& out) {
  const double px_per_m = size_px.height / ahead_m;
  const double step_m = tree.getResolution();
  out.create(size_px, CV_8UC3);
  for (int row = 0; row < size_px.height; ++row) {
    for (int column = 0; column < size_px.width; ++column) {
      const double x_m = (size_px.height - row - 0.5) / px_per_m;
      const double y_m = (0.5 * size_px.width - column - 0.5) / px_per_m;
      bool occupied = false, free = false;
      for (double z_m = -0.5 * box.size_m.z() + 0.5 * step_m; z_m < 0.5 * box.size_m.z(); z_m += step_m) {
        const Eigen::Vector3d p_M = box.T_M_F * Eigen::Vector3d(x_m, y_m, z_m);
        const octomap::OcTreeNode* node = tree.search(p_M.x(), p_M.y(), p_M.z());
        occupied |= node && tree.isNodeOccupied(node);
        free |= node && !tree.isNodeOccupied(node);
      }
      const cv::Vec3b grey = occupied ? cv::Vec3b(40, 40, 40)
                             : free   ? cv::Vec3b(245, 245, 245)
                                      : cv::Vec3b(170, 170, 170);
      out.at<cv::Vec3b>(row, column) = grey;
    }
  }
  const cv::Scalar paint = colour(verdict.state);
  const auto at = [&](double x_m, double y_m) {
    return cv::Point(cvRound(0.5 * size_px.width - y_m * px_per_m), cvRound(size_px.height - x_m * px_per_m));
  };
  const double half_width_m = 0.5 * box.size_m.y();
  cv::rectangle(out, at(0.0, half_width_m), at(box.size_m.x(), -half_width_m), paint, 2, cv::LINE_AA);
  if (verdict.clear_distance_m < box.size_m.x()) {
    cv::line(out, at(verdict.clear_distance_m, half_width_m), at(verdict.clear_distance_m, -half_width_m), paint, 3,
             cv::LINE_AA);
  }
}

void drawVerdicts(const std::vector<State>& verdicts, std::size_t total, cv::Size size_px, cv::Mat& out) {
  out.create(size_px, CV_8UC3);
  out.setTo(cv::Scalar::all(0));
  const auto columnOf = [&](std::size_t index) { return static_cast<int>(index * size_px.width / total); };
  for (std::size_t i = 0; i < std::min(verdicts.size(), total); ++i) {
    out.colRange(columnOf(i), columnOf(i + 1)).setTo(colour(verdicts[i]));
  }
}

}  // namespace flight_corridor
