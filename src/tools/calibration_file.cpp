#include "tools/calibration_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <vector>

#include "ros/conversions.hpp"
#include "tools/calibration_text.hpp"
#include "tools/calibration_yaml.hpp"

namespace flight_corridor::tools {
namespace {

struct Key {
  const char* name;
  const char* unit;
};
constexpr std::array<Key, 6> kKeys{
    {{"fx", "px"}, {"fy", "px"}, {"cx", "px"}, {"cy", "px"}, {"doffs", "px"}, {"baseline", "m"}}};

constexpr char kOwn[] =
    "Wanted are lines \"KEY: NUMBER\" with fx, fy, cx, cy of the rectified left camera and doffs, the right camera's "
    "cx "
    "less cx [px], and the baseline [m]";
constexpr char kText[] =
    "Give the YAML file that camera_calibration or OpenCV writes of the same numbers, or use the projection matrices P "
    "of left and right, row by row: fx = P_left[0], fy = P_left[5], cx = P_left[2], cy = P_left[6], doffs = P_right[2] "
    "- cx, baseline [m] = -P_right[3] / fx";

using Reader = StereoCameras (*)(const CalibrationTexts& texts, const ImageFormat& images);

/// How another tool's file is recognised: one of these texts, of which all parts are in it. Blanks do not count.
struct Kind {
  const char* name;
  std::vector<std::vector<const char*>> signs;
  Reader read;             ///< Null: it is refused ...
  const char* conversion;  ///< ... with this.
};

/// Kinds that hold a sign of a later one come first.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      {"a ZED factory calibration", {{"\n[LEFT_CAM_"}}, readZed, ""},
      {"a Middlebury calibration", {{"\ncam0=["}}, readMiddlebury, ""},
      {"a Kalibr camchain",
       {{"\ncam0:", "\nintrinsics:"}, {"\ncam0:", "\ncamera_model:"}, {"\nT_cn_cnm1:"}},
       readKalibr,
       ""},
      {"an EuRoC sensor.yaml", {{"\nT_BS:"}, {"\nsensor_type:"}}, readEuroc, ""},
      {"an ORB-SLAM settings file",
       {{"\nCamera.fx:"}, {"\nCamera1.fx:"}},
       nullptr,
       "If its images are rectified: fx, fy, cx, cy = Camera.fx and so on, doffs = 0, baseline [m] = Camera.bf / "
       "Camera.fx"},
      {"a ROS camera calibration", {{"\nprojection_matrix:"}}, readRos, ""},
      {"an OpenCV calibration", {{"%YAML:1.0"}, {"!!opencv-matrix"}, {"<opencv_storage>"}}, readOpenCv, ""},
      {"a ROS camera calibration as text", {{"#oSTversion"}, {"\nprojection\n"}}, nullptr, kText},
      {"a ROS CameraInfo message", {{"\ndistortion_model:", "\nP:["}}, readRos, ""},
      {"a KITTI calibration", {{"\nP0:"}, {"\nP2:"}, {"\nP_rect_00:"}, {"\nP_rect_02:"}}, readKitti, ""},
  };
  return kinds;
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file || text.empty()) fail(path, file ? "is empty. " + std::string(kOwn) : "cannot be read");
  return text;
}

/// @return null if no kind is recognised.
const Kind* recognise(const std::string& text) {
  std::string packed = "\n";
  std::copy_if(text.begin(), text.end(), std::back_inserter(packed),
               [](unsigned char c) { return c == '\n' || !std::isspace(c); });
  const auto holds = [&](const char* part) { return packed.find(part) != std::string::npos; };
  for (const Kind& kind : kinds()) {
    for (const auto& sign : kind.signs) {
      if (std::all_of(sign.begin(), sign.end(), holds)) return &kind;
    }
  }
  return nullptr;
}

std::string withUnit(const Key& key) { return std::string(key.name) + " [" + key.unit + "]"; }

/// The numbers of our own form, and their faults; "" without faults.
struct OwnNumbers {
  std::map<std::string, double> numbers;
  std::string faults;
};

OwnNumbers readNumbers(const std::string& text) {
  OwnNumbers own;
  std::string missing, wrong, syntax;
  YAML::Node yaml;
  try {
    yaml = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    syntax = " (as YAML it cannot be read: " + std::string(error.what()) + ")";
  }
  for (const Key& key : kKeys) {
    const YAML::Node value = yaml.IsMap() ? yaml[key.name] : YAML::Node(YAML::NodeType::Undefined);
    double number = 0.0;
    if (!value) {
      missing += (missing.empty() ? "" : ", ") + withUnit(key);
    } else if (value.IsScalar() && YAML::convert<double>::decode(value, number)) {
      own.numbers[key.name] = number;
    } else {
      wrong += (wrong.empty() ? "" : ", ") + withUnit(key) + (value.IsScalar() ? " '" + value.Scalar() + "'" : "");
    }
  }
  if (missing.empty() && wrong.empty()) return own;
  own.faults = (missing.empty() ? "" : "missing: " + missing) + (missing.empty() || wrong.empty() ? "" : "; ") +
               (wrong.empty() ? "" : "no numbers: " + wrong) + syntax;
  return own;
}

StereoCameras camerasOf(const std::map<std::string, double>& numbers, const ImageFormat& images) {
  StereoCalibration calibration;
  calibration.size_px = images.size_px;
  calibration.fx_px = numbers.at("fx");
  calibration.fy_px = numbers.at("fy");
  calibration.cx_px = numbers.at("cx");
  calibration.cy_px = numbers.at("cy");
  calibration.cx_right_px = calibration.cx_px + numbers.at("doffs");
  calibration.baseline_m = numbers.at("baseline");
  return tools::camerasOf(StereoGeometry(calibration).calibration());  // refuses impossible numbers
}

void requireSize(const sensor_msgs::CameraInfo& camera, const cv::Size& images) {
  const cv::Size size(static_cast<int>(camera.width), static_cast<int>(camera.height));
  if (size == images) return;
  throw std::runtime_error("it is for images of " + sizeText(size) + ", these are " + sizeText(images) +
                           ": calibrate, or record, in one size");
}

/// That a file that names no cameras is not asked for them.
void requireNames(const StereoCameras& cameras, const PairNames& asked) {
  if (!cameras.names.left.empty() || (asked.left.empty() && asked.right.empty())) return;
  throw std::runtime_error("--calib-left and --calib-right name cameras of a Kalibr camchain: leave them out");
}

/// @throws std::exception naming the impossible values.
void check(const StereoCameras& cameras, const ImageFormat& images) {
  requireSize(cameras.left, images.size_px);
  requireSize(cameras.right, images.size_px);
  if (!areRectified(cameras)) requireRectifiable(cameras);
  const StereoCameras rectified = tools::rectified(cameras);
  StereoGeometry{flight_corridor_ros::toCalibration(rectified.left, rectified.right)};
}

StereoCameras readTexts(const CalibrationTexts& texts, const ImageFormat& images) {
  const OwnNumbers own = readNumbers(texts.front());
  if (own.faults.empty()) return camerasOf(own.numbers, images);
  const Kind* kind = recognise(texts.front());
  if (!kind) throw std::runtime_error(own.faults + ". " + kOwn);
  if (!kind->read) throw std::runtime_error(own.faults + "; it looks like " + kind->name + ". " + kind->conversion);
  try {
    const StereoCameras cameras = kind->read(texts, images);
    check(cameras, images);
    return cameras;
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string(error.what()) + " (read as " + kind->name + ")");
  }
}

}  // namespace

StereoCameras readCalibration(const std::vector<std::string>& paths, const ImageFormat& images) {
  CalibrationTexts texts;
  std::string names;
  for (const std::string& path : paths) {
    texts.push_back(readText(path));
    names += (names.empty() ? "" : ", ") + path;
  }
  if (texts.empty()) throw std::runtime_error("no calibration file is given");
  try {
    const StereoCameras cameras = readTexts(texts, images);
    requireNames(cameras, images.cameras);
    return cameras;
  } catch (const std::exception& error) {
    fail(names, error.what());
  }
}

std::string calibrationKinds() {
  return "one file: fx fy cx cy doffs [px], baseline [m] of a rectified pair; Kalibr camchain; OpenCV YAML or XML "
         "(K1 D1 K2 D2 R T,\nor R1 P1 R2 P2; T in metres); KITTI calib.txt; Middlebury calib.txt; ZED factory .conf.\n"
         "Two files, left and right: EuRoC sensor.yaml; camera_calibration's ost.yaml or camera_info; OpenCV's "
         "intrinsics.yml, extrinsics.yml.\n";
}

}  // namespace flight_corridor::tools
