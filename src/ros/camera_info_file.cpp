#include "ros/camera_info_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <boost/array.hpp>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace flight_corridor_ros {

namespace {

/// The keys of one file, or of one message; collects their faults.
class Keys {
 public:
  explicit Keys(const std::string& text) : yaml_(YAML::Load(text)), is_message_(yaml_.IsMap() && yaml_["K"]) {
    if (!yaml_.IsMap()) throw std::invalid_argument("holds no calibration: camera_calibration writes one as YAML");
  }

  template <typename Value>
  void read(const char* of_message, const char* of_file, Value& value) {
    const std::string key = is_message_ ? of_message : of_file;
    try {
      const YAML::Node node = yaml_[key];
      value = (node.IsMap() ? node["data"] : node).as<Value>();
    } catch (const YAML::Exception&) {
      wrong_ += " " + key;
    }
  }

  template <std::size_t Size>
  void read(const char* of_message, const char* of_file, boost::array<double, Size>& matrix) {
    std::vector<double> numbers;
    read(of_message, of_file, numbers);
    if (numbers.size() == Size) {
      std::copy(numbers.begin(), numbers.end(), matrix.begin());
    } else if (!numbers.empty()) {
      wrong_ += " (" + std::string(is_message_ ? of_message : of_file) + ": " + std::to_string(numbers.size()) +
                " numbers, must be " + std::to_string(Size) + ")";
    }
  }

  const std::string& wrong() const { return wrong_; }

 private:
  YAML::Node yaml_;
  bool is_message_;
  std::string wrong_;
};

}  // namespace

sensor_msgs::CameraInfo parseCameraInfo(const std::string& text) try {
  Keys keys(text);
  sensor_msgs::CameraInfo info;
  keys.read("width", "image_width", info.width);
  keys.read("height", "image_height", info.height);
  keys.read("distortion_model", "distortion_model", info.distortion_model);
  keys.read("D", "distortion_coefficients", info.D);
  keys.read("K", "camera_matrix", info.K);
  keys.read("R", "rectification_matrix", info.R);
  keys.read("P", "projection_matrix", info.P);
  if (keys.wrong().empty()) return info;
  throw std::invalid_argument("missing or wrong:" + keys.wrong() + "; camera_calibration writes such a file");
} catch (const YAML::Exception& error) {
  throw std::invalid_argument(error.what());
}

sensor_msgs::CameraInfo readCameraInfo(const std::string& path) try {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::invalid_argument("cannot be read");
  const sensor_msgs::CameraInfo info = parseCameraInfo({std::istreambuf_iterator<char>(file), {}});
  const bool has_rotation = std::any_of(info.R.begin(), info.R.end(), [](double r) { return r != 0.0; });
  if (has_rotation) return info;
  throw std::invalid_argument("rectification_matrix is all 0: image_proc would make black images with it");
} catch (const std::exception& error) {
  throw std::invalid_argument(path + ": " + error.what());
}

}  // namespace flight_corridor_ros
