#include "ros/processor.hpp"

#include <ros/console.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "ros/conversions.hpp"
#include "ros/image_scale.hpp"

namespace flight_corridor_ros {

namespace {

constexpr std::uint32_t kRefused =
    flight_corridor::kNoData | flight_corridor::kNoPose | flight_corridor::kBadImage | flight_corridor::kBadCalibration;

constexpr double kUseless_s = 1.0;  // a LiDAR without a useful reading for this long gets a warning
constexpr int kBlack = 4;           // of 255; noise of a covered lens
constexpr double kMuchBlack = 0.2;  // share of an image that gets a warning

/// Of an image or CameraInfo, for messages.
template <typename Message>
std::string sizeOf(const Message& message) {
  return std::to_string(message.width) + "x" + std::to_string(message.height);
}

/// Of rows that disagree, with the remedy.
const char* likelyCause(flight_corridor::RowFault fault) {
  using flight_corridor::RowFault;
  switch (fault) {
    case RowFault::Offset:
      return "The whole image is off alike: a camera that was knocked, or another rig's calibration. Calibrate the "
             "cameras together (camera_calibration)";
    case RowFault::Warp:
      return "It differs over the image: a camera that is rolled or turned, a wrong lens model, another rig's "
             "calibration, or images that were not exposed at one time. Calibrate the cameras together "
             "(camera_calibration), and synchronise them";
    case RowFault::Lens:
      return "A wrong lens model: a fisheye's coefficients as plumb_bob, or one that knows fewer of them. Rectify with "
             "the model of the lens";
    case RowFault::RightLate:
      return "The right image fits the left one of the pair before: the driver pairs its queues one off. Restart it, "
             "and synchronise the cameras";
    case RowFault::LeftLate:
      return "The left image fits the right one of the pair before: the driver pairs its queues one off. Restart it, "
             "and synchronise the cameras";
    case RowFault::None:
      break;
  }
  return "";
}

}  // namespace

flight_corridor::Report refusal(const ros::Time& stamp, std::uint32_t reasons) {
  flight_corridor::Report report;
  report.verdict.stamp_s = stamp.toSec();
  report.verdict.reasons = reasons;
  return report;
}

bool isRefusal(const flight_corridor::Report& report) { return (report.verdict.reasons & kRefused) != 0; }

const flight_corridor::Report& Processor::process(const StereoMessages& pair) {
  const std_msgs::Header& header = pair.header;
  has_products_ = false;
  report_ = refusal(header.stamp, flight_corridor::kNoData);  // for questions, should a library throw
  if (header.stamp.isZero()) {
    if (stamp_warning_.due()) ROS_WARN("a stereo pair has no stamp (0): UNKNOWN");
    return report_;
  }
  forgetWhenTimeJumpsBack(header.stamp);
  if (header.stamp < newest_stamp_) {
    if (stamp_warning_.due()) ROS_WARN("a stereo pair is older than the one before: UNKNOWN");
    return report_;
  }
  newest_stamp_ = header.stamp;
  left_info_ = scaled(pair.left_info, config_.ros.scale);
  const auto right_info = scaled(pair.right_info, config_.ros.scale);
  const auto imu_messages = inbox_.takeImu(header.stamp);
  for (const auto& imu : imu_messages) up_.add(imu);
  if (const std::uint32_t reasons = rig_.fit(header, *left_info_, *right_info, inbox_.rangeFrames())) {
    return report_ = refusal(header.stamp, reasons);
  }
  addReadings(header, imu_messages);
  const EightOfSixteen bits = bitsOf(*pair.left, *pair.right);
  left_ = readImage(pair.left, *pair.left_info, bits);
  const auto right = readImage(pair.right, *pair.right_info, bits);
  report_ = rig_->process({header.stamp.toSec(), left_->image, right->image}, cameraPose(header));
  rig_.watchDevice();
  explain(pair, right->image);
  has_products_ = !isRefusal(report_);
  if (has_products_) map_header_ = headerOfMap(header);
  camera_header_ = header;
  return report_;
}

void Processor::reset() {
  rig_.reset();
  up_.reset();
  lidar_.reset();
  fixed_frame_.clear();
  has_products_ = false;
  report_ = refusal({}, flight_corridor::kNoData);
  map_header_.stamp = newest_stamp_ = ros::Time();
}

void Processor::clear(const Eigen::AlignedBox3d& box_M) {
  if (rig_) rig_->clear(box_M);
}

std_msgs::Header Processor::headerOfMap(const std_msgs::Header& left) const {
  std_msgs::Header header = left;
  if (!config_.core.map.frame_id.empty()) header.frame_id = config_.core.map.frame_id;
  return header;
}

void Processor::forgetWhenTimeJumpsBack(const ros::Time& stamp) {
  const double back_s = newest_stamp_.toSec() - stamp.toSec();
  if (back_s <= flight_corridor::kLongestDelay_s) return;
  if (rig_) ROS_INFO("time jumped back by %.3f s: starting anew", back_s);
  reset();
}

flight_corridor::Counters Processor::counters() {
  flight_corridor::Counters counters;
  if (rig_) counters = rig_->counters();
  counters.refused += refused_ranges_ + refused_imu_;
  return counters;
}

std::optional<Eigen::Matrix3d> Processor::level() {
  const auto up_C = up_.find(camera_header_);
  if (!up_C) return std::nullopt;
  const auto R_C_H = levelled(rig_->boxInCamera().T_M_F.linear(), *up_C);
  if (!R_C_H && heading_warning_.due()) {
    ROS_WARN(
        "the corridor points more than 80 deg up or down, where it has no heading: every range of scan and "
        "obstacle_distance is NaN");
  }
  return R_C_H;
}

/// Readings up to an image.
void Processor::addReadings(const std_msgs::Header& header, const std::vector<sensor_msgs::ImuConstPtr>& imu_messages) {
  for (const auto& imu : imu_messages) {
    const auto acceleration_C = accelerometer_.read(*imu, header.frame_id);
    if (acceleration_C) rig_->addAcceleration(imu->header.stamp.toSec(), *acceleration_C);
  }
  for (const auto& range : inbox_.takeRanges(header.stamp)) addRange(range);
  watchRefused("LiDAR", inbox_.refusedRanges(), refused_ranges_);
  watchRefused("imu", inbox_.refusedImu(), refused_imu_);
}

void Processor::addRange(const sensor_msgs::RangeConstPtr& range) {
  if (rig_.isLidar(range->header.frame_id)) {
    lidar_ = range;
    const flight_corridor::RangeReading reading = toReading(*range);
    watchLidar(reading);
    rig_->addRange(reading);
  } else if (rig_.hasLidar() && lidar_warning_.due()) {
    ROS_WARN("ranges of \"%s\" are not used: they are not in the LiDAR's frame", range->header.frame_id.c_str());
  }
}

/// Says that readings were refused for their stamps.
void Processor::watchRefused(const char* sensor, const Inbox::Refused& refused, std::uint64_t& known) {
  if (refused.count > known && reading_warning_.due()) {
    const std::string difference = std::isnan(refused.difference_s)
                                       ? "without a stamp (0)"
                                       : "stamped " + std::to_string(refused.difference_s) +
                                             " s from the stereo pair, more than " +
                                             std::to_string(flight_corridor::kLongestDelay_s) + " s";
    ROS_WARN("%s readings are refused, %lu so far: the last one %s. Its driver must stamp with the cameras' clock",
             sensor, static_cast<unsigned long>(refused.count), difference.c_str());
  }
  known = refused.count;
}

/// Warns that for a while no reading was a range, nor "nothing in range".
void Processor::watchLidar(const flight_corridor::RangeReading& reading) {
  const auto& limits = config_.core.lidar;
  const bool is_useful = isRange(reading, limits) || reading.range_m == flight_corridor::kInfinity;
  const bool begins = !(useful_range_s_ <= reading.stamp_s);
  if (is_useful || begins) useful_range_s_ = reading.stamp_s;
  if (reading.stamp_s - useful_range_s_ < kUseless_s || !range_warning_.due()) return;
  ROS_WARN(
      "every LiDAR reading of the last %.1f s is refused: the last one is %g m, its message allows %g to %g m, lidar/ "
      "%g to %g m. Check that its driver sends metres, min_range below max_range, and NaN only for errors",
      reading.stamp_s - useful_range_s_, reading.range_m, reading.min_range_m, reading.max_range_m, limits.min_range_m,
      limits.max_range_m);
}

/// Logs why readable images are not usable.
void Processor::explain(const StereoMessages& pair, const cv::Mat& right) {
  const bool is_empty = left_->image.empty() || right.empty();  // readImage() has spoken
  if ((report_.verdict.reasons & flight_corridor::kBadImage) && !is_empty && image_warning_.due()) {
    ROS_ERROR("left and right image are bit-identical: UNKNOWN. One camera on both topics, \"%s\" and \"%s\"?",
              pair.left->header.frame_id.c_str(), pair.right->header.frame_id.c_str());
  }
  if (rig_->motionWitness().contradicts() && motion_warning_.due()) {
    ROS_ERROR(
        "the poses of camera \"%s\" in tf contradict its images: UNKNOWN. Check that CameraInfo is of these images "
        "(not of another size or of the uncropped sensor), the camera's mounting, and the odometry: %s",
        pair.header.frame_id.c_str(), describe(rig_->motionWitness().way()).c_str());
  }
  const flight_corridor::RowAgreement& rows = report_.rows;
  if (rows.fault != flight_corridor::RowFault::None && rows_warning_.due()) {
    ROS_ERROR(
        "rows of left and right image disagree: by up to %.1f px (sigma %.1f px), at most %.1f px are allowed; as by a "
        "lens that makes depth at the image's side wrong by %.0f %% (sigma %.0f %%), at most %.0f %%: UNKNOWN. %s",
        rows.offset_px, rows.sigma_px, flight_corridor::kMostRowOffset_px, 100.0 * std::abs(rows.lens_error),
        100.0 * rows.lens_sigma, 100.0 * flight_corridor::kMostLensError, likelyCause(rows.fault));
  }
  if ((report_.verdict.reasons & flight_corridor::kNoDisparity) && match_warning_.due()) {
    ROS_WARN(
        "hardly any pixel is matched (below stereo/min_matched_fraction %g), so nothing is FREE. Check for textureless "
        "surfaces, exposure, a covered lens, images that are not rectified together, or left and right exchanged",
        config_.core.stereo.min_matched_fraction);
  }
  if (report_.verdict.state == flight_corridor::State::Unknown && !is_empty) {
    explainBlack("left", left_->image);
    explainBlack("right", right);
  }
}

/// Logs that much of an image is black.
void Processor::explainBlack(const char* side, const cv::Mat& image) {
  const double share = static_cast<double>(cv::countNonZero(image <= kBlack)) / static_cast<double>(image.total());
  if (!(share > kMuchBlack) || !black_warning_.due()) return;
  ROS_WARN(
      "%.0f %% of the %s image is black (at most %d of 255), more than %.0f %%: nothing is matched there. Check for a "
      "covered lens and for exposure; a border that rectification left goes by alpha = 0, which keeps only valid "
      "pixels",
      100.0 * share, side, kBlack, 100.0 * kMuchBlack);
}

std::optional<Eigen::Isometry3d> Processor::cameraPose(const std_msgs::Header& header) {
  const std::string& map_frame = config_.core.map.frame_id;
  if (map_frame.empty()) return poseInAnyFrame(header);
  const auto T_W_C = transforms_.find(map_frame, header.frame_id, header.stamp, config_.ros.tf_timeout_s);
  if (!T_W_C && pose_warning_.due()) {
    ROS_WARN("tf gave no pose of \"%s\" in \"%s\" (map/frame_id) at %.3f within %.3f s (ros/tf_timeout_s): UNKNOWN",
             header.frame_id.c_str(), map_frame.c_str(), header.stamp.toSec(), config_.ros.tf_timeout_s);
  }
  const double farthest_m = flight_corridor::farthestCamera(config_.core.map);
  if (T_W_C && !(T_W_C->translation().array().abs() <= farthest_m).all() && pose_warning_.due()) {
    ROS_WARN(
        "the camera is at (%g, %g, %g) m in \"%s\" (map/frame_id), the map reaches %g m from its origin: UNKNOWN. Give "
        "poses in a frame that begins near the flight",
        T_W_C->translation().x(), T_W_C->translation().y(), T_W_C->translation().z(), map_frame.c_str(), farthest_m);
  }
  return T_W_C;
}

/// For the memory of earlier pairs, in the first of the usual fixed frames (REP-105) that tf had at a stamp, else by
/// odometry.
std::optional<Eigen::Isometry3d> Processor::poseInAnyFrame(const std_msgs::Header& header) {
  for (const char* frame : {"odom", "map", "world", Transforms::kOdometryFrame}) {
    if (!fixed_frame_.empty() && fixed_frame_ != frame) continue;
    const bool moves =
        transforms_.newestStamp(frame, header.frame_id).has_value();  // what stands in tf tells no motion
    const auto T_W_C = moves ? transforms_.find(frame, header.frame_id, header.stamp) : std::nullopt;
    if (!T_W_C) continue;
    fixed_frame_ = frame;
    return T_W_C;
  }
  const bool is_apart =
      transforms_.hasOdometry() && !transforms_.newestStamp(Transforms::kOdometryFrame, header.frame_id);
  if (fixed_frame_.empty() && is_apart && pose_warning_.due()) {
    ROS_WARN("odometry is not used: tf does not connect its child_frame_id with camera \"%s\"",
             header.frame_id.c_str());
  }
  return std::nullopt;
}

/// An empty image if the message is unreadable: the pipeline answers BAD_IMAGE.
cv_bridge::CvImageConstPtr Processor::readImage(const sensor_msgs::ImageConstPtr& message,
                                                const sensor_msgs::CameraInfo& info, EightOfSixteen bits) try {
  if (message->width != info.width || message->height != info.height) {
    throw std::invalid_argument("image of " + message->header.frame_id + " is " + sizeOf(*message) +
                                " px, its CameraInfo says " + sizeOf(info) +
                                ": UNKNOWN. Send full images, or the CameraInfo of the scaled ones");
  }
  const auto image = boost::make_shared<cv_bridge::CvImage>(*toGrey(message, bits));
  image->image = scaled(image->image, config_.ros.scale);
  return image;
} catch (const std::invalid_argument& error) {
  if (image_warning_.due()) ROS_ERROR("%s", error.what());
  return boost::make_shared<cv_bridge::CvImage>();
}

}  // namespace flight_corridor_ros
