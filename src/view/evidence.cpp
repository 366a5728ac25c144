#include "flight_corridor/view/evidence.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/stereo/match_error.hpp"
#include "view/canvas.hpp"

namespace flight_corridor {

namespace {

struct Colour {
  const char* name;
  cv::Vec3b bgr;
};

const std::array<Colour, 8> kColours{{{"outside", {}},
                                      {"clear", {115, 158, 0}},
                                      {"clear before", {178, 114, 0}},
                                      {"no match", {0, 0, 0}},
                                      {"no texture", {66, 228, 240}},
                                      {"doubtful", {167, 121, 204}},
                                      {"hole", {255, 255, 255}},
                                      {"in the box", {0, 94, 213}}}};

Evidence evidenceOf(Sighted sighted, bool is_textured) {
  switch (sighted) {
    case Sighted::Clear:
      return Evidence::Clear;
    case Sighted::ClearBefore:
      return Evidence::ClearBefore;
    case Sighted::Unclear:
      return is_textured ? Evidence::Unmatched : Evidence::Textureless;
    case Sighted::Nowhere:
      break;
  }
  return Evidence::Outside;
}

}  // namespace

cv::Mat evidenceOf(const Pipeline& pipeline) {
  if (pipeline.depth().empty()) return {};
  const StereoGeometry& geometry = pipeline.geometry();
  const Box box_C = pipeline.boxInCamera();
  const cv::Mat sighted = pipeline.sighted(), doubtful = pipeline.doubtful(), &depth_m = pipeline.texturedDepth();
  const cv::Rect hole = pipeline.hole();
  cv::Mat evidence(geometry.size(), CV_8UC1);
  for (int v = 0; v < evidence.rows; ++v) {
    for (int u = 0; u < evidence.cols; ++u) {
      Evidence here = evidenceOf(static_cast<Sighted>(sighted.at<std::uint8_t>(v, u)),
                                 pipeline.textured().at<std::uint8_t>(v, u) != 0);
      if (doubtful.at<std::uint8_t>(v, u) == 255) here = Evidence::Doubtful;
      if (hole.contains({u, v})) here = Evidence::Hole;
      const double nearest_m = geometry.shiftedDepth<double>(depth_m.at<float>(v, u), kMatchNoise_px);
      if (contains(box_C, geometry.point(u, v, nearest_m))) here = Evidence::InBox;
      evidence.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(here);
    }
  }
  return evidence;
}

void drawEvidence(const cv::Mat& left, const cv::Mat& evidence, cv::Mat& out) {
  constexpr double kOpacity = 0.55;
  if (evidence.empty()) return out.release();
  toColour(left, out);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const std::uint8_t here = evidence.at<std::uint8_t>(v, u);
      cv::Vec3b& pixel = out.at<cv::Vec3b>(v, u);
      if (here != static_cast<std::uint8_t>(Evidence::Outside)) {
        pixel = kOpacity * kColours[here].bgr + (1.0 - kOpacity) * pixel;
      }
    }
  }
}

void addLegend(cv::Mat& picture) {
  const double scale = std::max(0.35, picture.cols / 1600.0);
  const int line_px = cvRound(40 * scale), columns = 4, entry_px = picture.cols / columns;
  cv::Mat legend = cv::Mat::zeros(2 * line_px, picture.cols, CV_8UC3);
  for (std::size_t i = 1; i < kColours.size(); ++i) {
    const int at = static_cast<int>(i - 1), x = at % columns * entry_px, y = at / columns * line_px;
    const cv::Rect field(x + line_px / 4, y + line_px / 4, line_px / 2, line_px / 2);
    cv::rectangle(legend, field, cv::Scalar(kColours[i].bgr), cv::FILLED);
    cv::rectangle(legend, field, {128, 128, 128});
    write(legend, kColours[i].name, {x + line_px, y + line_px * 2 / 3}, scale, {255, 255, 255});
  }
  cv::vconcat(picture, legend, picture);
}

}  // namespace flight_corridor
