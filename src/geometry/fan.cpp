#include "flight_corridor/geometry/fan.hpp"

#include <algorithm>
#include <cmath>

namespace flight_corridor {

Fan::Fan(const Box& box_C, const std::vector<double>& yaws_rad, const std::vector<double>& pitches_rad)
    : box_C_(box_C),
      T_F_C_(box_C.T_M_F.inverse().cast<float>()),
      yaws_(turns(yaws_rad)),
      pitches_(turns(pitches_rad)),
      half_m_((0.5 * box_C.size_m).cast<float>().array() + static_cast<float>(kTouch_m)),
      end_m_(static_cast<float>(box_C.size_m.x())) {}

std::vector<Fan::Turn> Fan::turns(const std::vector<double>& angles_rad) {
  std::vector<Turn> turns;
  for (const double angle_rad : angles_rad) {
    turns.push_back({angle_rad, static_cast<float>(std::cos(angle_rad)), static_cast<float>(std::sin(angle_rad))});
  }
  return turns;
}

Box Fan::box(int direction) const {
  const int columns = static_cast<int>(yaws_.size());
  Box turned = box_C_;
  turned.T_M_F.rotate(Eigen::AngleAxisd(yaws_[direction % columns].angle_rad, Eigen::Vector3d::UnitZ()));
  turned.T_M_F.rotate(Eigen::AngleAxisd(-pitches_[direction / columns].angle_rad, Eigen::Vector3d::UnitY()));
  return turned;
}

double Fan::farthestCorner() const {
  double farthest_m = -kInfinity;
  for (int i = 0; i < size(); ++i) farthest_m = std::max(farthest_m, flight_corridor::farthestCorner(box(i)));
  return farthest_m;
}

bool Fan::operator==(const Fan& other) const {
  return box_C_.T_M_F.matrix() == other.box_C_.T_M_F.matrix() && box_C_.size_m == other.box_C_.size_m &&
         yaws_ == other.yaws_ && pitches_ == other.pitches_;
}

}  // namespace flight_corridor
