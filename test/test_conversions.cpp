#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "flight_corridor/view/overlay.hpp"
#include "ros/conversions.hpp"
#include "ros/stereo_subscriber.hpp"
#include "support/contains.hpp"
#include "support/header.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::CorridorState;
using flight_corridor::StereoGeometry;
using flight_corridor::test_support::contains;
using test_support::header;

sensor_msgs::CameraInfo info(double fx, double cx, double p3) {
  sensor_msgs::CameraInfo message;
  message.width = 640;
  message.height = 480;
  message.P = {fx, 0, cx, p3, 0, 350, 240, 0, 0, 0, 1, 0};
  return message;
}

StereoGeometry geometry() { return StereoGeometry({{640, 480}, 350, 350, 320, 240, 326, 0.12}); }

sensor_msgs::ImagePtr image(const std::string& encoding, int type) {
  return toImage(header("left"), cv::Mat(4, 6, type, cv::Scalar::all(100)), encoding);
}

std::string complaintAbout(const sensor_msgs::CameraInfo& left, const sensor_msgs::CameraInfo& right) {
  try {
    toCalibration(left, right);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// --- CameraInfo

TEST(ToCalibration, TakesTheBaselineFromTheProjectionMatrices) {
  const auto calibration = toCalibration(info(350, 320, 0), info(350, 326, -42));
  EXPECT_DOUBLE_EQ(calibration.baseline_m, 0.12);
  EXPECT_EQ(calibration.cx_px, 320);
  EXPECT_EQ(calibration.cx_right_px, 326);
  EXPECT_EQ(calibration.fy_px, 350);
  EXPECT_EQ(calibration.cy_px, 240);
  EXPECT_EQ(calibration.size_px, cv::Size(640, 480));
}

TEST(ToCalibration, BaselineIsTheDifferenceWhenTheLeftCameraIsNotTheOrigin) {
  EXPECT_DOUBLE_EQ(toCalibration(info(350, 320, 21), info(350, 320, -21)).baseline_m, 0.12);
}

TEST(ToCalibration, NamesEverythingThatDiffers) {
  sensor_msgs::CameraInfo right = info(351, 320, -42);
  right.P[6] = 241;
  right.width = 320;
  const std::string complaint = complaintAbout(info(350, 320, 0), right);
  for (const char* name : {"fx", "cy", "width"}) EXPECT_TRUE(contains(complaint, name)) << complaint;
  EXPECT_FALSE(contains(complaint, "height")) << complaint;
}

TEST(ToCalibration, RefusesBinningAndRegionsOfInterest) {
  sensor_msgs::CameraInfo binned = info(350, 320, 0), cropped = binned, full = binned;
  binned.binning_x = binned.binning_y = 2;
  cropped.roi.x_offset = 10;
  cropped.roi.width = 600;
  full.binning_x = full.binning_y = 1;
  full.roi.width = 640;
  full.roi.height = 480;
  const auto right = info(350, 320, -42);
  EXPECT_TRUE(contains(complaintAbout(binned, right), "binning"));
  EXPECT_TRUE(contains(complaintAbout(cropped, right), "region of interest"));
  EXPECT_EQ(complaintAbout(full, right), "");
}

TEST(ToCalibration, ImpossibleNumbersAreLeftForTheGeometryToRefuse) {
  EXPECT_THROW(StereoGeometry(toCalibration(info(350, 320, 0), info(350, 320, 0))), std::invalid_argument);
  EXPECT_THROW(StereoGeometry(toCalibration({}, {})), std::invalid_argument);
  sensor_msgs::CameraInfo broken = info(std::nan(""), 320, 0);
  EXPECT_THROW(StereoGeometry(toCalibration(broken, broken)), std::invalid_argument);
}

TEST(ToCalibration, NamesWhatElseAProjectionMatrixHolds) {
  const std::pair<std::size_t, double> entries[] = {{1, 3.0}, {7, 42.0}, {10, 0.5}, {10, std::nan("")}};
  for (const auto& [entry, value] : entries) {
    sensor_msgs::CameraInfo right = info(350, 326, -42);
    right.P[entry] = value;
    const std::string complaint = complaintAbout(info(350, 320, 0), right);
    EXPECT_TRUE(contains(complaint, "P[" + std::to_string(entry) + "] of right")) << complaint;
  }
  EXPECT_TRUE(contains(complaintAbout({}, {}), "not calibrated"));
}

TEST(ToCalibration, ExchangedCamerasAreNamed) {
  try {
    StereoGeometry(toCalibration(info(350, 326, -42), info(350, 320, 0)));
    FAIL() << "was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(contains(error.what(), "exchanged")) << error.what();
  }
}

// --- Range

TEST(ToReading, KeepsWhatTheDriverSaid) {
  sensor_msgs::Range message;
  message.header = header("range_link");
  message.range = -std::numeric_limits<float>::infinity();
  message.min_range = 0.25f;
  message.max_range = 50.0f;
  message.field_of_view = 0.125f;
  const auto reading = toReading(message);
  EXPECT_DOUBLE_EQ(reading.stamp_s, 12.5);
  EXPECT_EQ(reading.range_m, -flight_corridor::kInfinity);
  EXPECT_EQ(reading.min_range_m, 0.25);
  EXPECT_EQ(reading.max_range_m, 50.0);
  EXPECT_EQ(reading.field_of_view_rad, 0.125);
}

TEST(ToRange, IsAReadingOfTheLidarAtTheImagesStamp) {
  sensor_msgs::Range lidar;
  lidar.header = header("range_link");
  lidar.field_of_view = 0.125f;
  flight_corridor::RangeEstimate estimate;
  estimate.range_m = 3.5;
  const auto message = toRange(ros::Time(20), estimate, {}, lidar);
  EXPECT_EQ(message.header.frame_id, "range_link");
  EXPECT_EQ(message.header.stamp, ros::Time(20));
  EXPECT_EQ(message.range, 3.5f);
  EXPECT_EQ(message.field_of_view, 0.125f);
  EXPECT_EQ(message.max_range, 100.0f);
  EXPECT_TRUE(std::isnan(toRange(ros::Time(20), {}, {}, lidar).range));
}

// --- poses

geometry_msgs::Pose pose(double x, double w) {
  geometry_msgs::Pose pose;
  pose.position.x = x;
  pose.orientation.w = w;
  return pose;
}

TEST(ToPose, TurnsAndShifts) {
  geometry_msgs::Pose left_turn = pose(3.0, std::sqrt(0.5));
  left_turn.orientation.z = std::sqrt(0.5);
  EXPECT_TRUE((toPose(left_turn) * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(3, 1, 0)));
}

TEST(ToPose, IsRigidAlsoWhereTheQuaternionWasRounded) {
  const Eigen::Matrix3d R = toPose(pose(0.0, 0.995)).linear();
  EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12));
}

TEST(ToPose, RefusesWhatIsNoPose) {
  EXPECT_THROW(toPose(geometry_msgs::Pose()), std::invalid_argument);  // the message's default is no rotation
  EXPECT_THROW(toPose(pose(0.0, 2.0)), std::invalid_argument);
  EXPECT_THROW(toPose(pose(0.0, std::nan(""))), std::invalid_argument);
  EXPECT_THROW(toPose(pose(flight_corridor::kInfinity, 1.0)), std::invalid_argument);
}

// --- images

TEST(ToGrey, SharesGreyImages) {
  for (const char* encoding : {"mono8", "8UC1"}) {
    const auto message = image(encoding, CV_8UC1);
    EXPECT_EQ(toGrey(message)->image.data, message->data.data()) << encoding;
  }
}

TEST(ToGrey, ReadsColourAndDeepImages) {
  for (const char* encoding : {"bgr8", "rgb8"}) EXPECT_EQ(toGrey(image(encoding, CV_8UC3))->image.at<uchar>(2, 3), 100);
  for (const char* encoding : {"bgra8", "rgba8"}) EXPECT_EQ(toGrey(image(encoding, CV_8UC4))->image.type(), CV_8UC1);
  EXPECT_EQ(toGrey(image("bayer_rggb8", CV_8UC1))->image.type(), CV_8UC1);
}

sensor_msgs::ImagePtr deepImage(int grey, bool is_bigendian) {
  const auto message = toImage(header("left"), cv::Mat(4, 6, CV_16UC1, cv::Scalar(grey)), "mono16");
  message->is_bigendian = is_bigendian;
  for (std::size_t i = 0; is_bigendian && i < message->data.size(); i += 2) {
    std::swap(message->data[i], message->data[i + 1]);
  }
  return message;
}

/// A scene in which no two neighbours are alike, of 8 or 16 bits.
sensor_msgs::ImagePtr mosaic(const std::string& encoding, int factor, bool is_bigendian = false) {
  cv::Mat scene(12, 16, CV_8UC1);
  for (int y = 0; y < scene.rows; ++y) {
    for (int x = 0; x < scene.cols; ++x) scene.at<uchar>(y, x) = static_cast<uchar>((37 * x + 71 * y + x * y) % 256);
  }
  if (factor > 0) scene.convertTo(scene, CV_16UC1, factor);
  const auto message = toImage(header("left"), scene, encoding);
  message->is_bigendian = is_bigendian;
  for (std::size_t i = 0; is_bigendian && i < message->data.size(); i += 2) {
    std::swap(message->data[i], message->data[i + 1]);
  }
  return message;
}

TEST(ToGrey, AMosaicOfSixteenBitsIsThatOfEight) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    const cv::Mat eight = toGrey(mosaic("bayer_" + pattern + "8", 0))->image;
    for (const bool is_bigendian : {false, true}) {
      const cv::Mat sixteen = toGrey(mosaic("bayer_" + pattern + "16", 257, is_bigendian))->image;
      ASSERT_EQ(sixteen.type(), CV_8UC1);
      EXPECT_EQ(cv::norm(eight, sixteen, cv::NORM_INF), 0.0) << pattern << is_bigendian << eight << sixteen;
    }
    EXPECT_THROW(toGrey(mosaic("bayer_" + pattern + "16", 4)), std::invalid_argument) << "10 bits in the low end";
    EXPECT_THROW(toGrey(mosaic("bayer_" + pattern + "16", 16)), std::invalid_argument) << "12 bits in the low end";
  }
}

TEST(ToGrey, ReadsSixteenBitsOfEitherEndianness) {
  for (const bool is_bigendian : {false, true}) {
    const auto grey = toGrey(deepImage(100 * 257, is_bigendian));
    EXPECT_EQ(grey->image.type(), CV_8UC1);
    EXPECT_EQ(grey->image.at<uchar>(2, 3), 100) << is_bigendian;
  }
}

TEST(ToGrey, RefusesTenBitsInSixteen) {
  for (const bool is_bigendian : {false, true}) {
    try {
      toGrey(deepImage(1023, is_bigendian));
      ADD_FAILURE() << "was taken";
    } catch (const std::invalid_argument& error) {
      for (const char* part : {"4096", "65535", "mono8"}) EXPECT_TRUE(contains(error.what(), part)) << error.what();
    }
  }
}

TEST(ToGrey, RefusesWhatIsNoImageByName) {
  const auto unknown = image("mono8", CV_8UC1);
  unknown->encoding = "smell8";
  const auto depth = image("32FC1", CV_32FC1);
  const auto nameless = image("mono8", CV_8UC1);
  nameless->encoding = "";
  for (const auto& message : {unknown, depth, nameless}) {
    try {
      toGrey(message);
      ADD_FAILURE() << message->encoding;
    } catch (const std::invalid_argument& error) {
      EXPECT_TRUE(contains(error.what(), "\"" + message->encoding + "\"")) << error.what();
      EXPECT_TRUE(contains(error.what(), "left")) << error.what();
    }
  }
}

TEST(ToGrey, RefusesImagesWithTooLittleData) {
  const auto truncated = image("mono8", CV_8UC1);
  truncated->data.resize(5);
  EXPECT_THROW(toGrey(truncated), std::invalid_argument);
  const auto narrow = image("mono8", CV_8UC1);
  narrow->width = 600;
  EXPECT_THROW(toGrey(narrow), std::invalid_argument);
  const auto rows_of_nothing = image("mono16", CV_16UC1);
  rows_of_nothing->width = rows_of_nothing->step = 0;
  rows_of_nothing->height = 4000000000u;
  rows_of_nothing->data.clear();
  EXPECT_THROW(toGrey(rows_of_nothing), std::invalid_argument);
}

TEST(ToDisparityImage, GivesTheDepthThatTheGeometryGives) {
  cv::Mat disparity(480, 640, CV_32FC1, cv::Scalar(21.0));
  disparity.at<float>(0, 0) = NAN;
  const auto message = toDisparityImage(header("left"), disparity, geometry(), geometry().depth(125.0));
  const auto image = cv_bridge::toCvCopy(message.image);
  EXPECT_NEAR(message.f * message.T / image->image.at<float>(7, 7), geometry().depth(21.0), 1e-6);
  EXPECT_LT(image->image.at<float>(0, 0), message.min_disparity);
  EXPECT_EQ(message.min_disparity, 0.0f);  // also where cx_right - cx_left is not 0
  EXPECT_NEAR(message.max_disparity, 125.0f, 1e-3f);
  EXPECT_EQ(message.delta_d, 1.0f / 64.0f);  // the matcher's step
  EXPECT_EQ(message.image.header.frame_id, "left");
  EXPECT_TRUE(std::isnan(disparity.at<float>(0, 0)));
}

// --- verdict

TEST(ToMessage, CarriesEveryNumberOfTheReport) {
  flight_corridor::Report report;
  report.verdict = {12.5, flight_corridor::State::Blocked, 2.5, 2.4, 0.25, flight_corridor::kOccupiedCell};
  report.range.range_m = 2.6;
  report.range.sigma_m = 0.01;
  report.range_lidar_m = 2.61;
  report.range_stereo_m = 2.59;
  report.scale = 1.02;
  report.scale_sigma = 0.005;
  const CorridorState message = toMessage(header("left"), report, {4.0, 1.2, 0.4}, {}, 0.04);
  EXPECT_EQ(message.header.frame_id, "left");
  EXPECT_EQ(message.state, CorridorState::BLOCKED);
  EXPECT_EQ(message.clear_distance, 2.5);
  EXPECT_EQ(message.safe_speed, flight_corridor::safeSpeed(2.4, 0.04, {}));
  EXPECT_GT(message.safe_speed, 0.0);
  EXPECT_EQ(message.unknown_fraction, 0.25);
  EXPECT_EQ(message.box.x, 4.0);
  EXPECT_EQ(message.box.y, 1.2);
  EXPECT_EQ(message.box.z, 0.4);
  EXPECT_EQ(message.range_fused, 2.6);
  EXPECT_EQ(message.range_fused_sigma, 0.01);
  EXPECT_EQ(message.range_lidar, 2.61);
  EXPECT_EQ(message.range_stereo, 2.59);
  EXPECT_EQ(message.scale, 1.02);
  EXPECT_EQ(message.scale_sigma, 0.005);
  EXPECT_EQ(message.reasons, CorridorState::OCCUPIED_CELL);
  EXPECT_EQ(message.latency, 0.04);
}

TEST(CorridorStateMessage, SpeaksTheCoresStatesAndReasons) {
  using namespace flight_corridor;
  EXPECT_EQ(+CorridorState::UNKNOWN, static_cast<int>(State::Unknown));
  EXPECT_EQ(+CorridorState::FREE, static_cast<int>(State::Free));
  EXPECT_EQ(+CorridorState::BLOCKED, static_cast<int>(State::Blocked));
  const std::pair<std::uint32_t, Reason> reasons[] = {{CorridorState::OCCUPIED_CELL, kOccupiedCell},
                                                      {CorridorState::SHORT_RANGE, kShortRange},
                                                      {CorridorState::UNOBSERVED, kUnobserved},
                                                      {CorridorState::NO_DATA, kNoData},
                                                      {CorridorState::NO_POSE, kNoPose},
                                                      {CorridorState::BAD_IMAGE, kBadImage},
                                                      {CorridorState::BAD_CALIBRATION, kBadCalibration},
                                                      {CorridorState::NO_DISPARITY, kNoDisparity},
                                                      {CorridorState::DISAGREEMENT, kDisagreement},
                                                      {CorridorState::NO_LIDAR, kNoLidar},
                                                      {CorridorState::LIDAR_REJECTED, kLidarRejected},
                                                      {CorridorState::NO_RANGE_OBSERVED, kNoRangeObserved},
                                                      {CorridorState::RECENTLY_BLOCKED, kRecentlyBlocked},
                                                      {CorridorState::FROZEN_IMAGE, kFrozenImage},
                                                      {CorridorState::AMBIGUOUS, kAmbiguous},
                                                      {CorridorState::WEAK_EVIDENCE, kWeakEvidence},
                                                      {CorridorState::LIDAR_NEARER, kLidarNearer},
                                                      {CorridorState::MOVING, kMoving},
                                                      {CorridorState::NO_MOTION, kNoMotion}};
  for (const auto& [in_message, in_core] : reasons) EXPECT_EQ(in_message, in_core) << describeReasons(in_core);
}

TEST(ToResponse, SpeaksAsTheVerdictDoes) {
  using flight_corridor::QueryCorridorResponse;
  const flight_corridor::Verdict verdict{12.5, flight_corridor::State::Blocked, 2.5, 2.4,
                                         0.25, flight_corridor::kOccupiedCell};
  const QueryCorridorResponse response = toResponse(ros::Time(12, 500000000), verdict);
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.message, "");
  EXPECT_EQ(response.stamp, ros::Time(12, 500000000));
  EXPECT_EQ(response.state, QueryCorridorResponse::BLOCKED);
  EXPECT_EQ(response.clear_distance, 2.5);
  EXPECT_EQ(response.unknown_fraction, 0.25);
  EXPECT_EQ(response.reasons, CorridorState::OCCUPIED_CELL);
  EXPECT_EQ(+QueryCorridorResponse::UNKNOWN, +CorridorState::UNKNOWN);
  EXPECT_EQ(+QueryCorridorResponse::FREE, +CorridorState::FREE);
  EXPECT_EQ(+QueryCorridorResponse::BLOCKED, +CorridorState::BLOCKED);
}

TEST(ToRange, ItsFrameIsWhatTf2Takes) {
  sensor_msgs::Range lidar;
  lidar.header = header("/range_link");
  EXPECT_EQ(toRange(ros::Time(20), {}, {}, lidar).header.frame_id, "range_link");
}

TEST(StereoMessages, TheirHeaderHasAFrameThatTf2Takes) {
  const auto left = image("mono8", CV_8UC1);
  for (const char* frame : {"/left", "//left", "left"}) {
    left->header.frame_id = frame;
    const StereoMessages pair(left, nullptr, nullptr, nullptr);
    EXPECT_EQ(pair.header.frame_id, "left");
    EXPECT_EQ(pair.header.stamp, left->header.stamp);
  }
}

TEST(ToMarker, GoesByItselfWhenNothingComes) {
  const auto lifetime = [](double s) { return toMarker(header("left"), {}, flight_corridor::State::Free, s).lifetime; };
  EXPECT_EQ(lifetime(0.5), ros::Duration(0.5));
  EXPECT_EQ(lifetime(flight_corridor::kInfinity), ros::Duration(60.0));
}

TEST(ToMarker, IsTheBoxInItsStatesColour) {
  flight_corridor::Box box;
  box.T_M_F = flight_corridor::opticalFromForward();
  box.size_m = {4.0, 1.2, 0.4};
  const auto marker = toMarker(header("left"), box, flight_corridor::State::Blocked, 0.5);
  EXPECT_NEAR(marker.pose.position.z, 2.0, 1e-12);  // forward is z in the optical frame
  EXPECT_NEAR(marker.pose.position.x, 0.0, 1e-12);
  EXPECT_EQ(marker.scale.x, 4.0);
  EXPECT_EQ(marker.scale.y, 1.2);
  EXPECT_EQ(marker.scale.z, 0.4);
  EXPECT_FLOAT_EQ(marker.color.r * 255.0f,
                  static_cast<float>(flight_corridor::colour(flight_corridor::State::Blocked)[2]));
}

}  // namespace
}  // namespace flight_corridor_ros
