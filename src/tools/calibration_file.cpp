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
constexpr char kRectify[] =
    "It describes images that are not rectified: rectify them with OpenCV's stereoRectify and remap, and take from its "
    "P1, P2: fx = P1[0][0], fy = P1[1][1], cx = P1[0][2], cy = P1[1][2], doffs = P2[0][2] - cx, baseline [m] = "
    "-P2[0][3] / fx, in the unit of its T";
constexpr char kProjection[] =
    "Take from the projection matrices P of left and right, row by row: fx = P_left[0], fy = P_left[5], cx = "
    "P_left[2], "
    "cy = P_left[6], doffs = P_right[2] - cx, baseline [m] = -P_right[3] / fx";

/// What tells another tool's file: one of these texts, of which all parts are in it. Blanks do not count.
struct Kind {
  const char* name;
  std::vector<std::vector<const char*>> signs;
  const char* conversion;
};

/// Kinds that hold a sign of a later one come first.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      {"a ZED factory calibration",
       {{"\n[LEFT_CAM_"}},
       "It describes images that are not rectified: import rectified ones, with the numbers that the ZED SDK gives for "
       "them (fx, fy, cx, cy of calibration_parameters, doffs = 0), and Baseline / 1000, which is in mm"},
      {"a Middlebury calibration",
       {{"\ncam0=["}},
       "Of cam0=[f 0 cx; 0 f cy; 0 0 1]: fx = fy = f, cx, cy; doffs as it is; baseline / 1000, which is in mm"},
      {"a Kalibr camchain", {{"\ncam0:", "\nintrinsics:"}, {"\ncam0:", "\ncamera_model:"}, {"\nT_cn_cnm1:"}}, kRectify},
      {"an EuRoC sensor.yaml", {{"\nT_BS:"}, {"\nsensor_type:"}}, kRectify},
      {"an ORB-SLAM settings file",
       {{"\nCamera.fx:"}, {"\nCamera1.fx:"}},
       "Where its images are rectified: fx, fy, cx, cy = Camera.fx and so on, doffs = 0, baseline [m] = Camera.bf / "
       "Camera.fx"},
      {"an OpenCV calibration", {{"%YAML:1.0"}, {"!!opencv-matrix"}, {"<opencv_storage>"}}, kRectify},
      {"a ROS camera calibration", {{"\nprojection_matrix"}, {"#oSTversion"}, {"\nprojection\n"}}, kProjection},
      {"a ROS CameraInfo message", {{"\ndistortion_model:", "\nP:["}}, kProjection},
      {"a KITTI calibration",
       {{"\nP0:"}, {"\nP2:"}, {"\nP_rect_00:"}, {"\nP_rect_02:"}},
       "Of the projection matrices of the pair that was imported, P0 and P1 (grey) or P2 and P3 (colour): fx = P0[0], "
       "fy "
       "= P0[5], cx = P0[2], cy = P0[6], doffs = P1[2] - cx, baseline [m] = (P0[3] - P1[3]) / fx"},
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

/// @return null when nothing is recognised.
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

/// @param faults of the keys and their values.
[[noreturn]] void failUnreadable(const std::string& path, const std::string& text, const std::string& faults) {
  const Kind* kind = recognise(text);
  if (kind) fail(path, faults + "; it looks like " + kind->name + ". " + kind->conversion);
  fail(path, faults + ". " + kOwn);
}

std::string withUnit(const Key& key) { return std::string(key.name) + " [" + key.unit + "]"; }

/// The numbers by key.
std::map<std::string, double> readNumbers(const std::string& path) {
  const std::string text = readText(path);
  std::map<std::string, double> numbers;
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
      numbers[key.name] = number;
    } else {
      wrong += (wrong.empty() ? "" : ", ") + withUnit(key) + (value.IsScalar() ? " '" + value.Scalar() + "'" : "");
    }
  }
  if (missing.empty() && wrong.empty()) return numbers;
  failUnreadable(path, text,
                 (missing.empty() ? "" : "missing: " + missing) + (missing.empty() || wrong.empty() ? "" : "; ") +
                     (wrong.empty() ? "" : "no numbers: " + wrong) + syntax);
}

}  // namespace

StereoCalibration readCalibration(const std::string& path, cv::Size size_px) {
  const std::map<std::string, double> numbers = readNumbers(path);
  StereoCalibration calibration;
  calibration.size_px = size_px;
  calibration.fx_px = numbers.at("fx");
  calibration.fy_px = numbers.at("fy");
  calibration.cx_px = numbers.at("cx");
  calibration.cy_px = numbers.at("cy");
  calibration.cx_right_px = calibration.cx_px + numbers.at("doffs");
  calibration.baseline_m = numbers.at("baseline");
  try {
    return StereoGeometry(calibration).calibration();  // refuses impossible numbers
  } catch (const std::invalid_argument& error) {
    fail(path, error.what());
  }
}

}  // namespace flight_corridor::tools
