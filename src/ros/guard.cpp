#include "ros/guard.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ros/stamp_age.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::above;
using flight_corridor::CorridorState;
using flight_corridor::FreeAreas;
using flight_corridor::from;
using flight_corridor::Rule;

constexpr double kAlone_rad = 0.0873;  // step of a grid of one direction: the default of free_areas/step_rad
constexpr double kReach = 0.9;         // of a step: directions that are nearer than this to a command's limit it

/// Whether a message is as its definition says: all arrays are of one size, all angles finite.
bool isComplete(const FreeAreas& areas) {
  const auto finite = [](double angle_rad) { return std::isfinite(angle_rad); };
  const std::size_t count = static_cast<std::size_t>(areas.rows) * areas.columns;
  return count > 0 && areas.yaw.size() == count && areas.pitch.size() == count && areas.state.size() == count &&
         areas.safe_speed.size() == count && std::all_of(areas.yaw.begin(), areas.yaw.end(), finite) &&
         std::all_of(areas.pitch.begin(), areas.pitch.end(), finite);
}

/// From a direction to the next.
double stepOf(const FreeAreas& areas) {
  if (areas.columns > 1) return std::abs(areas.yaw[1] - areas.yaw[0]);
  if (areas.rows > 1) return std::abs(areas.pitch[1] - areas.pitch[0]);
  return kAlone_rad;
}

bool isFinite(const geometry_msgs::Twist& twist) {
  const auto finite = [](const geometry_msgs::Vector3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  return finite(twist.linear) && finite(twist.angular);
}

template <typename... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
  char text[320];
  std::snprintf(text, sizeof text, pattern, arguments...);
  return text;
}

std::string degrees(double yaw_rad, double pitch_rad) {
  return format("%.0f deg %s, %.0f deg %s", std::abs(yaw_rad) * 180.0 / M_PI, yaw_rad < 0.0 ? "right" : "left",
                std::abs(pitch_rad) * 180.0 / M_PI, pitch_rad < 0.0 ? "down" : "up");
}

}  // namespace

GuardConfig makeGuardConfig(const Values& values) {
  GuardConfig c;
  const auto frame = [](const std::string& name) {
    return Rule().where(!withoutSlash(name).empty(), "a frame's name");
  };
  flight_corridor::throwIfBroken(flight_corridor::assign(values, [&]() -> flight_corridor::Parameters {
    return {{"stamped", &c.stamped},
            {"frame_id", &c.frame_id, frame(c.frame_id)},
            {"rate_hz", &c.rate_hz, from(1).upTo(200)},
            {"max_age_s", &c.max_age_s, above(0).upTo(5)},
            {"command_age_s", &c.command_age_s, above(0).upTo(5)},
            {"turn_delay_s", &c.turn_delay_s, from(0).upTo(2)},
            {"gravity_frame", &c.gravity_frame, frame(c.gravity_frame)}};
  }));
  c.frame_id = withoutSlash(c.frame_id);
  c.gravity_frame = withoutSlash(c.gravity_frame);
  return c;
}

void Guard::see(const FreeAreas& areas, const GuardTime& time) { take(areas, time, areas_); }

void Guard::see(const CorridorState& corridor, const GuardTime& time) { take(corridor, time, corridor_); }

/// A stamp that comes again, as of a /clock that stands still, is as old as when it came first.
template <typename Message>
void Guard::take(const Message& message, const GuardTime& time, Latest<Message>& latest) {
  const bool is_again = latest.has_come && latest.message.header.stamp == message.header.stamp;
  latest = {message, is_again ? latest.arrived_s : time.steady_s, true};
}

void Guard::command(const geometry_msgs::TwistStamped& command, const GuardTime& time) {
  command_ = {command, time.steady_s, true};
  if (command.header.stamp.isZero()) command_.message.header.stamp = time.now;
  const double yaw_rate_rad_s = command.twist.angular.z;
  if (std::isfinite(yaw_rate_rad_s)) turn_.commanded.add(time.now, yaw_rate_rad_s);
}

/// By its stamp or its arrival, whichever is farther from now; +inf: no message came.
template <typename Message>
double Guard::ageOf(const Latest<Message>& latest, const GuardTime& time) {
  if (!latest.has_come) return flight_corridor::kInfinity;
  const double arrived_ago_s = time.steady_s - latest.arrived_s;
  const double age_s = time.now.toSec() - latest.message.header.stamp.toSec();
  return std::abs(age_s) >= std::abs(arrived_ago_s) ? age_s : arrived_ago_s;
}

/// "": it is usable.
template <typename Message>
std::string Guard::faultOf(const Latest<Message>& latest, const char* topic, const GuardTime& time) const {
  const double age_s = ageOf(latest, time);
  if (std::abs(age_s) <= config_.max_age_s) return "";
  if (std::isinf(age_s)) {
    return format("stopped: no %s has come. Start the corridor's node, or remap %s to its topic", topic, topic);
  }
  return format(
      "stopped: %s is %s, outside +-%.2f s (max_age_s). See the rate and latency of the corridor's node and the "
      "clocks, or raise max_age_s and, by as much, that node's speed/delay_s",
      topic, describeAge(age_s).c_str(), config_.max_age_s);
}

/// "": it may be flown.
std::string Guard::commandFault(const GuardTime& time) const {
  const double age_s = ageOf(command_, time);
  if (!(std::abs(age_s) <= config_.command_age_s)) {
    return format(
        "stopped: the command is %s, outside +-%.2f s (command_age_s). Send commands more often, stamped when "
        "they are sent",
        describeAge(age_s).c_str(), config_.command_age_s);
  }
  const std::string frame = withoutSlash(command_.message.header.frame_id);
  if (config_.stamped && frame != config_.frame_id) {
    return format("stopped: the command is in frame \"%.60s\", not in \"%.60s\" (frame_id). Send it in that frame",
                  frame.c_str(), config_.frame_id.c_str());
  }
  const bool is_finite = isFinite(command_.message.twist);
  return is_finite ? "" : "stopped: a number of the command is NaN or infinite. See the planner that sends it";
}

GuardedCommand Guard::limited(const GuardTime& time) const {
  GuardedCommand out;
  if (!command_.has_come) return out;
  out.why = commandFault(time);
  if (!out.why.empty()) return out;
  const geometry_msgs::TwistStamped& command = command_.message;
  out.twist.angular = command.twist.angular;
  const Eigen::Vector3d wanted(command.twist.linear.x, command.twist.linear.y, command.twist.linear.z);
  const double speed_mps = wanted.stableNorm();
  if (speed_mps == 0.0) return out;
  const double yaw_rad = std::atan2(wanted.y(), wanted.x());
  const double pitch_rad = std::atan2(wanted.z(), std::hypot(wanted.x(), wanted.y()));
  const double safe_mps = safeSpeed(yaw_rad, pitch_rad, time, out.why);
  const double share = std::min(1.0, safe_mps / speed_mps);
  if (share < 1.0 && out.why.empty()) {
    const bool is_stop = safe_mps == 0.0;
    out.why =
        format("%s: %.2f m/s %s is commanded, %.2f m/s is safe%s", is_stop ? "stopped" : "slowed down", speed_mps,
               degrees(yaw_rad, pitch_rad).c_str(), safe_mps,
               is_stop ? ". The reasons in free_areas and corridor say why; turn to a direction that is FREE" : "");
  }
  out.twist.linear.x = share * wanted.x();
  out.twist.linear.y = share * wanted.y();
  out.twist.linear.z = share * wanted.z();
  return out;
}

/// The least of all directions of the grid within reach of this one, and of those that the UAV turned through since
/// their image; straight ahead also of the corridor, which knows more.
double Guard::safeSpeed(double yaw_rad, double pitch_rad, const GuardTime& time, std::string& why) const {
  const FreeAreas& areas = areas_.message;
  why = faultOf(areas_, "free_areas", time);
  if (why.empty() && !isComplete(areas)) {
    why = "stopped: free_areas is malformed: arrays of other sizes than rows x columns, or an angle that is not finite";
  }
  if (!why.empty()) return 0.0;
  const double step_rad = stepOf(areas);
  const TurnRange turned = turn_.since(areas.header.stamp, time.now);
  const double rightmost_rad = yaw_rad + turned.right_rad, leftmost_rad = yaw_rad + turned.left_rad;
  double right_rad = flight_corridor::kInfinity, left_rad = flight_corridor::kInfinity;  // to the nearest direction
  double safe_mps = flight_corridor::kInfinity;
  bool is_ahead = false;
  for (std::size_t i = 0; i < areas.yaw.size(); ++i) {
    const double up_rad = std::abs(areas.pitch[i] - pitch_rad);
    right_rad = std::min(right_rad, std::max(up_rad, std::abs(areas.yaw[i] - rightmost_rad)));
    left_rad = std::min(left_rad, std::max(up_rad, std::abs(areas.yaw[i] - leftmost_rad)));
    const double aside_rad = std::max({0.0, rightmost_rad - areas.yaw[i], areas.yaw[i] - leftmost_rad});
    if (!(std::max(up_rad, aside_rad) <= kReach * step_rad)) continue;
    const bool is_free = areas.state[i] != FreeAreas::UNKNOWN && areas.safe_speed[i] > 0.0;
    safe_mps = std::min(safe_mps, is_free ? areas.safe_speed[i] : 0.0);
    is_ahead = is_ahead || (std::abs(areas.yaw[i]) < 1e-6 && std::abs(areas.pitch[i]) < 1e-6);
  }
  if (!(std::max(right_rad, left_rad) <= 0.5 * step_rad)) {
    why = format(
        "stopped: the command points %s, outside the directions of free_areas, where nothing is known. Turn there "
        "first, or widen free_areas/ of the corridor's node",
        degrees(yaw_rad, pitch_rad).c_str());
    return 0.0;
  }
  if (!is_ahead) return safe_mps;
  why = faultOf(corridor_, "corridor", time);
  if (!why.empty()) return 0.0;
  const CorridorState& corridor = corridor_.message;
  const bool is_known = corridor.state != CorridorState::UNKNOWN && corridor.safe_speed > 0.0;
  return std::min(safe_mps, is_known ? corridor.safe_speed : 0.0);
}

}  // namespace flight_corridor_ros
