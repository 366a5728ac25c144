#include "tools/fly_pictures.hpp"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "flight_corridor/view/overlay.hpp"
#include "tools/pictures.hpp"

namespace flight_corridor::tools {
namespace {

constexpr int kHeight_px = 480;
constexpr double kPxPerMetre = 24.0;           // from above
constexpr double kBeside_m = 10.0;             // of the way, shown from above
constexpr double kLow_m = 0.4, kHigh_m = 2.4;  // what lies below or above is not shown
const cv::Scalar kPaper(245, 245, 245), kSolid(90, 90, 90), kPerson(60, 60, 200), kTrail(200, 110, 0), kGoal(0, 150, 0);

/// Points whose hull from above is that of a primitive.
std::vector<Eigen::Vector3d> outline(const sim::Primitive& primitive) {
  std::vector<Eigen::Vector3d> points;
  const Eigen::Vector3d& half_m = primitive.half_m;
  constexpr int kRound = 16;
  for (int i = 0; i < kRound; ++i) {
    const double angle_rad = 2.0 * M_PI * i / kRound;
    const Eigen::Vector3d around(std::cos(angle_rad), std::sin(angle_rad), 0.0);
    for (const double end : {-1.0, 1.0}) {
      switch (primitive.shape) {
        case sim::Shape::Box:
          points.push_back(primitive.T_W_O * half_m.cwiseProduct(Eigen::Vector3d((i & 1) != 0 ? 1.0 : -1.0,
                                                                                 (i & 2) != 0 ? 1.0 : -1.0, end)));
          break;
        case sim::Shape::Cylinder:
          points.push_back(primitive.T_W_O * (half_m.x() * around + end * half_m.z() * Eigen::Vector3d::UnitZ()));
          break;
        case sim::Shape::Sphere:
        case sim::Shape::Foliage:
          points.push_back(primitive.T_W_O.translation() + half_m.x() * (around + end * Eigen::Vector3d::UnitZ()));
          break;
      }
    }
  }
  return points;
}

}  // namespace

FlyPictures::FlyPictures(const sim::ClosedLoop& loop, const std::string& title, const std::string& video,
                         double rate_hz)
    : world_(loop.world()),
      geometry_(loop.calibration()),
      T_B_C_(loop.T_B_C()),
      title_(title),
      video_path_(video),
      rate_hz_(rate_hz) {}

void FlyPictures::add(const sim::Observation& observation, const sim::Way& way, const AreaGrid* areas,
                      const Eigen::Isometry3d& T_W_F) {
  trail_W_.push_back(observation.own.T_W_B.translation());
  drawCamera(observation, way, areas, T_W_F);
  drawFromAbove(observation, way);
  cv::hconcat(camera_, above_, picture_);
  if (!video_path_.empty()) addToVideo(picture_, video_path_, rate_hz_, video_);
}

void FlyPictures::write(const std::string& path, const std::string& caption) {
  if (picture_.empty()) return;
  writeCaption(caption, above_);
  cv::hconcat(camera_, above_, picture_);
  if (!cv::imwrite(path, picture_)) throw std::runtime_error(path + ": cannot be written");
}

/// Each direction as a spot 4 m ahead in its state's colour, the best one ringed.
void FlyPictures::drawCamera(const sim::Observation& observation, const sim::Way& way, const AreaGrid* areas,
                             const Eigen::Isometry3d& T_W_F) {
  constexpr double kAhead_m = 4.0;
  const cv::Mat& left = observation.pair.left;
  const double scale = static_cast<double>(kHeight_px) / left.rows;
  cv::cvtColor(left, camera_, cv::COLOR_GRAY2BGR);
  cv::resize(camera_, camera_, {}, scale, scale, cv::INTER_LINEAR);
  const Eigen::Isometry3d T_C_W = (observation.own.T_W_B * T_B_C_).inverse();
  const auto spot = [&](const Eigen::Vector3d& direction_W) {
    const Eigen::Vector2d pixel = scale * geometry_.project(T_C_W.linear() * direction_W * kAhead_m);
    return cv::Point(cvRound(pixel.x()), cvRound(pixel.y()));
  };
  if (areas) {
    for (const FreeArea& area : areas->areas) {
      cv::circle(camera_, spot(T_W_F.linear() * ahead(area)), 7, colour(area.verdict.state), cv::FILLED, cv::LINE_AA);
    }
  }
  if (way.direction_W) cv::circle(camera_, spot(*way.direction_W), 13, {255, 255, 255}, 3, cv::LINE_AA);
  writeCaption(cv::format("%s  %.1f s  %.1f m/s", title_.c_str(), observation.pair.stamp_s - sim::kFirstStamp_s,
                          observation.own.velocity_W_mps.norm()),
               camera_);
}

void FlyPictures::drawFromAbove(const sim::Observation& observation, const sim::Way& way) {
  const double length_m = world_.goal_W.x() + 4.0;
  above_.create(kHeight_px, cvRound(kPxPerMetre * length_m), CV_8UC3);
  above_.setTo(kPaper);
  for (const sim::Primitive& primitive :
       sim::visibleAt(world_.scene.world, observation.pair.stamp_s - sim::kFirstStamp_s)) {
    double low_m = kInfinity, high_m = -kInfinity;
    std::vector<cv::Point> points, hull;
    for (const Eigen::Vector3d& point_W : outline(primitive)) {
      low_m = std::min(low_m, point_W.z());
      high_m = std::max(high_m, point_W.z());
      points.push_back(pixelAbove(point_W));
    }
    if (high_m < kLow_m || low_m > kHigh_m) continue;
    cv::convexHull(points, hull);
    cv::fillConvexPoly(above_, hull, primitive.velocity_W.isZero() ? kSolid : kPerson, cv::LINE_AA);
  }
  for (std::size_t i = 1; i < trail_W_.size(); ++i) {
    cv::line(above_, pixelAbove(trail_W_[i - 1]), pixelAbove(trail_W_[i]), kTrail, 2, cv::LINE_AA);
  }
  cv::circle(above_, pixelAbove(world_.goal_W), 9, kGoal, 3, cv::LINE_AA);
  const Eigen::Vector3d p_W = observation.own.T_W_B.translation();
  if (way.direction_W) {
    cv::arrowedLine(above_, pixelAbove(p_W), pixelAbove(p_W + way.free_m * *way.direction_W), {0, 170, 0}, 2,
                    cv::LINE_AA);
  }
  cv::line(above_, pixelAbove(p_W), pixelAbove(observation.own.T_W_B * Eigen::Vector3d(0.6, 0.0, 0.0)), {0, 0, 0}, 3,
           cv::LINE_AA);
  cv::circle(above_, pixelAbove(p_W), 6, {0, 0, 0}, cv::FILLED, cv::LINE_AA);
}

cv::Point FlyPictures::pixelAbove(const Eigen::Vector3d& p_W) const {
  return {cvRound(kPxPerMetre * (p_W.x() + 2.0)), cvRound(kPxPerMetre * (kBeside_m - p_W.y()))};
}

}  // namespace flight_corridor::tools
