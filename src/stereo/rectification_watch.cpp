#include "flight_corridor/stereo/rectification_watch.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace flight_corridor {

namespace {

constexpr int kPartsAcross = 3, kPartsDown = 2, kParts = kPartsAcross * kPartsDown;  // of the image
constexpr std::size_t kLooks = 3;                                                    // that are summed up
constexpr int kPairsBetween = 10;                                                    // of one look to the next
constexpr double kSignificant_sigmas = 4.0;                                          // sigmas
constexpr std::size_t kFewest = 8;                                                   // points of a part
constexpr int kFewestParts = 2;                                                      // that say the same
constexpr double kMatchSigma_px = 0.1;            // of all points of a part: what they have in common
constexpr double kMedianError = 1.2533 * 1.4826;  // of a median, per median absolute deviation, by Gaussian noise
constexpr double kFits = 0.5;                     // share of the difference that is left with the right partner
constexpr double kMostPoints = 0.75;              // of a look: the rest may be wrong, or stands in the same row anyhow
constexpr std::size_t kFewestOfLens = 30;         // points
constexpr double kOutliers = 0.05;                // share of the disparities, on either side
constexpr double kLeastSpread_px = 2.0;           // of disparities: over less a wrong match decides
constexpr int kIterations = 4;                    // of weighted least squares
constexpr double kResidual_px = 0.5;              // of a match
constexpr double kSame = 0.5;                     // share of the whole image's offset by which its parts may differ

bool isLate(RowFault fault) { return fault == RowFault::RightLate || fault == RowFault::LeftLate; }

double quantile(std::vector<float> values, double share) {
  if (values.empty()) return kNaN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Part {
  double offset_px, sigma_px;

  bool isHarmful() const {
    return std::abs(offset_px) >= kMostRowOffset_px && std::abs(offset_px) >= kSignificant_sigmas * sigma_px;
  }
};

/// Median and its error, by the median absolute deviation.
Part partOf(const std::vector<float>& differences_px) {
  const double median = quantile(differences_px, 0.5);
  std::vector<float> deviations(differences_px);
  for (float& value : deviations) value = std::abs(value - static_cast<float>(median));
  const double error = kMedianError * quantile(deviations, 0.5);
  return {median, std::hypot(error / std::sqrt(static_cast<double>(differences_px.size())), kMatchSigma_px)};
}

/// Differences of rows, of a part of the image, or of all of it (-1).
template <class Look>
std::vector<float> differencesOf(const Look& look, int part) {
  std::vector<float> differences_px;
  for (const auto& corner : look) {
    if (part < 0 || corner.part == part) differences_px.push_back(corner.down_px);
  }
  return differences_px;
}

/// A robust size of the differences of a look.
template <class Look>
double sizeOf(const Look& look) {
  std::vector<float> all = differencesOf(look, -1);
  if (all.size() < kFewest * kFewestParts) return kNaN;
  for (float& value : all) value = std::abs(value);
  return quantile(all, kMostPoints);
}

/// What a lens model that is wrong by r' = r (1 + k r^2 / 2) leaves between rows is k x y d; a turned camera leaves a
/// constant and x, y, x y. Least squares, weighted by residuals (Cauchy).
/// @return k and its sigma [-].
template <class Look>
std::pair<double, double> lensOf(const Look& look) {
  if (look.size() < kFewestOfLens) return {kNaN, kNaN};
  std::vector<float> disparities_px;
  for (const auto& corner : look) disparities_px.push_back(corner.disparity_px);
  const double least_px = quantile(disparities_px, kOutliers), most_px = quantile(disparities_px, 1.0 - kOutliers);
  if (!(most_px - least_px >= kLeastSpread_px)) return {kNaN, kNaN};
  using Terms = Eigen::Matrix<double, 5, 1>;
  Terms solution = Terms::Zero();
  Eigen::Matrix<double, 5, 5> information;
  double variance_px2 = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    information.setZero();
    Terms sum = Terms::Zero();
    double weights = 0.0, squares_px2 = 0.0;
    for (const auto& corner : look) {
      const double x = corner.x, y = corner.y;
      Terms terms;
      terms << 1.0, x, y, x * y, x * y * corner.disparity_px;
      const double residual_px = corner.down_px - terms.dot(solution);
      const double weight = 1.0 / (1.0 + std::pow(residual_px / kResidual_px, 2));
      information += weight * terms * terms.transpose();
      sum += weight * corner.down_px * terms;
      weights += weight;
      squares_px2 += weight * residual_px * residual_px;
    }
    solution = information.ldlt().solve(sum);
    variance_px2 = squares_px2 / weights;
  }
  const double variance = information.ldlt().solve(Terms::Unit(4))(4) * (variance_px2 + std::pow(kMatchSigma_px, 2));
  return {solution(4), std::sqrt(variance)};
}

}  // namespace

const RowAgreement& RectificationWatch::look(const StereoFrame& pair, const StereoFrame& before) {
  if (!isDue()) return agreement_;
  looks_.push_back(differences(pair.left, pair.right));
  if (looks_.size() > kLooks) looks_.pop_front();
  judge(pair, before);
  return agreement_;
}

bool RectificationWatch::isDue() {
  const bool is_due = ++pairs_since_ >= kPairsBetween || looks_.size() < kLooks || is_suspect_;
  if (is_due) pairs_since_ = 0;
  return is_due;
}

RectificationWatch::Look RectificationWatch::differences(const cv::Mat& left, const cv::Mat& right) {
  Look look;
  if (left.empty() || left.size() != right.size()) return look;
  for (const FreeMatch& match : matcher_.match(left, right)) {
    const int column = static_cast<int>(kPartsAcross * match.from_px.x / static_cast<float>(left.cols));
    const int row = static_cast<int>(kPartsDown * match.from_px.y / static_cast<float>(left.rows));
    const Eigen::Vector3f at = geometry_.point(match.from_px.x, match.from_px.y, 1.0).cast<float>();
    const double disparity_px = match.from_px.x - match.to_px.x - geometry_.principalPointDifference();
    look.push_back({at.x(), at.y(), static_cast<float>(disparity_px), match.to_px.y - match.from_px.y,
                    std::clamp(row, 0, kPartsDown - 1) * kPartsAcross + std::clamp(column, 0, kPartsAcross - 1)});
  }
  return look;
}

RectificationWatch::Summary RectificationWatch::summary(const Look& look) const {
  Summary summary;
  RowAgreement& rows = summary.rows;
  double lowest_px = kInfinity, highest_px = -kInfinity;
  for (int i = 0; i < kParts; ++i) {
    const std::vector<float> differences_px = differencesOf(look, i);
    if (differences_px.size() < kFewest) continue;
    const Part part = partOf(differences_px);
    ++summary.known;
    summary.harmful += part.isHarmful();
    lowest_px = std::min(lowest_px, part.offset_px);
    highest_px = std::max(highest_px, part.offset_px);
    if (std::abs(part.offset_px) <= std::abs(rows.offset_px)) continue;  // not NaN, of the first one
    rows.offset_px = part.offset_px;
    rows.sigma_px = part.sigma_px;
  }
  rows.points = static_cast<int>(look.size());
  rows.centre_px = quantile(differencesOf(look, -1), 0.5);
  summary.is_offset = highest_px - lowest_px < kSame * std::abs(rows.centre_px);
  const double side = 0.5 * geometry_.size().width / geometry_.calibration().fx_px;
  const auto [lens, sigma] = lensOf(look);
  rows.lens_error = 1.5 * lens * side * side;  // the derivative of r' along r
  rows.lens_sigma = 1.5 * sigma * side * side;
  summary.is_wrong_lens = std::abs(rows.lens_error) >= std::max(kMostLensError, kSignificant_sigmas * rows.lens_sigma);
  return summary;
}

void RectificationWatch::judge(const StereoFrame& pair, const StereoFrame& before) {
  Look all;
  for (const Look& look : looks_) all.insert(all.end(), look.begin(), look.end());
  const Summary summary = this->summary(all);
  const auto shows_fault = [this](const Look& look) {
    const Summary one = this->summary(look);
    return one.harmful > 0 || one.is_wrong_lens;
  };
  RowFault fault = agreement_.fault;
  if (summary.harmful >= kFewestParts || summary.is_wrong_lens) {
    fault = lateImage(pair, before);
    if (fault == RowFault::None) fault = summary.likeliest();
  } else if (summary.known >= kFewestParts && std::none_of(looks_.begin(), looks_.end(), shows_fault) &&
             !mayStillBeLate(pair, before)) {
    fault = RowFault::None;
  }
  is_suspect_ = summary.harmful > 0 || fault != RowFault::None || shows_fault(looks_.back());
  agreement_ = summary.rows;
  agreement_.fault = fault;
}

/// Which image fits its partner of the pair before better than that of its own.
RowFault RectificationWatch::lateImage(const StereoFrame& pair, const StereoFrame& before) {
  const double now_px = sizeOf(looks_.back());
  if (!(now_px >= kMostRowOffset_px)) return isLate(agreement_.fault) ? agreement_.fault : RowFault::None;
  if (sizeOf(differences(before.left, pair.right)) <= kFits * now_px) return RowFault::RightLate;
  if (sizeOf(differences(pair.left, before.right)) <= kFits * now_px) return RowFault::LeftLate;
  return RowFault::None;
}

/// Rows agree also while nothing moves: an image that was late is not until it fits its own partner better.
bool RectificationWatch::mayStillBeLate(const StereoFrame& pair, const StereoFrame& before) {
  const RowFault fault = agreement_.fault;
  if (!isLate(fault)) return false;
  const bool is_right = fault == RowFault::RightLate;
  const double then_px = sizeOf(is_right ? differences(before.left, pair.right) : differences(pair.left, before.right));
  return !(then_px >= kMostRowOffset_px && sizeOf(looks_.back()) <= kFits * then_px);
}

}  // namespace flight_corridor
