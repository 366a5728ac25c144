#pragma once

#include <octomap/OcTree.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "flight_corridor/corridor/verdict.hpp"
#include "flight_corridor/geometry/box.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// The paper's window on the left image: the corridor's box as outline, its far end filled; green free, red blocked,
/// amber unknown; state, d_K and clear distance as text. The UAV's own parts are hatched in black and white.
/// @param left  CV_8UC1 or CV_8UC3 (BGR).   @param box_C  the box with M = C.
/// @param covered  CV_8UC1 of that size, see coveredPixels(); empty: nothing is covered.
/// @param out   CV_8UC3 (BGR), refilled, same size.
/// @param opacity of the end's colour; 0: outline only, what lies below keeps its colours.
void drawOverlay(const cv::Mat& left, const cv::Mat& covered, const StereoGeometry& geometry, const Box& box_C,
                 const Verdict& verdict, const RangeEstimate& range, cv::Mat& out, double opacity = 0.35);

/// One line at the lower edge of a picture, CV_8UC3.
void writeCaption(const std::string& text, cv::Mat& image);

/// Depth as colours, near red to far blue, nothing black.  @param depth_m CV_32FC1.  @param out CV_8UC3 (BGR).
void drawDepth(const cv::Mat& depth_m, double max_depth_m, cv::Mat& out);

/// The map from above, the corridor's box in it, seen in the box's frame: forward is up.
/// Occupied cells dark, free light, unknown grey, of the layer that the box spans.
/// @param out CV_8UC3 (BGR) of size_px, refilled.
void drawMapFromAbove(const octomap::OcTree& tree, const Box& box, const Verdict& verdict, double ahead_m,
                      cv::Size size_px, cv::Mat& out);

/// Verdicts over time, the first at the left, each in its state's colour; later frames are black.
/// @param total  frames of the whole recording.  @param out CV_8UC3 (BGR) of size_px, refilled.
void drawVerdicts(const std::vector<State>& verdicts, std::size_t total, cv::Size size_px, cv::Mat& out);

/// BGR of a state: green free, red blocked, amber unknown.
cv::Scalar colour(State state);

}  // namespace flight_corridor
