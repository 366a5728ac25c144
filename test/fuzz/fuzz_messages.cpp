// Messages as a driver, a bag or a stranger may send them, into the node's processor and out of it again.

#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>

#include <stdexcept>

#include "bytes.hpp"
#include "flight_corridor/view/fill.hpp"
#include "flight_corridor/view/free_areas_view.hpp"
#include "flight_corridor/view/overlay.hpp"
#include "ros/clouds.hpp"
#include "ros/conversions.hpp"
#include "ros/free_areas_messages.hpp"
#include "ros/map_conversions.hpp"
#include "ros/processor.hpp"
#include "ros/scans.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::State;
using flight_corridor::fuzz::Bytes;
using flight_corridor::fuzz::require;

constexpr int kMostPairs = 4;
constexpr std::array<const char*, 7> kFrames{
    "left_optical", "/left_optical", "range_link", "/range_link", "imu_link", "", "nobody's"};
constexpr std::array<const char*, 14> kEncodings{"mono8",       "mono16",       "bgr8",   "rgb8", "bgra8",
                                                 "bayer_rggb8", "bayer_gbrg16", "8UC1",   "8UC3", "16UC1",
                                                 "32FC1",       "yuv422",       "64FC10", ""};

std_msgs::Header header(Bytes& bytes, const ros::Time& now, const char* frame) {
  std_msgs::Header header;
  header.frame_id = bytes.integer(0, 9) == 0 ? bytes.oneOf(kFrames) : frame;
  header.stamp = now;
  switch (bytes.integer(0, 11)) {
    case 0:
      header.stamp = ros::Time();
      break;
    case 1:  // as it may come over the network: nanoseconds beyond a second, too
      header.stamp.sec = bytes.raw<std::uint32_t>();
      header.stamp.nsec = bytes.raw<std::uint32_t>();
      break;
    case 2:
      header.stamp.nsec ^= bytes.raw<std::uint16_t>();
      break;
    default:
      break;
  }
  return header;
}

std::uint32_t size(Bytes& bytes, std::uint32_t usual) {
  return bytes.integer(0, 15) == 0 ? bytes.raw<std::uint32_t>() : usual;
}

sensor_msgs::ImagePtr image(Bytes& bytes, const cv::Mat& seen) {
  const auto message = toImage({}, seen, "mono8");
  if (bytes.integer(0, 3) > 0) return message;
  message->encoding = bytes.flag() ? bytes.oneOf(kEncodings) : bytes.text(12);
  message->width = size(bytes, message->width);
  message->height = size(bytes, message->height);
  message->is_bigendian = bytes.flag();
  const int channels = bytes.integer(0, 4);
  message->step = size(bytes, static_cast<std::uint32_t>(seen.cols * channels));
  if (bytes.flag()) message->data.resize(static_cast<std::size_t>(seen.rows * seen.cols * channels));
  if (bytes.integer(0, 3) == 0) message->data.resize(bytes.raw<std::uint16_t>());
  return message;
}

sensor_msgs::CameraInfo cameraInfo(Bytes& bytes, const flight_corridor::StereoCalibration& rig, double cx_px,
                                   double shift_m) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(rig.size_px.width);
  info.height = static_cast<std::uint32_t>(rig.size_px.height);
  info.P = {rig.fx_px, 0, cx_px, -rig.fx_px * shift_m, 0, rig.fy_px, rig.cy_px, 0, 0, 0, 1, 0};
  if (bytes.integer(0, 3) > 0) return info;
  info.width = size(bytes, info.width);
  info.height = size(bytes, info.height);
  info.P[static_cast<std::size_t>(bytes.integer(0, 11))] = bytes.number(-100.0, 100.0);
  info.binning_x = size(bytes, 1);
  info.roi.width = size(bytes, 0);
  info.roi.x_offset = size(bytes, 0);
  return info;
}

template <typename Message>
boost::shared_ptr<const Message> shared(const Message& message) {
  return boost::make_shared<const Message>(message);
}

sensor_msgs::Range range(Bytes& bytes, const ros::Time& now) {
  sensor_msgs::Range range;
  range.header = header(bytes, now, "range_link");
  range.radiation_type = bytes.raw<std::uint8_t>();
  range.range = static_cast<float>(bytes.number(0.0, 12.0));
  range.min_range = static_cast<float>(bytes.number(0.0, 0.5));
  range.max_range = static_cast<float>(bytes.number(5.0, 100.0));
  range.field_of_view = static_cast<float>(bytes.number(0.0, 0.1));
  return range;
}

sensor_msgs::Imu imu(Bytes& bytes, const ros::Time& now) {
  sensor_msgs::Imu imu;
  imu.header = header(bytes, now, "imu_link");
  imu.linear_acceleration.x = bytes.number(-20.0, 20.0);
  imu.linear_acceleration.y = bytes.number(-20.0, 20.0);
  imu.linear_acceleration.z = bytes.number(-20.0, 20.0);
  imu.linear_acceleration_covariance[0] = bytes.number(-1.0, 1.0);
  imu.orientation = tf2::toMsg(Eigen::Quaterniond(flight_corridor::fuzz::pose(bytes).linear()));
  if (bytes.integer(0, 7) == 0) imu.orientation.w = bytes.number(-2.0, 2.0);
  return imu;
}

/// What the node would publish of more than the corridor.
void convertDirections(Bytes& bytes, const std_msgs::Header& header, Processor& processor,
                       flight_corridor::Pipeline& pipeline) {
  const flight_corridor::Box box_C = pipeline.boxInCamera();
  const Eigen::Matrix3d R_C_H = processor.level().value_or(box_C.T_M_F.linear());
  require(flight_corridor::isRotation(R_C_H), "a level frame is turned, nothing else");
  scanFrames(header, R_C_H);
  const flight_corridor::LevelScan scan = pipeline.levelScan(R_C_H);
  for (const auto& message : {toScan(header, scan), toObstacleDistance(header, scan)}) {
    for (const float range_m : message.ranges) require(!(range_m < message.range_min), "a range is one, or not known");
  }
  const Eigen::Vector3d goal_C(bytes.number(-1.0, 1.0), bytes.number(-1.0, 1.0), 1.0);
  const flight_corridor::AreaGrid& areas = pipeline.freeAreas(goal_C);
  const double step_rad = pipeline.config().free_areas.step_rad;
  toMessage(header, areas, box_C.T_M_F.linear(), goal_C, pipeline.config().speed, 0.0);
  toMarkers(header, areas, box_C, step_rad, goal_C, 1.0);
  cv::Mat picture;
  drawFreeAreas(processor.left(), pipeline.geometry(), box_C, areas, step_rad, goal_C, picture);
}

/// What the node would publish.
void convert(Bytes& bytes, const StereoMessages& pair, Processor& processor) {
  const std_msgs::Header& header = pair.header;
  const flight_corridor::Report& report = processor.report();
  toMessage(header, report, {4.0, 1.2, 0.4}, {}, 0.0);
  toBinaryOctomap(processor.mapHeader(), processor.map());
  toFullOctomap(processor.mapHeader(), processor.map());
  flight_corridor::Pipeline* pipeline = processor.products();
  if (!pipeline) return;
  const flight_corridor::MapConfig& map = pipeline->config().map;
  toDisparityImage(header, filledDisparity(*pipeline), pipeline->geometry(), pipeline->nearestDepth());
  toImage(header, filledDepth(*pipeline), sensor_msgs::image_encodings::TYPE_32FC1);
  toPointCloud(header, toCloud(*pipeline));
  toMarker(header, pipeline->box(), report.verdict.state, 1.0);
  toObstacles(header, pipeline->map().tree(), pipeline->T_M_C(), map.max_range_m);
  toMarkers(processor.mapHeader(), processor.map(), Cells::Occupied, pipeline->T_M_C());
  toProjectedMap(processor.mapHeader(), processor.map());
  if (processor.lidar()) toRange(header.stamp, report.range, pipeline->config().lidar, *processor.lidar());
  cv::Mat overlay;
  flight_corridor::drawOverlay(processor.left(), pipeline->covered(), pipeline->geometry(), pipeline->boxInCamera(),
                               report.verdict, report.range, overlay);
  if (bytes.integer(0, 3) == 0) convertDirections(bytes, header, processor, *pipeline);
}

void know(Transforms& transforms, const char* parent, const char* child, const Eigen::Isometry3d& T) {
  geometry_msgs::TransformStamped transform = tf2::eigenToTransform(T);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transforms.add(transform, true);
}

/// A pose from anybody, of any time.
void hear(Bytes& bytes, Transforms& transforms, const ros::Time& now) {
  geometry_msgs::TransformStamped transform = tf2::eigenToTransform(flight_corridor::fuzz::pose(bytes));
  transform.header = header(bytes, now, "odom");
  transform.child_frame_id = bytes.oneOf(kFrames);
  transforms.add(transform, bytes.flag());
}

void send(Bytes& bytes) {
  using namespace flight_corridor;
  Transforms transforms;
  know(transforms, "left_optical", "range_link", bytes.flag() ? fuzz::pose(bytes) : opticalFromForward());
  know(transforms, "left_optical", "imu_link", opticalFromForward());
  if (bytes.flag()) know(transforms, "odom", "left_optical", fuzz::pose(bytes));
  NodeConfig config;
  config.core = fuzz::smallConfig();
  config.ros.tf_timeout_s = 0.0;
  if (bytes.flag()) config.core.map.frame_id = "odom";
  config.core.corridor.level = bytes.integer(0, 3) == 0;
  Inbox inbox;
  Processor processor(config, transforms, inbox);
  const StereoCalibration rig = fuzz::anyRig(bytes);
  const StereoGeometry drawn(fuzz::smallRig());
  ros::Time now(100, 0);
  for (int i = 0; i < kMostPairs && !bytes.empty(); ++i) {
    now += ros::Duration(0.1);
    for (int readings = bytes.integer(0, 2); readings > 0; --readings) inbox.put(shared(range(bytes, now)));
    for (int readings = bytes.integer(0, 2); readings > 0; --readings) inbox.put(shared(imu(bytes, now)));
    if (bytes.integer(0, 7) == 0) hear(bytes, transforms, now);
    const StereoFrame seen = fuzz::wall(drawn, bytes.integer(1, 30), 0.0, static_cast<std::uint64_t>(i));
    const auto left = image(bytes, seen.left), right = image(bytes, seen.right);
    left->header = right->header = header(bytes, now, "left_optical");
    const StereoMessages pair(left, shared(cameraInfo(bytes, rig, rig.cx_px, 0.0)), right,
                              shared(cameraInfo(bytes, rig, rig.cx_right_px, rig.baseline_m)));
    const Verdict verdict = processor.process(pair).verdict;
    fuzz::checkVerdict(verdict);
    require(verdict.state != State::Free || !left->header.stamp.isZero(), "without a stamp nothing is FREE", verdict);
    require(verdict.state != State::Free || left->data != right->data, "one camera is not FREE", verdict);
    convert(bytes, pair, processor);
    if (bytes.integer(0, 19) == 0) processor.reset();
  }
}

void convertQuestions(Bytes& bytes) {
  geometry_msgs::Pose pose;
  for (double* number :
       {&pose.position.x, &pose.orientation.x, &pose.orientation.y, &pose.orientation.z, &pose.orientation.w}) {
    *number = bytes.number(-1.0, 1.0);
  }
  try {
    require(toPose(pose).matrix().allFinite(), "a pose is finite");
  } catch (const std::invalid_argument&) {
  }
  octomap_msgs::BoundingBoxQueryRequest request;
  request.min.x = bytes.number(-1.0, 1.0);
  request.max.x = bytes.number(-1.0, 1.0);
  try {
    require(!toBox(request).isEmpty(), "a box holds something");
  } catch (const std::invalid_argument&) {
  }
}

}  // namespace
}  // namespace flight_corridor_ros

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flight_corridor::fuzz::Bytes bytes(data, size);
  flight_corridor_ros::convertQuestions(bytes);
  flight_corridor_ros::send(bytes);
  return 0;
}
