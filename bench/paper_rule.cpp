#include "paper_rule.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/range/scale_correction.hpp"
#include "flight_corridor/view/overlay.hpp"
#include "view/canvas.hpp"

namespace flight_corridor::bench {
namespace {

constexpr int kWidth_px = 640, kStrip_px = 32;  // width of a column, height of a strip
const cv::Scalar kWhite(255, 255, 255);

std::string metres(const char* name, double value_m) {
  return std::isnan(value_m) ? std::string(name) + " none" : cv::format("%s %.2f m", name, value_m);
}

/// The paper's figures, one below the other.
cv::Mat drawPaper(const Pipeline& pipeline, const cv::Mat& disparity_px, const PaperVerdict& verdict) {
  const cv::Rect window = paperWindow(pipeline.config().corridor, pipeline.geometry());
  const cv::Scalar paint = colour(verdict.state);
  cv::Mat picture, depth_m, depth;
  toColour(pipeline.left(), picture);
  cv::Mat inside = picture(window);
  cv::addWeighted(inside, 0.65, cv::Mat(inside.size(), CV_8UC3, paint), 0.35, 0.0, inside);
  cv::rectangle(picture, window, paint, 2);
  const double scale = std::max(0.4, picture.cols / 900.0);  // places and sizes of text as in the overlay
  const int line_px = cvRound(32 * scale);
  write(picture, toString(verdict.state), {line_px / 2, line_px}, 1.2 * scale, paint);
  write(picture, metres("d_K", verdict.fused_m), {line_px / 2, 2 * line_px}, 0.75 * scale, kWhite);
  write(picture, metres("D_c", verdict.stereo_m) + ", " + metres("d_L", verdict.lidar_m),
        {line_px / 2, cvRound(2.8 * line_px)}, 0.75 * scale, kWhite);

  const double farthest_m = pipeline.config().map.max_range_m;
  correctedDepth(disparity_px, ScaleCorrection(ScaleConfig()), pipeline.geometry(), depth_m);  // nothing learnt: f*B/d
  drawDepth(depth_m, farthest_m, depth);
  cv::rectangle(depth, window, paint, 2);
  writeCaption(cv::format("depth by SGBM and WLS: red near, blue %.0f m", farthest_m), depth);
  cv::vconcat(picture, depth, picture);
  return picture;
}

cv::Mat drawOurs(const Pipeline& pipeline, const Report& report) {
  cv::Mat picture, depth;
  drawOverlay(pipeline.left(), pipeline.covered(), pipeline.geometry(), pipeline.boxInCamera(), report.verdict,
              report.range, picture);
  drawDepth(pipeline.depth(), pipeline.config().map.max_range_m, depth);
  writeCaption("depth of the matches; black: none", depth);
  cv::vconcat(picture, depth, picture);
  return picture;
}

void label(cv::Mat& strip, const std::string& text) { write(strip, text, {8, 23}, 0.65, kWhite); }

cv::Mat column(const std::string& title, const cv::Mat& pictures) {
  cv::Mat column, strip(kStrip_px, kWidth_px, CV_8UC3, cv::Scalar::all(0));
  label(strip, title);
  const int height_px = kWidth_px * pictures.rows / pictures.cols / 2 * 2;
  cv::resize(pictures, column, {kWidth_px, height_px}, 0.0, 0.0, cv::INTER_AREA);
  cv::vconcat(strip, column, column);
  return column;
}

}  // namespace

cv::Mat drawBoth(const Pipeline& pipeline, const Report& report, const cv::Mat& disparity_px,
                 const PaperVerdict& paper) {
  cv::Mat both;
  cv::hconcat(column("Trejo, Martinez, Flores 2019", drawPaper(pipeline, disparity_px, paper)),
              column("flight_corridor", drawOurs(pipeline, report)), both);
  return both;
}

void addStrip(const std::string& name, const std::vector<tools::ResultRow>& rows, std::size_t pairs, cv::Mat& picture) {
  std::vector<State> verdicts;
  for (const tools::ResultRow& row : rows) verdicts.push_back(row.state);
  cv::Mat strip;
  drawVerdicts(verdicts, pairs, {picture.cols, kStrip_px}, strip);
  strip.rowRange(0, 2).setTo(cv::Scalar::all(0));  // between two strips
  label(strip, name);
  cv::vconcat(picture, strip, picture);
}

}  // namespace flight_corridor::bench
