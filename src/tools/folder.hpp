#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::tools {

template <typename Value>
struct Stamped {
  ros::Time stamp;
  Value value;
};

/// One rectified pair on disk.
struct ImagePair {
  std::string left, right;  ///< Paths.
};

/// A stereo recording as a folder: left/NAME.png, right/NAME.png, calib.yaml (fx fy cx cy doffs [px], baseline [m];
/// cx_right = cx + doffs), and where they exist timestamps.csv (stamp_s), range.csv (stamp_s, range_m: from the left
/// camera along its optical axis, REP-117) and poses.csv (stamp_s, tx ty tz qx qy qz qw: left camera in the world).
/// Body B is the left camera, looking forward.
struct FolderRecording {
  BagRig rig;
  std::vector<Stamped<ImagePair>> pairs;
  std::vector<Stamped<double>> ranges_m;
  std::vector<Stamped<Eigen::Isometry3d>> poses_W_B;
};

/// Stamps move by one second where the recording starts before 1 s, because ROS reads stamp 0 as "no time".
/// @param rate_hz of the pairs where there is no timestamps.csv.
/// @throws std::runtime_error naming the file and what is wrong with it; where it is a table, the line too.
FolderRecording readFolder(const std::string& folder, double rate_hz);

/// @param on_pair called after each pair.
/// @throws std::runtime_error naming an image that cannot be read or has another size, or the bag.
void writeBag(const FolderRecording& recording, const std::string& bag_path, const std::function<void()>& on_pair);

}  // namespace flight_corridor::tools
