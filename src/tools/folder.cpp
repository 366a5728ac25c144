#include "tools/folder.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "flight_corridor/corridor/corridor.hpp"
#include "ros/conversions.hpp"
#include "tools/calibration_file.hpp"
#include "tools/csv.hpp"
#include "tools/score.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestPeriod_s = 10.0;  // of a recording that anybody flies by
constexpr std::size_t kStampDigits = 19;   // of nanoseconds since 1970, today
constexpr double kFarthest_m = 200.0;      // that a LiDAR of an aircraft measures
constexpr double kFarthestWhole_m = 20.0;  // that somebody may have written without decimals
constexpr double kUsualRanges_m[] = {0.2, 50.0};

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw std::runtime_error(path.string() + ": " + what);
}

cv::Mat readImage(const std::string& path) {
  const cv::Mat image = cv::imread(path, cv::IMREAD_ANYCOLOR);
  if (image.empty()) fail(path, "is not a readable image");
  return image;
}

void requireSize(const cv::Mat& image, cv::Size size, const std::string& path) {
  if (image.size() == size) return;
  fail(path, "is " + sizeText(image.size()) + ", the recording's first image is " + sizeText(size));
}

/// Whether a file is called by a whole number.
bool isNumber(const fs::path& path) {
  const std::string stem = path.stem().string();
  return std::all_of(stem.begin(), stem.end(), [](unsigned char c) { return std::isdigit(c); });
}

struct Layout {
  const char *left, *right;
};
constexpr Layout kLayouts[] = {{"left", "right"},
                               {"mav0/cam0/data", "mav0/cam1/data"},
                               {"cam0/data", "cam1/data"},
                               {"image_2", "image_3"},
                               {"image_0", "image_1"}};

const Layout& layoutOf(const fs::path& folder) {
  for (const Layout& layout : kLayouts) {
    if (fs::is_directory(folder / layout.left)) return layout;
  }
  fail(folder / kLayouts[0].left, "no such folder");
}

/// Whether an image is called by the nanoseconds of its stamp, of the years 2001 to 2096.
bool isStamp(const fs::path& path) {
  const std::string stem = path.stem().string();
  return isNumber(path) && stem.size() == kStampDigits && '1' <= stem[0] && stem[0] <= '3';
}

std::vector<ImagePair> listPairs(const fs::path& folder) {
  const Layout& layout = layoutOf(folder);
  const fs::path left = folder / layout.left;
  std::vector<ImagePair> pairs;
  for (const fs::directory_entry& entry : fs::directory_iterator(left)) {
    const fs::path right = folder / layout.right / entry.path().filename();
    if (fs::exists(right)) {
      pairs.push_back({entry.path().string(), right.string()});
    } else if (!isStamp(right) || !fs::is_directory(folder / layout.right)) {  // else one that the camera dropped
      fail(right, "is missing, but " + entry.path().string() + " is there");
    }
  }
  if (pairs.empty()) fail(left, "holds no images");
  std::sort(pairs.begin(), pairs.end(), [](const ImagePair& a, const ImagePair& b) {
    const bool is_number = isNumber(a.left);
    if (is_number != isNumber(b.left)) return is_number;
    return is_number ? strverscmp(a.left.c_str(), b.left.c_str()) < 0 : a.left < b.left;  // 2.png before 10.png
  });
  return pairs;
}

/// Files that the folder holds itself.
std::vector<std::string> calibrationOf(const fs::path& folder) {
  static const std::vector<std::vector<std::string>> usual{{"calib.yaml"},
                                                           {"calib.txt"},
                                                           {"mav0/cam0/sensor.yaml", "mav0/cam1/sensor.yaml"},
                                                           {"cam0/sensor.yaml", "cam1/sensor.yaml"},
                                                           {"left.yaml", "right.yaml"}};
  std::vector<std::string> paths;
  for (const std::vector<std::string>& names : usual) {
    if (!fs::exists(folder / names.front())) continue;
    for (const std::string& name : names) paths.push_back((folder / name).string());
    return paths;
  }
  return {(folder / "calib.yaml").string()};
}

/// Stamps in a smaller unit, counted from the recording's start, look like seconds that are far apart.
void requireSeconds(const std::vector<ros::Time>& stamps, const fs::path& path) {
  if (stamps.size() < 2) return;
  const double period_s = (stamps.back() - stamps.front()).toSec() / static_cast<double>(stamps.size() - 1);
  if (period_s <= kLongestPeriod_s) return;
  fail(path, "column 'stamp_s': the pairs are " + std::to_string(period_s) + " s apart, more than " +
                 std::to_string(kLongestPeriod_s) + " s: are these milliseconds, microseconds or nanoseconds? Divide");
}

ros::Time stampOf(const fs::path& image) {
  ros::Time stamp;
  return stamp.fromNSec(std::stoull(image.stem().string()));
}

std::vector<Stamped<ImagePair>> stampPairs(const fs::path& folder, double rate_hz) {
  const std::vector<ImagePair> pairs = listPairs(folder);
  std::vector<Stamped<ImagePair>> stamped;
  const fs::path path = folder / "timestamps.csv";
  if (!fs::exists(path)) {
    const bool are_stamps =
        std::all_of(pairs.begin(), pairs.end(), [](const auto& pair) { return isStamp(pair.left); });
    for (const ImagePair& pair : pairs) {
      stamped.push_back({are_stamps ? stampOf(pair.left) : ros::Time(stamped.size() / rate_hz), pair});
    }
    return stamped;
  }
  const CsvTable table(path.string());
  const std::vector<ros::Time> stamps = table.stamps("stamp_s");
  if (stamps.size() != pairs.size()) {
    fail(path, std::to_string(stamps.size()) + " stamps, but left/ holds " + std::to_string(pairs.size()) + " images");
  }
  requireSeconds(stamps, path);
  for (std::size_t i = 0; i < pairs.size(); ++i) stamped.push_back({stamps[i], pairs[i]});
  return stamped;
}

/// In which unit such ranges are metres that a LiDAR measures.
std::string likelyUnits(double range) {
  std::string text;
  for (const auto& [unit, metres] : {std::pair("mm", 0.001), std::pair("cm", 0.01)}) {
    const double range_m = range * metres;
    if (!(kUsualRanges_m[0] <= range_m && range_m <= kUsualRanges_m[1])) continue;
    std::ostringstream value;
    value << unit << " (" << range_m << " m)";
    text += (text.empty() ? "likely in " : ", or in ") + value.str();
  }
  return text.empty() ? "in which unit?" : text;
}

/// Half the ranges are farther than a LiDAR measures, or all are whole numbers, as sensors send mm and cm.
void requireMetres(const CsvTable& table, const fs::path& path) {
  if (!table.has("range_m")) throw std::runtime_error(table.missing("range_m") + ". Wanted are metres under this name");
  std::vector<double> ranges;
  bool are_whole = true;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string& cell = table.text(i, "range_m");
    const double range = cell.empty() ? kNaN : table.number(i, "range_m");
    if (!std::isfinite(range)) continue;
    ranges.push_back(range);
    are_whole = are_whole && cell.find_first_not_of("0123456789") == std::string::npos;
  }
  if (ranges.empty()) return;
  const double middle = quantile(ranges, 0.5);
  const bool are_far = middle > kFarthest_m;
  if (!are_far && !(are_whole && middle > kFarthestWhole_m)) return;
  std::ostringstream text;
  text << "column 'range_m': half the ranges are " << middle << " or more, "
       << (are_far ? "farther than a LiDAR measures: " : "and all are whole numbers: ") << likelyUnits(middle)
       << ". Divide to metres" << (are_far ? "" : "; if they are metres, write decimals, 12.0");
  fail(path, text.str());
}

std::vector<Stamped<double>> readRanges(const fs::path& path) {
  std::vector<Stamped<double>> ranges_m;
  if (!fs::exists(path)) return ranges_m;
  const CsvTable table(path.string());
  const std::vector<ros::Time> stamps = table.stamps("stamp_s");
  if (!stamps.empty()) requireMetres(table, path);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (table.text(i, "range_m").empty()) continue;  // no reading
    const double range_m = table.number(i, "range_m");
    if (std::isfinite(range_m) && range_m < 0.0) table.fail(i, "range_m", "a range is not negative; too close is -inf");
    ranges_m.push_back({stamps[i], range_m});
  }
  return ranges_m;
}

std::vector<Stamped<Eigen::Isometry3d>> readPoses(const fs::path& path, const Eigen::Isometry3d& T_C_B) {
  std::vector<Stamped<Eigen::Isometry3d>> poses_W_B;
  if (!fs::exists(path)) return poses_W_B;
  const CsvTable table(path.string());
  const std::vector<ros::Time> stamps = table.stamps("stamp_s");
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto number = [&](const char* column) { return table.number(i, column); };
    const Eigen::Quaterniond rotation(number("qw"), number("qx"), number("qy"), number("qz"));
    if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) table.fail(i, "qw", "the quaternion's norm is not 1");
    Eigen::Isometry3d T_W_C(rotation.normalized());
    T_W_C.translation() = Eigen::Vector3d(number("tx"), number("ty"), number("tz"));
    if (!T_W_C.translation().allFinite()) table.fail(i, "tx", "the position is not finite");
    poses_W_B.push_back({stamps[i], T_W_C * T_C_B});
  }
  return poses_W_B;
}

template <typename Value>
void shift(std::vector<Stamped<Value>>& items, const ros::Duration& by) {
  for (Stamped<Value>& item : items) item.stamp += by;
}

ros::Time start(const FolderRecording& recording) {
  ros::Time first = recording.pairs.front().stamp;
  for (const auto& range : recording.ranges_m) first = std::min(first, range.stamp);
  for (const auto& pose : recording.poses_W_B) first = std::min(first, pose.stamp);
  return first;
}

void readCameras(const std::vector<std::string>& calibration_files, const FolderReading& reading,
                 FolderRecording& recording) {
  const cv::Mat image = readImage(recording.pairs.front().value.left);
  recording.image_size_px = image.size();
  const StereoCameras cameras =
      readCalibration(calibration_files, {image.size(), image.channels() > 1, {}, reading.cameras});
  const bool are_raw = areRaw(reading.images, "", cameras);
  recording.calibration = describe(cameras, are_raw);
  if (are_raw) recording.rectifier = std::make_shared<const Rectifier>(cameras);
  if (!are_raw && cameras.is_rectification_computed && !areRectified(cameras)) {
    fail(calibration_files.front(),
         "is of raw images only, not how these were rectified: leave out --rectified if they are raw");
  }
  const StereoCameras ideal = rectified(cameras);
  recording.rig.calibration = flight_corridor_ros::toCalibration(ideal.left, ideal.right);
}

}  // namespace

FolderRecording readFolder(const std::string& folder, const FolderReading& reading) {
  if (!fs::is_directory(folder)) fail(folder, "no such folder");
  const fs::path path(folder);
  FolderRecording recording;
  recording.pairs = stampPairs(path, reading.rate_hz);
  readCameras(reading.calibration_files.empty() ? calibrationOf(path) : reading.calibration_files, reading, recording);
  recording.rig.T_B_C = opticalFromForward().inverse();
  recording.ranges_m = readRanges(path / "range.csv");
  recording.poses_W_B = readPoses(path / "poses.csv", opticalFromForward());
  if (start(recording) < ros::Time(1, 0)) {
    shift(recording.pairs, ros::Duration(1, 0));
    shift(recording.ranges_m, ros::Duration(1, 0));
    shift(recording.poses_W_B, ros::Duration(1, 0));
  }
  return recording;
}

void writeBag(const FolderRecording& recording, const std::string& bag_path, const std::function<void()>& on_pair) {
  StereoBagWriter bag(bag_path, recording.rig, start(recording));
  for (const auto& pose : recording.poses_W_B) bag.writePose(pose.stamp, pose.value);
  for (const auto& range : recording.ranges_m) {
    RangeReading reading;
    reading.range_m = range.value;
    bag.writeRange(range.stamp, reading);
  }
  for (const auto& pair : recording.pairs) {
    cv::Mat left = readImage(pair.value.left), right = readImage(pair.value.right);
    requireSize(left, recording.image_size_px, pair.value.left);
    requireSize(right, recording.image_size_px, pair.value.right);
    if (recording.rectifier) {
      left = recording.rectifier->left(left);
      right = recording.rectifier->right(right);
    }
    bag.writePair(pair.stamp, left, right);
    on_pair();
  }
  bag.close();
}

}  // namespace flight_corridor::tools
