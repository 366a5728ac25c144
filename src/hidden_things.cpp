#include "flight_corridor/hidden_things.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flight_corridor/cross_sections.hpp"

namespace flight_corridor {

namespace {

constexpr double kThing_m = 0.12;         // with what it hides from one camera
constexpr double kHole = 0.75;            // share of a square of that size without a depth; matching frays its edge
constexpr double kAround = 2.5;           // that square's sizes, in which matches around are looked at
constexpr double kSameSurface_px = 3.0;   // matches that differ by less are of one surface
constexpr double kSmallestSquare_px = 7;  // smaller holes are everywhere
constexpr double kLargestSquare_px = 63;  // nearer ends: a hole of this size is enough, and takes no longer to find
constexpr float kInfinite_px = std::numeric_limits<float>::infinity();

int oddBelow(double px) { return static_cast<int>(px / 2.0) * 2 + 1; }

}  // namespace

bool mayHideThing(const Box& box_C, const DepthImages& depth, const Disparity& disparity,
                  const StereoGeometry& geometry) {
  const cv::Rect view = viewOfFarPart(box_C, geometry);  // nearer, small things look large
  const cv::Rect image({}, depth.filled_m.size());
  const double end_m = (box_C.T_M_F * Eigen::Vector3d(box_C.size_m.x(), 0.0, 0.0)).z();
  if (depth.filled_m.empty() || view.empty() || !(end_m > 0.0)) return false;
  const double thing_px = geometry.calibration().fx_px * kThing_m / end_m;
  const double square_px = std::clamp(thing_px, kSmallestSquare_px, kLargestSquare_px);
  const int hole_px = oddBelow(square_px), around_px = oddBelow(kAround * hole_px);

  const cv::Point reach(around_px / 2, around_px / 2);
  const cv::Rect area = cv::Rect(view.tl() - reach, view.br() + reach) & image;
  const cv::Mat filled_m = depth.filled_m(area);
  cv::Mat is_empty = ~(filled_m == filled_m), share, lowest_px, highest_px;
  if (!depth.background.empty()) is_empty.setTo(0, depth.background(area));
  cv::boxFilter(is_empty, share, CV_32F, {hole_px, hole_px});  // of 255
  const cv::Mat matched_px = disparity.matched_px(area), is_unmatched = ~(matched_px == matched_px);
  const cv::Mat around = cv::getStructuringElement(cv::MORPH_RECT, {around_px, around_px});
  matched_px.copyTo(lowest_px);
  lowest_px.setTo(kInfinite_px, is_unmatched);
  cv::erode(lowest_px, lowest_px, around);
  matched_px.copyTo(highest_px);
  highest_px.setTo(-kInfinite_px, is_unmatched);
  cv::dilate(highest_px, highest_px, around);
  const cv::Mat is_hole = (share >= kHole * 255.0) & (highest_px - lowest_px <= kSameSurface_px);
  return cv::countNonZero(is_hole(view - area.tl())) > 0;
}

}  // namespace flight_corridor
