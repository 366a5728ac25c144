#include "tools/pictures.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <system_error>

#include "flight_corridor/view/evidence.hpp"
#include "flight_corridor/view/fill.hpp"
#include "flight_corridor/view/overlay.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kVideoHeight_px = 480;  // of the overlay
constexpr int kLineHeight_px = 24;    // of the line of verdicts

void makeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw std::runtime_error(path.string() + ": folder cannot be made: " + error.message());
}

std::string numbered(std::size_t index) {
  std::array<char, 24> text;
  std::snprintf(text.data(), text.size(), "%06zu", index);
  return text.data();
}

void writeImage(const fs::path& path, const cv::Mat& image) {
  if (!cv::imwrite(path.string(), image)) throw std::runtime_error(path.string() + ": cannot be written");
}

/// NaN, and values beyond 16 bits, become 0.
void toMillimetres(const cv::Mat& depth_m, cv::Mat& depth_mm) {
  depth_mm.create(depth_m.size(), CV_16UC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    const float* in = depth_m.ptr<float>(v);
    auto* out = depth_mm.ptr<std::uint16_t>(v);
    for (int u = 0; u < depth_m.cols; ++u) {
      const float mm = in[u] * 1000.0f + 0.5f;
      out[u] = 1.0f <= mm && mm < 65536.0f ? static_cast<std::uint16_t>(mm) : 0;
    }
  }
}

std::string depthCaption(double ahead_m) { return cv::format("depth, filled: red near, blue %.0f m", ahead_m); }
std::string mapCaption(double ahead_m) { return cv::format("map, %.0f m: dark occupied, white free", ahead_m); }

/// Scaled to a height; of a width whose half is even.
cv::Mat scaledTo(int height_px, const cv::Mat& picture) {
  cv::Mat scaled;
  const int width_px = picture.cols * height_px / picture.rows / 4 * 4;
  cv::resize(picture, scaled, cv::Size(width_px, height_px), 0.0, 0.0, cv::INTER_AREA);
  return scaled;
}

}  // namespace

void addToVideo(const cv::Mat& picture, const std::string& path, double rate_hz, cv::VideoWriter& video) {
  if (!video.isOpened()) {
    video.open(path, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_hz, picture.size());
  }
  if (!video.isOpened()) throw std::runtime_error(path + ": cannot be written as AVI");
  video.write(picture);
}

Pictures::Pictures(const PictureOptions& options) : options_(options) {
  if (!options.overlay_folder.empty()) makeFolder(options.overlay_folder);
  if (!options.evidence_folder.empty()) makeFolder(options.evidence_folder);
  if (options.depth_folder.empty()) return;
  makeFolder(fs::path(options.depth_folder) / "matched");
  makeFolder(fs::path(options.depth_folder) / "filled");
}

bool Pictures::isShown(std::size_t index, State state) const {
  return last_state_ != state || (options_.every > 0 && index % options_.every == 0);
}

void Pictures::add(std::size_t index, const cv::Mat& left, const Pipeline& pipeline, const Report& report) {
  const State state = report.verdict.state;
  const bool is_shown = isShown(index, state), wants_overlay = is_shown && !options_.overlay_folder.empty();
  if (wants_overlay || !options_.video.empty()) {
    drawOverlay(left, pipeline.covered(), pipeline.geometry(), pipeline.boxInCamera(), report.verdict, report.range,
                overlay_);
  }
  if (wants_overlay) writeOverlay(index, pipeline, report);
  if (is_shown && !options_.evidence_folder.empty()) writeEvidence(index, pipeline, report);
  if (!options_.depth_folder.empty()) {
    toMillimetres(pipeline.depth(), depth_mm_);
    writeImage(fs::path(options_.depth_folder) / "matched" / (numbered(index) + ".png"), depth_mm_);
    toMillimetres(filledDepth(pipeline), depth_mm_);
    writeImage(fs::path(options_.depth_folder) / "filled" / (numbered(index) + ".png"), depth_mm_);
  }
  if (!options_.video.empty()) {
    verdicts_.resize(index, State::Unknown);
    verdicts_.push_back(state);
    writeVideoFrame(pipeline, report);
  }
  last_state_ = state;
}

/// What it takes to see why a frame got its verdict: verdict and box, evidence (white: what is matched behind the box,
/// but fits in it as well), evidence and fill, cells.
void Pictures::writeOverlay(std::size_t index, const Pipeline& pipeline, const Report& report) {
  const double ahead_m = pipeline.config().map.max_range_m;
  drawDepth(pipeline.depth(), ahead_m, matched_);
  matched_.setTo(cv::Scalar::all(255), pipeline.doubtful());
  drawDepth(filledDepth(pipeline), ahead_m, depth_);
  drawMapFromAbove(pipeline.map().tree(), pipeline.box(), report.verdict, ahead_m, overlay_.size(), map_);
  writeCaption("depth of the matches; white: they also fit in the box", matched_);
  writeCaption(depthCaption(ahead_m), depth_);
  writeCaption(mapCaption(ahead_m), map_);
  cv::Mat lower;
  cv::hconcat(overlay_, matched_, panels_);
  cv::hconcat(depth_, map_, lower);
  cv::vconcat(panels_, lower, panels_);
  const std::string name = numbered(index) + "_" + toString(report.verdict.state) + ".png";
  writeImage(fs::path(options_.overlay_folder) / name, panels_);
}

void Pictures::writeEvidence(std::size_t index, const Pipeline& pipeline, const Report& report) {
  const cv::Mat evidence = evidenceOf(pipeline);
  if (evidence.empty()) return;
  cv::Mat coloured;
  drawEvidence(pipeline.left(), evidence, coloured);
  drawOverlay(coloured, pipeline.covered(), pipeline.geometry(), pipeline.boxInCamera(), report.verdict, report.range,
              evidence_, 0.0);
  addLegend(evidence_);
  const std::string name = numbered(index) + "_" + toString(report.verdict.state) + ".png";
  writeImage(fs::path(options_.evidence_folder) / name, evidence_);
}

/// The overlay, beside it depth above the map, the line of verdicts below.
void Pictures::writeVideoFrame(const Pipeline& pipeline, const Report& report) {
  const double ahead_m = pipeline.config().map.max_range_m;
  const cv::Mat overlay = scaledTo(kVideoHeight_px, overlay_);
  const cv::Size quarter_px(overlay.cols / 2, kVideoHeight_px / 2);
  drawDepth(filledDepth(pipeline), ahead_m, depth_);
  cv::resize(depth_, depth_, quarter_px, 0.0, 0.0, cv::INTER_AREA);
  drawMapFromAbove(pipeline.map().tree(), pipeline.box(), report.verdict, ahead_m, quarter_px, map_);
  writeCaption(depthCaption(ahead_m), depth_);
  writeCaption(mapCaption(ahead_m), map_);
  cv::vconcat(depth_, map_, panels_);
  cv::hconcat(overlay, panels_, panels_);
  drawVerdicts(verdicts_, options_.video_frames, cv::Size(panels_.cols, kLineHeight_px), line_);
  cv::vconcat(panels_, line_, panels_);
  addToVideo(panels_, options_.video, options_.video_rate_hz, video_);
}

}  // namespace flight_corridor::tools
