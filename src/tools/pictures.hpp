#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor::tools {

/// Outputs for each processed frame; "" = none.
struct PictureOptions {
  std::string overlay_folder;   ///< NNNNNN_STATE.png at each change of verdict: overlay, matched depth (white: texture
                                ///< that lacks a match), filled depth, map.
  std::string evidence_folder;  ///< The same, of the evidence in colours below the overlay: drawEvidence().
  int every = 0;                ///< ... and at every so many frames; 0: changes only.
  std::string depth_folder;     ///< matched/NNNNNN.png and filled/NNNNNN.png: corrected depth, uint16 mm, 0 = nothing.
  std::string video;            ///< AVI (motion JPEG): overlay, depth, the map from above, and the verdicts so far.
  double video_rate_hz = 10.0;
  std::size_t video_frames = 1;  ///< Of the whole recording: the length of the line of verdicts.
};

/// Adds a picture to an AVI (motion JPEG), which the first one opens.
/// @throws std::runtime_error naming the file when it cannot be written.
void addToVideo(const cv::Mat& picture, const std::string& path, double rate_hz, cv::VideoWriter& video);

/// Draws what the pipeline saw into files.
class Pictures {
 public:
  /// Makes the folders.  @throws std::runtime_error naming the one that cannot be made.
  explicit Pictures(const PictureOptions& options);

  /// @param index number of the frame in the recording, from 0.
  /// @param left  CV_8UC1 or CV_8UC3 (BGR), the frame that the pipeline has just processed.
  /// @throws std::runtime_error naming the file that cannot be written.
  void add(std::size_t index, const cv::Mat& left, const Pipeline& pipeline, const Report& report);

 private:
  bool isShown(std::size_t index, State state) const;
  void writeOverlay(std::size_t index, const Pipeline& pipeline, const Report& report);
  void writeEvidence(std::size_t index, const Pipeline& pipeline, const Report& report);
  void writeVideoFrame(const Pipeline& pipeline, const Report& report);

  PictureOptions options_;
  std::optional<State> last_state_;
  std::vector<State> verdicts_;  // for the video: of every frame, Unknown without a verdict
  cv::VideoWriter video_;
  cv::Mat overlay_, evidence_, matched_, depth_, map_, line_, depth_mm_, panels_;
};

}  // namespace flight_corridor::tools
