// Verdicts of stock methods on a bag, put together as one would today from the paper, OpenCV and OctoMap: what
// flight_corridor is held against. Each method judges each frame alone; a table for each of its thresholds, in replay's
// format.
//
// paper    BLOCKED when d_K < D. D_c is the WLS depth at the window's centre, d_L the LiDAR's range as if the LiDAR
// were
//          the camera; both go into a Kalman filter with the paper's measurement variances, no gate, and the process
//          noise that the paper lacks.
// window   BLOCKED when the nearest WLS depth in the corridor's window, projected at 4 m, is < D.
// octomap  the SGBM cloud by insertPointCloud into an empty OctoMap; BLOCKED when a leaf in the corridor's box holds N
//          points or more.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filled_disparity.hpp"
#include "flight_corridor/corridor/corridor.hpp"
#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "flight_corridor/range/range_fusion.hpp"
#include "paper_rule.hpp"
#include "ros/conversions.hpp"
#include "stock_octomap.hpp"
#include "tools/command_line.hpp"
#include "tools/csv.hpp"
#include "tools/progress.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace {

using namespace flight_corridor;
using tools::ResultRow;

constexpr std::array<double, 9> kDistances_m{2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 8.0};  // D; D_min is 4
constexpr std::array<int, 8> kPoints{1, 10, 20, 40, 60, 80, 120, 160};                      // N; OctoMap's own is 1
const CorridorConfig kCorridor;

template <typename Work>
double milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// @return +inf where no disparity is left: a WLS filter leaves no pixel out.
double depthOf(float disparity_px, const StereoGeometry& geometry) {
  return disparity_px > 0.0F ? geometry.depth(disparity_px) : kInfinity;
}

ResultRow row(const ros::Time& stamp, State state, double clear_distance_m, double total_ms) {
  ResultRow row;
  row.stamp = stamp;
  row.state = state;
  row.clear_distance_m = state == State::Free ? kInfinity : clear_distance_m;
  row.times.total_ms = total_ms;
  return row;
}

State nearer(double distance_m, double threshold_m) {
  if (std::isnan(distance_m)) return State::Unknown;
  return distance_m < threshold_m ? State::Blocked : State::Free;
}

std::string fileName(const char* method, double threshold, int decimals) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%s_%.*f.csv", method, decimals, threshold);
  return text.data();
}

class Yardsticks {
 public:
  explicit Yardsticks(const StereoGeometry& geometry)
      : geometry_(geometry), window_(bench::paperWindow(kCorridor, geometry)) {}

  void add(const RangeReading& lidar) {
    if (!(lidar.min_range_m <= lidar.range_m && lidar.range_m <= lidar.max_range_m)) return;
    fusion_.add(Sensor::Lidar, lidar.stamp_s, lidar.range_m, kFusion.lidar_variance_m2);
  }

  void add(const ros::Time& stamp, const cv::Mat& left, const cv::Mat& right) {
    const double filled_ms = milliseconds([&] { filled_.compute(left, right, geometry_, disparity_px_); });
    judgePaper(stamp, filled_ms);
    judgeWindow(stamp, filled_ms);
    judgeOctomap(stamp, left, right);
  }

  void write(const std::filesystem::path& folder) const {
    for (const auto& [name, rows] : tables_) tools::writeResults(folder / name, rows);
  }

 private:
  void judgePaper(const ros::Time& stamp, double filled_ms) {
    double fused_m = kNaN;
    const double own_ms = milliseconds([&] {
      const cv::Point centre = (window_.tl() + window_.br()) / 2;
      const double stereo_m = depthOf(disparity_px_.at<float>(centre), geometry_);
      if (std::isfinite(stereo_m)) fusion_.add(Sensor::Stereo, stamp.toSec(), stereo_m, kFusion.stereo_variance_m2);
      fused_m = fusion_.at(stamp.toSec()).range_m;
    });
    addByDistance("paper", stamp, fused_m, filled_ms + own_ms);
  }

  void judgeWindow(const ros::Time& stamp, double filled_ms) {
    double nearest_m = kInfinity;
    const double own_ms = milliseconds([&] {
      for (const float disparity_px : cv::Mat_<float>(disparity_px_(window_))) {
        nearest_m = std::min(nearest_m, depthOf(disparity_px, geometry_));
      }
    });
    addByDistance("window", stamp, nearest_m, filled_ms + own_ms);
  }

  void addByDistance(const char* method, const ros::Time& stamp, double distance_m, double total_ms) {
    for (const double threshold_m : kDistances_m) {
      tables_[fileName(method, threshold_m, 2)].push_back(
          row(stamp, nearer(distance_m, threshold_m), distance_m, total_ms));
    }
  }

  void judgeOctomap(const ros::Time& stamp, const cv::Mat& left, const cv::Mat& right) {
    const double total_ms = milliseconds([&] { octomap_.insert(left, right); });
    for (const int enough : kPoints) {
      const double clear_m = octomap_.clearDistance(box_, enough);
      const State state = octomap_.empty() ? State::Unknown : nearer(clear_m, kCorridor.length_m);
      tables_[fileName("octomap", enough, 0)].push_back(row(stamp, state, clear_m, total_ms));
    }
  }

  inline static const FusionConfig kFusion = bench::paperFusion();
  StereoGeometry geometry_;
  cv::Rect window_;
  Box box_ = corridorBox(kCorridor, opticalFromForward());
  bench::FilledDisparity filled_;
  bench::StockOctomap octomap_{geometry_};
  RangeFusion fusion_{kFusion};
  cv::Mat disparity_px_;
  std::map<std::string, std::vector<ResultRow>> tables_;
};

void judge(const std::string& path, const std::string& folder) {
  namespace shell = flight_corridor_ros;
  const tools::StereoBagReader bag(path, tools::StereoTopics());
  std::optional<Yardsticks> yardsticks;
  std::vector<RangeReading> early;  // before the geometry is known by the first pair
  tools::Progress progress("yardsticks", bag.leftImages());
  tools::StereoBagReader::Listener listener;
  listener.on_range = [&](const sensor_msgs::RangeConstPtr& range) {
    const RangeReading reading = shell::toReading(*range);
    yardsticks ? yardsticks->add(reading) : early.push_back(reading);
  };
  listener.on_pair = [&](const tools::StereoMessages& pair) {
    if (!yardsticks) {
      yardsticks.emplace(StereoGeometry(shell::toCalibration(*pair.left_info, *pair.right_info)));
      for (const RangeReading& reading : early) yardsticks->add(reading);
    }
    yardsticks->add(pair.left->header.stamp, shell::toGrey(pair.left)->image, shell::toGrey(pair.right)->image);
    progress.advance();
  };
  bag.play({}, listener);
  if (!yardsticks) throw std::runtime_error(path + ": no stereo pair");
  std::filesystem::create_directories(folder);
  yardsticks->write(folder);
}

}  // namespace

int main(int argc, char** argv) {
  std::string bag, folder;
  CLI::App app("Verdicts of stock methods on a bag.", "yardsticks");
  app.add_option("--bag", bag, "bag to read")->type_name("F.bag")->required();
  app.add_option("--out", folder,
                 "folder for METHOD_THRESHOLD.csv: paper and window by distance [m],\noctomap by points")
      ->type_name("DIR")
      ->required();
  app.footer("paper: d_K < D. window: nearest depth in the projected window < D. octomap: SGBM by insertPointCloud.");
  return tools::runTool(app, argc, argv, [&] { judge(bag, folder); });
}
