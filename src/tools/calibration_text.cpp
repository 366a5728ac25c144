#include "tools/calibration_text.hpp"

#include <sensor_msgs/distortion_models.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>

#include "tools/calibration_file.hpp"

namespace flight_corridor::tools {
namespace {

namespace models = sensor_msgs::distortion_models;
using Numbers = std::vector<double>;

constexpr std::ptrdiff_t kPlumbBob = 5;  // coefficients
constexpr double kMetresPerMillimetre = 0.001;

const std::string& onlyText(const CalibrationTexts& texts) {
  if (texts.size() != 1) throw std::runtime_error("holds both cameras: give it alone");
  return texts.front();
}

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

/// The values of lines "KEY SEPARATOR VALUE"; under a line "[SECTION]" the key is "section:key". Keys in small letters.
std::map<std::string, std::string> readLines(const std::string& text, char separator) {
  std::map<std::string, std::string> values;
  std::istringstream lines(text);
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line);
    const std::size_t at = line.find(separator);
    if (!line.empty() && line.front() == '[') {
      section = line.substr(1, line.find(']') - 1) + ":";
    } else if (at != std::string::npos) {
      std::string key = section + trimmed(line.substr(0, at));
      std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
      values[key] = trimmed(line.substr(at + 1));
    }
  }
  return values;
}

/// @param count how many are wanted.
Numbers parse(const std::string& key, std::string text, std::size_t count) {
  for (char& c : text) {
    if (c == '[' || c == ']' || c == ';') c = ' ';
  }
  std::istringstream words(text);
  Numbers numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (*end != '\0' || !std::isfinite(numbers.back())) {
      throw std::runtime_error(key + ": '" + word + "' is not a finite number");
    }
  }
  if (numbers.size() == count) return numbers;
  throw std::runtime_error(key + ": holds " + std::to_string(numbers.size()) + " numbers, wanted are " +
                           std::to_string(count));
}

class Lines {
 public:
  Lines(const std::string& text, char separator) : values_(readLines(text, separator)) {}

  bool has(const std::string& key) const { return values_.count(key) > 0; }
  Numbers numbers(const std::string& key, std::size_t count) const {
    if (!has(key)) throw std::runtime_error("missing: " + key);
    return parse(key, values_.at(key), count);
  }
  double number(const std::string& key) const { return numbers(key, 1).front(); }
  /// Of a key that may be missing.
  double numberOr0(const std::string& key) const { return has(key) ? number(key) : 0.0; }
  /// The first two must be there.
  Numbers all(const std::string& section, const std::vector<std::string>& keys) const {
    Numbers numbers{number(section + keys[0]), number(section + keys[1])};
    for (std::size_t i = 2; i < keys.size(); ++i) numbers.push_back(numberOr0(section + keys[i]));
    return numbers;
  }

 private:
  std::map<std::string, std::string> values_;
};

/// Checks that the file is for images of this size, if it states one.
void requireSize(const std::string& width, const std::string& height, const Numbers& size, const cv::Size& images) {
  if (size[0] == images.width && size[1] == images.height) return;
  std::ostringstream text;
  text << width << ", " << height << ": it is for images of " << size[0] << "x" << size[1] << ", these are "
       << images.width << "x" << images.height;
  throw std::runtime_error(text.str());
}

/// Where a camera stands: P = K [I | t].
Eigen::Vector3d positionOf(const Numbers& P) {
  return {(P[3] - P[2] * P[11]) / P[0], (P[7] - P[6] * P[11]) / P[5], P[11]};
}

struct Resolution {
  cv::Size size_px;
  const char* name;
};
const Resolution kZedResolutions[] = {{{2208, 1242}, "2k"}, {{1920, 1080}, "fhd"},     {{1280, 720}, "hd"},
                                      {{672, 376}, "vga"},  {{1920, 1200}, "fhd1200"}, {{960, 600}, "svga"}};

/// Name of the resolution that the images have.
std::string zedResolution(const Lines& lines, const cv::Size& images) {
  std::string there;
  for (const Resolution& resolution : kZedResolutions) {
    if (!lines.has("left_cam_" + std::string(resolution.name) + ":fx")) continue;
    if (resolution.size_px == images) return resolution.name;
    there += (there.empty() ? "" : ", ") + sizeText(resolution.size_px);
  }
  throw std::runtime_error("these images are " + sizeText(images) + ", it is for those of " +
                           (there.empty() ? "no size" : there) + "; if left and right are side by side, split them");
}

/// k1 to k4 without p1, p2 are a fisheye's; else the order is OpenCV's.
void readZedLens(const Lines& lines, const std::string& section, sensor_msgs::CameraInfo& camera) {
  const auto has = [&](const char* key) { return lines.has(section + key); };
  const bool is_fisheye = has("k4") && !has("p1") && !has("p2") && !has("k5") && !has("k6");
  const Numbers all =
      is_fisheye ? lines.all(section, {"k1", "k2", "k3", "k4"})
                 : lines.all(section, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"});
  if (is_fisheye && all[3] == 0.0) {
    throw std::runtime_error(section + "k4: is 0 without p1 and p2: write p1=0 and p2=0 if this is not a fisheye");
  }
  camera.D = all;
  camera.distortion_model = is_fisheye ? models::EQUIDISTANT : models::RATIONAL_POLYNOMIAL;
  if (is_fisheye || std::any_of(all.begin() + kPlumbBob, all.end(), [](double k) { return k != 0.0; })) return;
  camera.D.resize(kPlumbBob);
  camera.distortion_model = models::PLUMB_BOB;
}

sensor_msgs::CameraInfo readZedCamera(const Lines& lines, const std::string& section, const cv::Size& size) {
  const auto number = [&](const char* key) { return lines.number(section + key); };
  sensor_msgs::CameraInfo camera;
  camera.width = static_cast<std::uint32_t>(size.width);
  camera.height = static_cast<std::uint32_t>(size.height);
  camera.K = {number("fx"), 0, number("cx"), 0, number("fy"), number("cy"), 0, 0, 1};
  readZedLens(lines, section, camera);
  return camera;
}

}  // namespace

StereoCameras readKitti(const CalibrationTexts& texts, const ImageFormat& images) {
  const Lines lines(onlyText(texts), ':');
  const std::string stem = lines.has("p_rect_00") || lines.has("p_rect_02") ? "p_rect_0" : "p";
  const bool has_colour = lines.has(stem + "2"), has_grey = lines.has(stem + "0");
  const bool is_colour = has_colour && (images.is_colour || !has_grey);
  const std::string left_key = stem + (is_colour ? "2" : "0"), right_key = stem + (is_colour ? "3" : "1");
  const std::string size_key = "s_rect_0" + left_key.substr(left_key.size() - 1);
  if (lines.has(size_key)) requireSize(size_key, "rectified images", lines.numbers(size_key, 2), images.size_px);
  const Numbers left = lines.numbers(left_key, 12), right = lines.numbers(right_key, 12);
  StereoCalibration calibration;
  calibration.size_px = images.size_px;
  calibration.fx_px = left[0];
  calibration.fy_px = left[5];
  calibration.cx_px = left[2];
  calibration.cy_px = left[6];
  calibration.cx_right_px = right[2];
  calibration.baseline_m = positionOf(left).x() - positionOf(right).x();
  return camerasOf(StereoGeometry(calibration).calibration());
}

StereoCameras readMiddlebury(const CalibrationTexts& texts, const ImageFormat& images) {
  const Lines lines(onlyText(texts), '=');
  if (lines.has("width") && lines.has("height")) {
    requireSize("width", "height", {lines.number("width"), lines.number("height")}, images.size_px);
  }
  const Numbers K = lines.numbers("cam0", 9);
  StereoCalibration calibration;
  calibration.size_px = images.size_px;
  calibration.fx_px = K[0];
  calibration.fy_px = K[4];
  calibration.cx_px = K[2];
  calibration.cy_px = K[5];
  calibration.cx_right_px = K[2] + lines.number("doffs");
  calibration.baseline_m = lines.number("baseline") * kMetresPerMillimetre;
  return camerasOf(StereoGeometry(calibration).calibration());
}

/// Model: x_right = R x_left - (Baseline, TY, TZ), R of the rotation vector (RX, CV, RZ). Source: stereolabs' samples.
StereoCameras readZed(const CalibrationTexts& texts, const ImageFormat& images) {
  const Lines lines(onlyText(texts), '=');
  const std::string name = zedResolution(lines, images.size_px);
  // Some files write TY and TZ for each resolution, others once.
  const auto shift = [&](const std::string& key) {
    return lines.has(key + "_" + name) ? lines.number(key + "_" + name) : lines.numberOr0(key);
  };
  const Eigen::Vector3d rotation(lines.number("stereo:rx_" + name), lines.number("stereo:cv_" + name),
                                 lines.number("stereo:rz_" + name));
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();
  if (rotation.norm() > 0.0) T_right_left.rotate(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()));
  T_right_left.translation() =
      -kMetresPerMillimetre * Eigen::Vector3d(lines.number("stereo:baseline"), shift("stereo:ty"), shift("stereo:tz"));
  return align({readZedCamera(lines, "left_cam_" + name + ":", images.size_px),
                readZedCamera(lines, "right_cam_" + name + ":", images.size_px)},
               T_right_left);
}

}  // namespace flight_corridor::tools
