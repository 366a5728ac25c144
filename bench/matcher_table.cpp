// The semi-global matcher beside OpenCV's: time of a VGA pair with 128 disparities by instruction set and threads, and
// quality on Middlebury stills and simulated frames with dense truth.  matcher_table [DATA_FOLDER] [REPEATS]
// clang-format off
#include "stereo/targets.hpp"  // before Highway
// clang-format on

#include <hwy/targets.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "flight_corridor/stereo/disparity_bits.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "flight_corridor/stereo/search_range.hpp"
#include "true_stills.hpp"

namespace {

using namespace flight_corridor;
using bench::TrueStill;
using Clock = std::chrono::steady_clock;

const int kDisparities = StereoConfig().num_disparities_px;

/// OpenCV's matcher; it skips columns that cannot see its whole search range: padding brings them back.
class OpenCvMatcher {
 public:
  explicit OpenCvMatcher(double difference_px)
      : difference_px_(difference_px),
        smallest_px_(static_cast<int>(std::floor(difference_px)) - 2),
        pad_left_px_(std::max(0, smallest_px_ + kDisparities + (smallest_px_ & 1))),
        pad_right_px_(std::max(0, -smallest_px_ + (smallest_px_ & 1))),
        matcher_(cv::StereoSGBM::create(smallest_px_, kDisparities, 3, 4 * 9, 12 * 9, 1, 0, 10, 0, 0,
                                        cv::StereoSGBM::MODE_SGBM_3WAY)) {}

  void match(const StereoFrame& frame, cv::Mat& fixed) {
    cv::copyMakeBorder(frame.left, left_, 0, 0, pad_left_px_, pad_right_px_, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(frame.right, right_, 0, 0, pad_left_px_, pad_right_px_, cv::BORDER_REPLICATE);
    matcher_->compute(left_, right_, fixed_);
    fixed = fixed_.colRange(pad_left_px_, pad_left_px_ + frame.left.cols);
  }

  cv::Mat disparity(const StereoFrame& frame) {
    cv::Mat fixed, disparity_px;
    match(frame, fixed);
    fixed.convertTo(disparity_px, CV_32F, 1.0 / 16.0, -difference_px_);
    disparity_px.setTo(kNaN, fixed < smallest_px_ * 16);
    return disparity_px;
  }

 private:
  double difference_px_;
  int smallest_px_, pad_left_px_, pad_right_px_;
  cv::Ptr<cv::StereoSGBM> matcher_;
  cv::Mat left_, right_, fixed_;
};

struct Milliseconds {
  double wall = 0.0, processor = 0.0;  // medians
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

template <class Function>
Milliseconds medianTime(int repeats, Function&& function) {
  const auto processorNow = [] {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
  };
  function();
  std::vector<double> wall, processor;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = Clock::now();
    const double processor_begin = processorNow();
    function();
    wall.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    processor.push_back(processorNow() - processor_begin);
  }
  return {median(wall), median(processor)};
}

void printTime(const char* name, int threads, const Milliseconds& time) {
  std::printf("%-28s %8d %10.1f %10.1f\n", name, threads, time.wall, time.processor);
}

void printTimes(StereoFrame frame, int repeats) {
  cv::resize(frame.left, frame.left, {640, 480});
  cv::resize(frame.right, frame.right, {640, 480});
  const StereoGeometry geometry({{640, 480}, 400.0, 400.0, 320.0, 240.0, 320.0, 0.12});
  std::printf("%-28s %8s %10s %10s\n", "640 x 480, 128 disparities", "threads", "wall ms", "CPU ms");
  for (const int threads : {1, 2}) {
    cv::setNumThreads(threads);
    DisparityEstimator matcher(StereoConfig(), geometry, 0.0);
    DisparityEvidence evidence;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      if (target == HWY_EMU128 || target == HWY_SCALAR) continue;  // a second or more
      hwy::SetSupportedTargetsForTest(target);
      printTime(hwy::TargetName(target), threads, medianTime(repeats, [&] { matcher.match(frame, evidence); }));
    }
    hwy::SetSupportedTargetsForTest(0);
    OpenCvMatcher opencv(0.0);
    cv::Mat fixed;
    printTime("OpenCV 3WAY, padded", threads, medianTime(repeats, [&] { opencv.match(frame, fixed); }));
  }
}

/// Shares of pixels that are visible in both views and have a truth, and of the matched ones among them.
struct Quality {
  double pixels = 0, matched = 0, bad_1 = 0, bad_2 = 0, within_1 = 0, squares = 0, bias = 0;
  double covered = 0, wrong_narrow = 0, narrow = 0, competitor = 0;

  void add(double error_px) {
    matched += 1;
    bad_1 += std::abs(error_px) > 1.0;
    bad_2 += std::abs(error_px) > 2.0;
    if (std::abs(error_px) < 1.0) {
      within_1 += 1;
      squares += error_px * error_px;
      bias += error_px;
    }
  }

  void print(const std::string& name, bool bounds) const {
    std::printf("%-24s %8.1f %8.2f %8.2f %8.3f %8.3f", name.c_str(), 100 * matched / pixels, 100 * bad_1 / matched,
                100 * bad_2 / matched, std::sqrt(squares / within_1), bias / within_1);
    if (bounds) {
      std::printf(" %8.1f %8.1f %8.1f %10.1f", 100 * covered / pixels, 100 * narrow / pixels,
                  100 * wrong_narrow / narrow, 100 * competitor / pixels);
    }
    std::printf("\n");
  }
};

void addMatches(const TrueStill& still, const cv::Mat& disparity_px, Quality& quality) {
  for (int v = 0; v < disparity_px.rows; ++v) {
    for (int u = 0; u < disparity_px.cols; ++u) {
      const float truth_px = still.truth_px.at<float>(v, u), found_px = disparity_px.at<float>(v, u);
      if (still.visible.at<std::uint8_t>(v, u) != 255 || !std::isfinite(truth_px)) continue;
      quality.pixels += 1;
      if (std::isfinite(found_px)) quality.add(found_px - truth_px);
    }
  }
}

void addBounds(const TrueStill& still, const DisparityEvidence& evidence, Quality& quality) {
  constexpr double kSlack_px = 1.0;  // half a pixel of rounding, half a pixel of noise
  const int words = evidence.set.channels() / 8;
  const double first_px = firstDisparity(StereoGeometry(still.calibration));
  for (int v = 0; v < evidence.flags.rows; ++v) {
    for (int u = 0; u < evidence.flags.cols; ++u) {
      const float truth_px = still.truth_px.at<float>(v, u);
      if (still.visible.at<std::uint8_t>(v, u) != 255 || !std::isfinite(truth_px)) continue;
      const auto* set = reinterpret_cast<const std::uint64_t*>(evidence.set.ptr(v, u));
      const int farthest = firstBit(set, words), nearest = lastBit(set, words);
      const bool covered = first_px + farthest - kSlack_px <= truth_px && truth_px <= first_px + nearest + kSlack_px;
      const bool narrow = nearest - farthest <= 4;
      quality.covered += covered;
      quality.narrow += narrow;
      quality.wrong_narrow += narrow && !covered;
      quality.competitor += (evidence.flags.at<std::uint8_t>(v, u) & kCompetitor) != 0;
    }
  }
}

void printQuality(const std::vector<TrueStill>& stills) {
  std::printf("\n%-24s %8s %8s %8s %8s %8s %8s %8s %8s %10s\n", "", "matched", "bad-1", "bad-2", "rms", "bias",
              "covered", "narrow", "wrong", "competitor");
  Quality own_all, other_all;
  for (const TrueStill& still : stills) {
    const StereoGeometry geometry(still.calibration);
    DisparityEstimator matcher(StereoConfig(), geometry, 0.0);
    DisparityEvidence evidence;
    matcher.match(still.frame, evidence);
    const cv::Mat opencv_px = OpenCvMatcher(geometry.principalPointDifference()).disparity(still.frame);
    Quality own;
    for (Quality* quality : {&own, &own_all}) {
      addMatches(still, evidence.best_px, *quality);
      addBounds(still, evidence, *quality);
    }
    own.print(still.name, true);
    addMatches(still, opencv_px, other_all);
  }
  own_all.print("all", true);
  other_all.print("OpenCV 3WAY, all", false);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string data = argc > 1 ? argv[1] : "../shared/data/middlebury_v3_quarter";
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 50;
  const std::vector<TrueStill> stills = bench::readStills(data), simulated = bench::simulatedStills();
  printTimes(stills.empty() ? simulated.front().frame : stills.front().frame, repeats);
  std::printf(
      "\n%% of pixels visible in both views; bad: of the matched ones; rms, bias [px] of errors below 1 px;\n"
      "covered: truth within a pixel of the set's bounds; narrow: disparities not contradicted not farther apart than "
      "4 px; "
      "wrong: of those\n");
  if (stills.empty()) std::printf("no stills in %s\n", data.c_str());
  if (!stills.empty()) printQuality(stills);
  printQuality(simulated);
  return 0;
}
