#include "tools/calibration_yaml.hpp"

#include <sensor_msgs/distortion_models.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "flight_corridor/geometry/box.hpp"
#include "ros/camera_info_file.hpp"
#include "tools/calibration_file.hpp"
#include "tools/camera_chain.hpp"

namespace flight_corridor::tools {
namespace {

namespace models = sensor_msgs::distortion_models;
using sensor_msgs::CameraInfo;
using Numbers = std::vector<double>;

constexpr int kMostCameras = 16;  // of a chain
constexpr int kDeepestList = 2;   // a matrix as rows; an alias to itself has no end

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

/// OpenCV's XML as its YAML.
std::string yamlOf(const std::string& xml) try {
  const cv::FileStorage from(xml, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::FileStorage to(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  for (const cv::FileNode& node : from.root()) {
    if (node.isMap()) to << node.name() << node.mat();
    if (node.isString()) to << node.name() << node.string();
    if (node.isInt() || node.isReal()) to << node.name() << node.real();
    if (!node.isSeq()) continue;
    Numbers numbers;
    node >> numbers;
    to << node.name() << numbers;
  }
  return to.releaseAndGetString();
} catch (const cv::Exception& error) {
  fail("is not XML written by OpenCV: " + error.err);
}

/// OpenCV begins its files with "%YAML:1.0", which is not YAML.
std::string withoutVersion(std::string text) {
  if (text.rfind("%YAML", 0) == 0) text.erase(0, text.find('\n'));
  return text;
}

YAML::Node load(const std::string& text) {
  YAML::Node yaml = YAML::Load(withoutVersion(text.rfind("<?xml", 0) == 0 ? yamlOf(text) : text));
  if (!yaml.IsMap()) fail("holds no keys");
  return yaml;
}

void collect(const YAML::Node& node, int depth, Numbers& numbers) {
  double number = 0.0;
  if (node.IsSequence() && depth > 0) {
    for (const YAML::Node& item : node) collect(item, depth - 1, numbers);
  } else if (node.IsScalar() && YAML::convert<double>::decode(node, number) && std::isfinite(number)) {
    numbers.push_back(number);
  } else {
    fail(node.IsScalar() ? "'" + node.Scalar() + "' is not a finite number" : "wanted are numbers");
  }
}

/// The numbers at a key, of rows one after the other, also of a matrix {rows, cols, data}.
/// @param count how many are wanted; 0: any.
Numbers numbersAt(const YAML::Node& parent, const std::string& key, std::size_t count) {
  YAML::Node node = parent[key];
  if (!node) fail("missing: " + key);
  if (node.IsMap()) node.reset(node["data"]);
  if (!node) fail(key + ": missing: data");
  Numbers numbers;
  try {
    collect(node, kDeepestList, numbers);
  } catch (const std::runtime_error& error) {
    fail(key + ": " + error.what());
  }
  if (count == 0 || numbers.size() == count) return numbers;
  fail(key + ": holds " + std::to_string(numbers.size()) + " numbers, wanted are " + std::to_string(count));
}

std::string textAt(const YAML::Node& parent, const std::string& key) {
  const YAML::Node node = parent[key];
  return node && node.IsScalar() ? node.Scalar() : "";
}

std::uint32_t pixels(double number) { return 0.0 < number && number < 1e6 ? static_cast<std::uint32_t>(number) : 0; }

CameraInfo cameraOf(const Numbers& intrinsics, const Numbers& distortion, const std::string& model) {
  CameraInfo camera;
  camera.K = {intrinsics[0], 0, intrinsics[2], 0, intrinsics[1], intrinsics[3], 0, 0, 1};
  camera.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.D = distortion;
  camera.distortion_model = model;
  return camera;
}

void setSize(CameraInfo& camera, double width, double height) {
  camera.width = pixels(width);
  camera.height = pixels(height);
}

/// Of a rigid transform as 4 x 4 numbers.
Eigen::Isometry3d poseOf(const Numbers& numbers, const std::string& key) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(numbers.data());
  if (!isRotation(matrix.topLeftCorner<3, 3>(), kTyped)) fail(key + ": is not a rotation and translation");
  return Eigen::Isometry3d(matrix);
}

/// A camera of Kalibr or EuRoC.
/// @param distortion_key of the coefficients.
CameraInfo readPinhole(const YAML::Node& yaml, const std::string& distortion_key) {
  static const std::map<std::string, std::string> known{{"radtan", models::PLUMB_BOB},
                                                        {"radial-tangential", models::PLUMB_BOB},
                                                        {"equidistant", models::EQUIDISTANT},
                                                        {"none", models::PLUMB_BOB}};
  const std::string camera_model = textAt(yaml, "camera_model"), model = textAt(yaml, "distortion_model");
  if (camera_model != "pinhole") fail("camera_model '" + camera_model + "' is not supported; pinhole is");
  if (known.count(model) == 0) {
    fail("distortion_model '" + model + "' is not supported; radtan (radial-tangential), equidistant and none are");
  }
  const Numbers distortion = model == "none" ? Numbers(4) : numbersAt(yaml, distortion_key, 4);
  CameraInfo camera = cameraOf(numbersAt(yaml, "intrinsics", 4), distortion, known.at(model));
  const Numbers size = numbersAt(yaml, "resolution", 2);
  setSize(camera, size[0], size[1]);
  return camera;
}

/// The name that Kalibr gives a camera.
std::string nameOf(int number) { return "cam" + std::to_string(number); }
int numberOf(const std::string& name) { return std::stoi(name.substr(3)); }

std::vector<NamedCamera> namedCameras(const YAML::Node& yaml) {
  std::vector<NamedCamera> cameras;
  for (int i = 0; i < kMostCameras; ++i) {
    const YAML::Node camera = yaml[nameOf(i)];
    if (camera && camera.IsMap()) cameras.push_back({nameOf(i), textAt(camera, "rostopic")});
  }
  return cameras;
}

/// The result of `read`; its errors begin with the name.
template <typename Read>
auto naming(const std::string& name, const Read& read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    fail(name + ": " + error.what());
  }
}

/// Of one camera of a chain in another.
Eigen::Isometry3d poseInChain(const YAML::Node& yaml, int camera, int in_camera) {
  if (in_camera < camera) return poseInChain(yaml, in_camera, camera).inverse();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int i = camera + 1; i <= in_camera; ++i) {
    if (!yaml[nameOf(i)]) fail("missing: " + nameOf(i));
    T = naming(nameOf(i), [&] { return poseOf(numbersAt(yaml[nameOf(i)], "T_cn_cnm1", 16), "T_cn_cnm1"); }) * T;
  }
  return T;
}

void requireTwo(const CalibrationTexts& texts) {
  if (texts.size() != 2) fail("holds one camera: give both files, left and right");
}

/// One of several names for the same in OpenCV's files.
/// @return "" if none exists.
std::string findKey(const YAML::Node& yaml, const std::vector<std::string>& names) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& name) { return bool(yaml[name]); });
  return found == names.end() ? "" : *found;
}

/// Names under which one camera's matrix is written.
std::vector<std::string> namesOf(const std::vector<std::string>& stems, bool is_left) {
  std::vector<std::string> names;
  for (const std::string& stem : stems) {
    for (const std::string suffix :
         {is_left ? "1" : "2", is_left ? "_left" : "_right", is_left ? "_l" : "_r", is_left ? "L" : "R"})
      names.push_back(stem + suffix);
    names.push_back((is_left ? "LEFT." : "RIGHT.") + stem);
    names.push_back((is_left ? "left_" : "right_") + stem);
  }
  return names;
}

CameraInfo readOpenCvCamera(const YAML::Node& yaml, bool is_left) {
  const std::string K_key =
      findKey(yaml, namesOf({"K", "M", "cameraMatrix", "camera_matrix_", "camera_matrix"}, is_left));
  const std::string D_key =
      findKey(yaml, namesOf({"D", "distCoeffs", "dist_coeffs_", "dist_coeffs", "distortion_coefficients"}, is_left));
  const std::string R_key = findKey(yaml, namesOf({"R"}, is_left)), P_key = findKey(yaml, namesOf({"P"}, is_left));
  CameraInfo camera;
  camera.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto copy = [&](const std::string& key, auto& to) {
    const Numbers numbers = numbersAt(yaml, key, to.size());
    std::copy(numbers.begin(), numbers.end(), to.begin());
  };
  if (!P_key.empty()) copy(P_key, camera.P);
  if (!R_key.empty()) copy(R_key, camera.R);
  if (!K_key.empty()) copy(K_key, camera.K);
  if (!D_key.empty()) camera.D = numbersAt(yaml, D_key, 0);
  const std::string side = is_left ? "1" : "2";
  if (K_key.empty() != D_key.empty()) fail("missing: " + std::string(K_key.empty() ? "K" : "D") + side);
  if (K_key.empty() && (P_key.empty() || !R_key.empty())) fail("missing: K" + side + ", D" + side);
  if (!K_key.empty() && P_key.empty() != R_key.empty())
    fail("missing: " + std::string(P_key.empty() ? "P" : "R") + side);
  camera.distortion_model = camera.D.size() > 5 ? models::RATIONAL_POLYNOMIAL : models::PLUMB_BOB;
  for (const char* key : {"model", "camera_model", "distortion_model"}) {
    const std::string model = textAt(yaml, key);
    if (model == "fisheye" || model == "equidistant") camera.distortion_model = models::EQUIDISTANT;
  }
  return camera;
}

/// The size, under the names that OpenCV's samples and tutorials write; else that of the images.
void setOpenCvSize(const YAML::Node& yaml, const ImageFormat& images, CameraInfo& camera) {
  setSize(camera, images.size_px.width, images.size_px.height);
  const std::string width = findKey(yaml, {"image_width", "imageWidth", "width", "image_Width", "imageSize_width"});
  const std::string height =
      findKey(yaml, {"image_height", "imageHeight", "height", "image_Height", "imageSize_height"});
  if (!width.empty() && !height.empty()) {
    setSize(camera, numbersAt(yaml, width, 1)[0], numbersAt(yaml, height, 1)[0]);
  }
}

}  // namespace

StereoCameras readKalibr(const CalibrationTexts& texts, const ImageFormat& images) {
  if (texts.size() != 1) fail("holds both cameras: give it alone");
  const YAML::Node yaml = load(texts.front());
  const PairNames pair = choosePair(namedCameras(yaml), images.cameras, images.topics);
  const auto read = [&](const std::string& name) {
    return naming(name, [&] { return readPinhole(yaml[name], "distortion_coeffs"); });
  };
  StereoCameras cameras =
      align({read(pair.left), read(pair.right)}, poseInChain(yaml, numberOf(pair.left), numberOf(pair.right)));
  cameras.names = pair;
  if (!(cameras.right.P[3] > 0.0)) return cameras;
  fail(pair.right + " stands to the left of " + pair.left +
       ": are the images exchanged (--left, --right), or the "
       "file's cameras (--calib-left " +
       pair.right + " --calib-right " + pair.left + ")?");
}

StereoCameras readEuroc(const CalibrationTexts& texts, const ImageFormat&) {
  requireTwo(texts);
  const YAML::Node left = load(texts[0]), right = load(texts[1]);
  const Eigen::Isometry3d T_B_left = poseOf(numbersAt(left, "T_BS", 16), "T_BS");
  const Eigen::Isometry3d T_B_right = poseOf(numbersAt(right, "T_BS", 16), "T_BS");
  return align({readPinhole(left, "distortion_coefficients"), readPinhole(right, "distortion_coefficients")},
               T_B_right.inverse() * T_B_left);
}

StereoCameras readRos(const CalibrationTexts& texts, const ImageFormat&) {
  requireTwo(texts);
  using flight_corridor_ros::parseCameraInfo;
  return {parseCameraInfo(withoutVersion(texts[0])), parseCameraInfo(withoutVersion(texts[1]))};
}

StereoCameras readOpenCv(const CalibrationTexts& texts, const ImageFormat& images) {
  YAML::Node yaml;
  for (const std::string& text : texts) {  // OpenCV's sample writes intrinsics.yml and extrinsics.yml
    for (const auto& entry : load(text)) {
      if (entry.first.IsScalar()) yaml[entry.first.Scalar()] = entry.second;
    }
  }
  StereoCameras cameras{readOpenCvCamera(yaml, true), readOpenCvCamera(yaml, false)};
  setOpenCvSize(yaml, images, cameras.left);
  setOpenCvSize(yaml, images, cameras.right);
  if (!findKey(yaml, namesOf({"P"}, true)).empty()) {
    if (findKey(yaml, namesOf({"P"}, false)).empty()) fail("missing: P2");
    return cameras;
  }
  Numbers R = numbersAt(yaml, "R", 0);
  const Numbers t = numbersAt(yaml, "T", 3);
  if (R.size() != 9) fail("R: holds " + std::to_string(R.size()) + " numbers, wanted are 9");
  return align(cameras,
               poseOf({R[0], R[1], R[2], t[0], R[3], R[4], R[5], t[1], R[6], R[7], R[8], t[2], 0, 0, 0, 1}, "R"));
}

}  // namespace flight_corridor::tools
