#pragma once

#include <flight_corridor/CorridorState.h>
#include <flight_corridor/FreeAreas.h>
#include <geometry_msgs/TwistStamped.h>
#include <ros/time.h>

#include <string>

#include "ros/guard_turn.hpp"
#include "ros/values.hpp"

namespace flight_corridor_ros {

/// Parameters of corridor_guard.
struct GuardConfig {
  bool stamped = false;                ///< Commands are TwistStamped, in and out; else Twist.
  std::string frame_id = "base_link";  ///< Of stamped commands, x along the corridor; others are refused.
  double rate_hz = 20.0;               ///< Rate of the outgoing commands, whatever comes in.
  double max_age_s = 0.2;              ///< An older verdict does not count.
  double command_age_s = 0.5;          ///< An older command does not count.
  double turn_delay_s = 0.2;           ///< A UAV whose attitude is not known may turn on for so long as commanded.
  std::string gravity_frame = "odom";  ///< A fixed frame of tf, z up.
};

/// Configuration with these values, defaults elsewhere.
/// @throws std::invalid_argument listing every unknown key, wrong type and broken rule, with key, rule and value.
GuardConfig makeGuardConfig(const Values& values);

/// Two clocks: a stopped /clock makes nothing old, so arrival is timed on a steady one.
struct GuardTime {
  ros::Time now;
  double steady_s = 0.0;
};

/// The outgoing command, and why it is slower than the incoming one; "": it is not.
struct GuardedCommand {
  geometry_msgs::Twist twist;
  std::string why;
};

/// Limits a velocity to the safe speed of the direction in which it points. Commands are in the corridor's frame: x
/// along its axis, y left, z up. Commands outside the directions of free_areas (aside, back, steeply up or down) are
/// stopped; turning always passes. A direction counts as far as the UAV has turned since the image that judged it, by
/// its measured attitude, else as commanded at worst. No verdict, or an old one, allows no speed; no command, or an old
/// one, is a stop.
class Guard {
 public:
  explicit Guard(const GuardConfig& config) : config_(config), turn_(config.turn_delay_s) {}

  void see(const flight_corridor::FreeAreas& areas, const GuardTime& time);
  void see(const flight_corridor::CorridorState& corridor, const GuardTime& time);
  /// @param command with a stamp of 0: it counts from now on.
  void command(const geometry_msgs::TwistStamped& command, const GuardTime& time);
  /// Attitudes of a frame that is fixed to the UAV, in a fixed frame, z up.
  void seeImu(const ros::Time& stamp, const Eigen::Quaterniond& R_W_B) { turn_.by_imu.add(stamp, R_W_B); }
  /// @param rate_rad_s of the heading, left positive.
  void seeImuRate(const ros::Time& stamp, double rate_rad_s) { turn_.by_rate.add(stamp, rate_rad_s); }
  void seeTf(const ros::Time& stamp, const Eigen::Quaterniond& R_W_B) { turn_.by_tf.add(stamp, R_W_B); }

  GuardedCommand limited(const GuardTime& time) const;

 private:
  /// The last message; its stamp and time of arrival.
  template <typename Message>
  struct Latest {
    Message message;
    double arrived_s = 0.0;
    bool has_come = false;
  };
  template <typename Message>
  static void take(const Message& message, const GuardTime& time, Latest<Message>& latest);
  template <typename Message>
  static double ageOf(const Latest<Message>& latest, const GuardTime& time);
  template <typename Message>
  std::string faultOf(const Latest<Message>& latest, const char* topic, const GuardTime& time) const;
  std::string commandFault(const GuardTime& time) const;
  double safeSpeed(double yaw_rad, double pitch_rad, const GuardTime& time, std::string& why) const;

  GuardConfig config_;
  Latest<flight_corridor::FreeAreas> areas_;
  Latest<flight_corridor::CorridorState> corridor_;
  Latest<geometry_msgs::TwistStamped> command_;
  GuardTurn turn_;
};

}  // namespace flight_corridor_ros
