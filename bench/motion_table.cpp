// Motion by the images against the poses of bags: errors over half a second, and what it costs.
//   motion_table FRAME F.bag...       FRAME: the fixed frame of tf
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <string>
#include <vector>

#include "flight_corridor/motion/camera_motion.hpp"
#include "flight_corridor/stereo/disparity_estimator.hpp"
#include "ros/conversions.hpp"
#include "ros/transforms.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace {

using namespace flight_corridor;
using Clock = std::chrono::steady_clock;

constexpr double kOver_s = 0.5, kClaimed_m = 0.03;

struct Place {
  double stamp_s;
  CameraPose seen;
  Eigen::Isometry3d T_W_C;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNaN;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

void run(const std::string& path, const std::string& frame) {
  tools::StereoBagReader reader(path, {"", "", "", "", "", "", ""});
  flight_corridor_ros::Transforms transforms;
  std::optional<StereoGeometry> geometry;
  std::optional<DisparityEstimator> estimator;
  std::optional<CameraMotion> by_images, told;
  Disparity disparity;
  const ScaleCorrection correction{ScaleConfig()};
  std::deque<Place> places;
  std::vector<double> errors_m, errors_rad, ratios, ms, moved_m;
  int pairs = 0, lost = 0, unclaimed = 0, wrong = 0, contradictions = 0;
  tools::StereoBagReader::Listener listener;
  listener.on_transform = [&](const auto& transform, bool is_static) { transforms.add(transform, is_static); };
  listener.on_range = [](const auto&) {};
  listener.on_pair = [&](const tools::RecordedPair& pair) {
    if (!geometry) {
      geometry.emplace(flight_corridor_ros::toCalibration(*pair.left_info, *pair.right_info));
      estimator.emplace(StereoConfig(), *geometry, 0.05);
      by_images.emplace(*geometry);
      told.emplace(*geometry);
    }
    const StereoFrame images{pair.header.stamp.toSec(), flight_corridor_ros::toGrey(pair.left)->image,
                             flight_corridor_ros::toGrey(pair.right)->image};
    estimator->estimate(images, disparity);
    const auto T_W_C = transforms.find(frame, pair.header.frame_id, pair.header.stamp);
    if (!T_W_C) return;
    ++pairs;
    const auto begin = Clock::now();
    by_images->update(images.stamp_s, images.left, disparity.best_px, correction, std::nullopt);
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    told->update(images.stamp_s, images.left, disparity.best_px, correction, T_W_C);
    contradictions += told->witness().contradicts();
    if (told->witness().contradicts() && std::getenv("LOG")) {
      const Way& w = told->witness().way();
      std::printf("LOG %.2f way %.1f s told %.3f %.3f %.3f seen %.3f %.3f %.3f m, %.3f %.3f %.3f; %.3f %.3f %.3f rad\n",
                  images.stamp_s, w.duration_s, w.told_m.x(), w.told_m.y(), w.told_m.z(), w.seen_m.x(), w.seen_m.y(),
                  w.seen_m.z(), w.told_rad.x(), w.told_rad.y(), w.told_rad.z(), w.seen_rad.x(), w.seen_rad.y(),
                  w.seen_rad.z());
    }
    const auto& pose = by_images->pose();
    if (!pose) {
      lost += pairs > 1;
      return;
    }
    places.push_back({images.stamp_s, *pose, *T_W_C});
    const Place& place = places.back();
    while (places.size() > 1 &&
           (place.stamp_s - places[1].stamp_s >= kOver_s - 1e-3 || places[0].seen.series != pose->series))
      places.pop_front();
    const Place& then = places.front();
    if (place.stamp_s - then.stamp_s < kOver_s - 1e-3) return;
    const double sigma_m = std::sqrt(varianceBetween(then.seen.translation, place.seen.translation));
    if (!(sigma_m <= kClaimed_m / 3.0)) {
      ++unclaimed;
      return;
    }
    const Eigen::Isometry3d truth = then.T_W_C.inverse() * place.T_W_C,
                            seen = then.seen.T_M_C.inverse() * place.seen.T_M_C;
    const Eigen::Isometry3d off = truth.inverse() * seen;
    errors_m.push_back(off.translation().norm());
    errors_rad.push_back(Eigen::AngleAxisd(off.linear()).angle());
    ratios.push_back(errors_m.back() / std::max(sigma_m, 1e-6));
    moved_m.push_back(truth.translation().norm());
    wrong += errors_m.back() > kClaimed_m || errors_rad.back() > 0.3 * M_PI / 180.0;
  };
  reader.play(flight_corridor_ros::RosConfig(), listener);
  std::printf(
      "%-28s %4d pairs, lost %3d, unclaimed %3d, claimed %4zu, wrong %3d | moved %.2f m: %.3f m (p95 %.3f, max %.3f), "
      "%.2f deg (p95 %.2f) | of sigma %.1f (p95 %.1f) | %.2f ms (p99 %.2f) | contradicts %d\n",
      path.substr(path.rfind('/') + 1).c_str(), pairs, lost, unclaimed, errors_m.size(), wrong, quantile(moved_m, 0.5),
      quantile(errors_m, 0.5), quantile(errors_m, 0.95), quantile(errors_m, 1.0),
      quantile(errors_rad, 0.5) * 180 / M_PI, quantile(errors_rad, 0.95) * 180 / M_PI, quantile(ratios, 0.5),
      quantile(ratios, 0.95), quantile(ms, 0.5), quantile(ms, 0.99), contradictions);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) run(argv[i], argv[1]);
}
