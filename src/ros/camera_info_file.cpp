#include "ros/camera_info_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace flight_corridor_ros {

namespace {

/// The keys of one file; remembers what is wrong with them.
class Keys {
 public:
  explicit Keys(const YAML::Node& file) : file_(file) {}

  template <typename Value>
  void read(const std::string& key, Value& value) try {
    value = file_[key].as<Value>();
  } catch (const YAML::Exception&) {
    wrong_ += " " + key;
  }

  /// The numbers of a matrix.
  std::vector<double> readData(const std::string& key) try {
    return file_[key]["data"].as<std::vector<double>>();
  } catch (const YAML::Exception&) {
    wrong_ += " " + key;
    return {};
  }

  template <typename Array>
  void readMatrix(const std::string& key, Array& array) {
    const std::vector<double> data = readData(key);
    if (data.size() == array.size()) {
      std::copy(data.begin(), data.end(), array.begin());
    } else if (!data.empty()) {
      wrong_ +=
          " " + key + " (" + std::to_string(data.size()) + " numbers, must be " + std::to_string(array.size()) + ")";
    }
  }

  void refuse(const std::string& what) { wrong_ += " " + what; }
  const std::string& wrong() const { return wrong_; }

 private:
  YAML::Node file_;
  std::string wrong_;
};

YAML::Node load(const std::string& path) try {
  const YAML::Node file = YAML::LoadFile(path);
  if (file.IsMap()) return file;
  throw std::invalid_argument(path + ": holds no calibration: camera_calibration writes one as YAML");
} catch (const YAML::Exception& error) {
  throw std::invalid_argument(path + ": " + error.what());
}

}  // namespace

sensor_msgs::CameraInfo readCameraInfo(const std::string& path) {
  Keys keys(load(path));
  sensor_msgs::CameraInfo info;
  keys.read("image_width", info.width);
  keys.read("image_height", info.height);
  keys.read("distortion_model", info.distortion_model);
  info.D = keys.readData("distortion_coefficients");
  keys.readMatrix("camera_matrix", info.K);
  keys.readMatrix("rectification_matrix", info.R);
  if (std::all_of(info.R.begin(), info.R.end(), [](double r) { return r == 0.0; })) {
    keys.refuse("rectification_matrix (all 0: image_proc would make black images)");
  }
  keys.readMatrix("projection_matrix", info.P);
  if (!keys.wrong().empty()) {
    throw std::invalid_argument(path + ": missing or wrong:" + keys.wrong() +
                                "; camera_calibration writes such a file");
  }
  return info;
}

}  // namespace flight_corridor_ros
