#pragma once

#include <opencv2/core/mat.hpp>

#include "flight_corridor/stereo/disparity_evidence.hpp"
#include "flight_corridor/stereo/semi_global_matcher.hpp"

namespace flight_corridor::test_support {

/// What matches say where nothing else fits: all of one disparity, NaN = nothing is matched.
inline DisparityEvidence uniformEvidence(cv::Size size, double best_px) {
  const auto map = [&](double value) { return cv::Mat(size, CV_32FC1, cv::Scalar(value)); };
  DisparityEvidence evidence;
  evidence.best_px = map(best_px);
  evidence.repeated_px = map(kNaN);
  evidence.flags = cv::Mat(size, CV_8UC1, cv::Scalar(kConsistent | kDistinct));
  evidence.set = cv::Mat::zeros(size, CV_8UC(16));
  evidence.competitor_farthest = cv::Mat::zeros(size, CV_8UC1);
  evidence.competitor_nearest = cv::Mat::zeros(size, CV_8UC1);
  return evidence;
}

inline cv::Mat texturedAllOver(cv::Size size) { return cv::Mat(size, CV_8UC1, cv::Scalar(255)); }

}  // namespace flight_corridor::test_support
