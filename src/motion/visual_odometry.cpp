#include "flight_corridor/motion/visual_odometry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace flight_corridor {

namespace {

constexpr int kHalf = 2;             // images are tracked at half their size
constexpr int kLevels = 3;           // of the pyramid above it
constexpr int kCell_px = 16;         // one corner in a square of this size, of the half-sized image
constexpr int kCornerContrast = 10;  // grey: of FAST
const cv::Size kWindow_px(13, 13);
constexpr float kHome_px = 0.5f;            // a corner that is tracked back comes home to this, half-sized
constexpr double kReprojection_px = 1.0;    // of a corner that agrees with a motion
constexpr int kLeastInliers = 20;           // corners that agree
constexpr double kLeastShare = 0.5;         // of the corners that were found again
constexpr double kAnotherSurface_px = 1.0;  // a match that differs by more is of another surface
constexpr int kSteps = 4;                   // of least squares
constexpr double kAlike = 3.0;   // errors of corners are alike: their mean is less certain than were they independent
constexpr double kOfWay = 0.01;  // of the way from the key image: bias of the disparities
constexpr double kTracking_px = 0.3;  // one sigma of a corner's place, at least
constexpr double kDepth_px = 0.3;     // one sigma of a corner's disparity

cv::Point2f halved(const Eigen::Vector2d& px) {
  const Eigen::Vector2f half = ((px.array() + 0.5) / kHalf - 0.5).cast<float>();
  return {half.x(), half.y()};
}

Eigen::Vector2d doubled(const cv::Point2f& half_px) {
  return (Eigen::Array2d(half_px.x, half_px.y) + 0.5) * kHalf - 0.5;
}

/// Corrected disparity of the pixel at a place on the image; NaN without a match.
double matchAt(const cv::Mat& disparity_px, const ScaleCorrection& correction, const Eigen::Vector2d& at_px) {
  return correction.correct(
      disparity_px.at<float>(static_cast<int>(std::lround(at_px.y())), static_cast<int>(std::lround(at_px.x()))));
}

}  // namespace

std::optional<RelativePose> VisualOdometry::track(const cv::Mat& left, const cv::Mat& disparity_px,
                                                  const ScaleCorrection& correction,
                                                  const std::optional<Eigen::Isometry3d>& guess) {
  cv::Mat half;
  cv::resize(left, half, left.size() / kHalf, 0.0, 0.0, cv::INTER_AREA);
  cv::buildOpticalFlowPyramid(half, pyramid_, kWindow_px, kLevels);
  tracked_.clear();
  const Eigen::Isometry3d guess_C_K = guess.value_or(last_K_C_ * step_).inverse();
  if (corners_.empty() || !follow(disparity_px, correction, guess_C_K)) return std::nullopt;
  auto T_C_K = agree();
  if (!T_C_K) return std::nullopt;
  const Normal covariance = refine(*T_C_K).inverse();
  const auto worst = [](const Eigen::Matrix3d& part) {
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(part).eigenvalues().maxCoeff());
  };
  RelativePose pose{T_C_K->inverse()};
  pose.sigma_m = std::hypot(kAlike * worst(covariance.topLeftCorner<3, 3>()), kOfWay * T_C_K->translation().norm());
  pose.sigma_rad = kAlike * worst(covariance.bottomRightCorner<3, 3>());
  if (!pose.T_K_C.matrix().allFinite() || !std::isfinite(pose.sigma_m + pose.sigma_rad)) return std::nullopt;
  step_ = last_K_C_.inverse() * pose.T_K_C;
  last_K_C_ = pose.T_K_C;
  return pose;
}

/// @return whether enough corners were found again.
bool VisualOdometry::follow(const cv::Mat& disparity_px, const ScaleCorrection& correction,
                            const Eigen::Isometry3d& guess_C_K) {
  seen_.clear();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d at_px = geometry_.project(guess_C_K * points_K_[i]);
    seen_.push_back(geometry_.contains(at_px) ? halved(at_px) : corners_[i]);
  }
  back_ = corners_;
  std::vector<std::uint8_t> is_found, is_back;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 15, 0.02);
  cv::calcOpticalFlowPyrLK(key_pyramid_, pyramid_, corners_, seen_, is_found, cv::noArray(), kWindow_px, kLevels, until,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(pyramid_, key_pyramid_, seen_, back_, is_back, cv::noArray(), kWindow_px, 1, until,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const cv::Point2f off = back_[i] - corners_[i];
    if (!is_found[i] || !is_back[i] || !(std::hypot(off.x, off.y) <= kHome_px)) continue;
    const Eigen::Vector2d at_px = doubled(seen_[i]);
    if (!geometry_.contains(at_px)) continue;
    const double d_px = geometry_.disparity(points_K_[i].z());
    tracked_.push_back(
        {points_K_[i], kDepth_px / d_px, {at_px.x(), at_px.y(), matchAt(disparity_px, correction, at_px)}});
  }
  return static_cast<int>(tracked_.size()) >= kLeastInliers;
}

/// Leaves the corners that agree with one motion in tracked_.
std::optional<Eigen::Isometry3d> VisualOdometry::agree() {
  std::vector<cv::Point3d> points_K;
  std::vector<cv::Point2d> seen_px;
  for (const Corner& corner : tracked_) {
    points_K.emplace_back(corner.p_K.x(), corner.p_K.y(), corner.p_K.z());
    seen_px.emplace_back(corner.seen_px.x(), corner.seen_px.y());
  }
  cv::Mat camera;
  cv::eigen2cv(geometry_.cameraMatrix(), camera);
  cv::Mat rotation, translation, matrix;
  std::vector<int> agreeing;
  cv::setRNGSeed(1);  // the same images give the same answer
  if (!cv::solvePnPRansac(points_K, seen_px, camera, cv::noArray(), rotation, translation, false, 100,
                          static_cast<float>(kReprojection_px), 0.999, agreeing, cv::SOLVEPNP_AP3P)) {
    return std::nullopt;
  }
  const auto inliers = static_cast<int>(agreeing.size());
  if (inliers < kLeastInliers || inliers < kLeastShare * static_cast<double>(tracked_.size())) return std::nullopt;
  for (int i = 0; i < inliers; ++i) tracked_[i] = tracked_[agreeing[i]];
  tracked_.resize(agreeing.size());
  Eigen::Matrix3d R_C_K;
  Eigen::Vector3d t_C_K;
  cv::Rodrigues(rotation, matrix);
  cv::cv2eigen(matrix, R_C_K);
  cv::cv2eigen(translation, t_C_K);
  Eigen::Isometry3d T_C_K = Eigen::Isometry3d::Identity();
  T_C_K.linear() = R_C_K;
  T_C_K.translation() = t_C_K;
  return T_C_K;
}

/// Gauss-Newton on u, v and disparity, each corner weighted by the inverse of its covariance: that of its measurement,
/// and what the error of its depth in the key image moves it.
/// @return the inverse of the pose's covariance: translation, then rotation.
VisualOdometry::Normal VisualOdometry::refine(Eigen::Isometry3d& T_C_K) const {
  const StereoCalibration& rig = geometry_.calibration();
  const auto measure = [&](const Eigen::Vector3d& p_C) {
    const Eigen::Vector2d at_px = geometry_.project(p_C);
    return Eigen::Vector3d(at_px.x(), at_px.y(), geometry_.disparity(p_C.z()));
  };
  Normal normal = Normal::Zero();
  for (int iteration = 0; iteration < kSteps; ++iteration) {
    normal.setZero();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Corner& corner : tracked_) {
      const Eigen::Vector3d p_C = T_C_K * corner.p_K;
      const Eigen::Vector3d expected_px = measure(p_C);
      const Eigen::Vector3d moved_px = measure(T_C_K * (corner.p_K * (1.0 + corner.depth_error))) - expected_px;
      Eigen::Vector3d off_px = corner.seen_px - expected_px;
      Eigen::Matrix3d covariance = moved_px * moved_px.transpose();
      covariance.diagonal() +=
          Eigen::Vector3d(kTracking_px * kTracking_px, kTracking_px * kTracking_px, kDepth_px * kDepth_px);
      const bool is_matched = std::abs(off_px.z()) <= kAnotherSurface_px;  // else NaN, or of another surface
      if (!is_matched) {
        off_px.z() = 0.0;
        covariance.row(2).setZero();
        covariance.col(2).setZero();
        covariance(2, 2) = 1.0;
      }
      const double z = p_C.z(), per_m = 1.0 / z;
      Eigen::Matrix<double, 3, 6> J;
      Eigen::Matrix3d of_point;
      of_point << rig.fx_px * per_m, 0.0, -rig.fx_px * p_C.x() * per_m * per_m, 0.0, rig.fy_px * per_m,
          -rig.fy_px * p_C.y() * per_m * per_m, 0.0, 0.0, is_matched ? -expected_px.z() * per_m : 0.0;
      Eigen::Matrix3d cross;
      cross << 0.0, -p_C.z(), p_C.y(), p_C.z(), 0.0, -p_C.x(), -p_C.y(), p_C.x(), 0.0;
      J << of_point, -of_point * cross;
      const Eigen::Matrix3d information = covariance.inverse();
      normal += J.transpose() * information * J;
      gradient += J.transpose() * information * off_px;
    }
    const Eigen::Matrix<double, 6, 1> step = normal.ldlt().solve(gradient);
    const double angle_rad = step.tail<3>().norm();
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    if (angle_rad > 0.0) moved.linear() = Eigen::AngleAxisd(angle_rad, step.tail<3>() / angle_rad).toRotationMatrix();
    moved.translation() = step.head<3>();
    T_C_K = moved * T_C_K;
  }
  return normal;
}

bool VisualOdometry::hasKey() const { return static_cast<int>(corners_.size()) >= kLeastInliers; }

void VisualOdometry::setKey(const cv::Mat& disparity_px, const ScaleCorrection& correction) {
  std::swap(key_pyramid_, pyramid_);
  const cv::Mat& half = key_pyramid_.front();
  std::vector<cv::KeyPoint> found;
  cv::FAST(half, found, kCornerContrast);
  const int columns = half.cols / kCell_px + 1, rows = half.rows / kCell_px + 1;
  std::vector<const cv::KeyPoint*> best(static_cast<std::size_t>(columns * rows), nullptr);
  const auto disparityAt = [&](const cv::KeyPoint& corner) {
    const Eigen::Vector2d at_px = doubled(corner.pt);
    return geometry_.contains(at_px) ? matchAt(disparity_px, correction, at_px) : kNaN;
  };
  for (const cv::KeyPoint& corner : found) {
    if (!(disparityAt(corner) > 0.0)) continue;
    const cv::KeyPoint*& one =
        best[static_cast<int>(corner.pt.y) / kCell_px * columns + static_cast<int>(corner.pt.x) / kCell_px];
    if (!one || corner.response > one->response) one = &corner;
  }
  corners_.clear();
  points_K_.clear();
  for (const cv::KeyPoint* corner : best) {
    if (!corner) continue;
    corners_.push_back(corner->pt);
    const Eigen::Vector2d at_px = doubled(corner->pt);
    points_K_.push_back(geometry_.point(at_px.x(), at_px.y(), geometry_.depth(disparityAt(*corner))));
  }
  last_K_C_ = Eigen::Isometry3d::Identity();
}

}  // namespace flight_corridor
