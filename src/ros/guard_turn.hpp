#pragma once

#include <ros/time.h>

#include <Eigen/Geometry>
#include <deque>
#include <optional>

namespace flight_corridor_ros {

/// A turn about the vertical lies between these, left positive [rad]: right_rad <= 0 <= left_rad.
struct TurnRange {
  double right_rad = 0.0, left_rad = 0.0;
};

/// Yaw rates lie between these, left positive [rad/s]: right_rad_s <= 0 <= left_rad_s.
struct TurnRates {
  double right_rad_s = 0.0, left_rad_s = 0.0;
};

/// Measured headings of one source, of the last seconds.
class HeadingHistory {
 public:
  /// @param R_W_B attitude of a frame that is fixed to the UAV, however mounted, in W: fixed, z up (REP-103).
  void add(const ros::Time& stamp, const Eigen::Quaterniond& R_W_B);

  /// A measured rate of the heading, left positive: it turns by the rates from then on. Begins anew after a gap.
  void add(const ros::Time& stamp, double rate_rad_s);

  /// How far the heading has turned, left positive, and until when it is known.
  struct Turn {
    double rad = 0.0, until_s = 0.0;
  };
  /// @return nullopt: no two attitudes enclose the stamp closely enough.
  std::optional<Turn> since(const ros::Time& stamp) const;

 private:
  struct Heading {
    double stamp_s = 0.0, rad = 0.0;  // not wrapped
  };
  bool isNext(double stamp_s);
  void push(double stamp_s, double turned_rad);

  std::deque<Heading> headings_;
  Eigen::Quaterniond newest_R_W_B_ = Eigen::Quaterniond::Identity();
};

/// Commanded yaw rates of the last seconds, by time of arrival.
class CommandedTurns {
 public:
  void add(const ros::Time& now, double rate_rad_s);
  /// Of all commands in force since then.
  TurnRates ratesSince(double time_s) const;

 private:
  struct Rate {
    double time_s = 0.0, rad_s = 0.0;
  };
  std::deque<Rate> rates_;
};

/// How far a UAV has turned since an image: as measured, and where nothing is measured, as commanded at worst.
class GuardTurn {
 public:
  /// @param delay_s a UAV may turn on for so long as it was commanded before.
  explicit GuardTurn(double delay_s) : delay_s_(delay_s) {}

  HeadingHistory by_imu, by_tf;  ///< Those that are known for longest count; where they differ, all that they say.
  HeadingHistory by_rate;        ///< Likewise: an imu whose orientation stands still may turn.
  CommandedTurns commanded;

  TurnRange since(const ros::Time& stamp, const ros::Time& now) const;

 private:
  double delay_s_;
};

}  // namespace flight_corridor_ros
