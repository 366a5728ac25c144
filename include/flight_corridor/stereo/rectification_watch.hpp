#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/stereo/free_matcher.hpp"
#include "flight_corridor/types.hpp"

namespace flight_corridor {

/// So far apart, half of the census window's three rows show something else: matches are lost, or wrong.
constexpr double kMostRowOffset_px = 1.5;
/// Of depth at the image's side: twice what good rigs show, half of what a fisheye without a model leaves.
constexpr double kMostLensError = 0.4;

/// What rows that disagree look like.
enum class RowFault : std::uint8_t {
  None,
  Offset,     ///< The right image is too low or too high as a whole: a bent mount.
  Warp,       ///< By different amounts in different places: a rolled or turned camera, or a wrong lens model.
  Lens,       ///< More where disparity is larger, towards the corners: a wrong lens model.
  RightLate,  ///< The right image fits the left one of the pair before.
  LeftLate,   ///< The left image fits the right one of the pair before.
};

/// Whether a point stands in the same row of both images, by the newest pairs that were looked at.
struct RowAgreement {
  RowFault fault = RowFault::None;
  double offset_px = kNaN;   ///< Median of row in the right less row in the left image where it is largest.
  double sigma_px = kNaN;    ///< Its error.
  double centre_px = kNaN;   ///< Median over the whole image.
  double lens_error = kNaN;  ///< Of depth at the image's side, relative, by a wrong lens model [-].
  double lens_sigma = kNaN;
  int points = 0;  ///< That were found in both images.
};

/// Watches whether rows agree, as they do in a pair that is rectified rightly and exposed at one time. Corners are
/// matched without the epipolar constraint; medians over parts of the image are held against their sigma. Without
/// evidence it says nothing new. One object, one thread.
class RectificationWatch {
 public:
  explicit RectificationWatch(const StereoGeometry& geometry) : geometry_(geometry) {}

  /// Looks at a pair if it is time to: at the first ones, every tenth, and all while something is wrong.
  /// @param before the pair before; its images may be empty.
  const RowAgreement& look(const StereoFrame& pair, const StereoFrame& before);

  const RowAgreement& agreement() const { return agreement_; }

 private:
  /// A corner of the left image, at a depth of 1, and what the right image shows.
  struct Corner {
    float x, y, disparity_px;
    float down_px;  // row in the right less row in the left image
    int part;       // of the image
  };
  using Look = std::vector<Corner>;

  struct Summary {
    RowAgreement rows;           // without its fault
    int known = 0, harmful = 0;  // parts
    bool is_wrong_lens = false;
    bool is_offset = false;  // all parts are off alike

    RowFault likeliest() const {
      return known > 1 && harmful == known && is_offset ? RowFault::Offset
             : is_wrong_lens                            ? RowFault::Lens
                                                        : RowFault::Warp;
    }
  };

  bool isDue();
  Look differences(const cv::Mat& left, const cv::Mat& right);
  Summary summary(const Look& look) const;
  void judge(const StereoFrame& pair, const StereoFrame& before);
  RowFault lateImage(const StereoFrame& pair, const StereoFrame& before);
  bool mayStillBeLate(const StereoFrame& pair, const StereoFrame& before);

  StereoGeometry geometry_;
  FreeMatcher matcher_;
  std::deque<Look> looks_;
  int pairs_since_ = 0;      // the last look
  bool is_suspect_ = false;  // more looks are needed
  RowAgreement agreement_;
};

}  // namespace flight_corridor
