#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/pair_rectifier.hpp"
#include "tools/stereo_bag_writer.hpp"

namespace flight_corridor::tools {

template <typename Value>
struct Stamped {
  ros::Time stamp;
  Value value;
};

/// One pair on disk.
struct ImagePair {
  std::string left, right;  ///< Paths.
};

/// A stereo recording as a folder: left/NAME.png, right/NAME.png, a calibration, and where they exist timestamps.csv
/// (stamp_s), range.csv (stamp_s, range_m: from the left camera along its optical axis, REP-117) and poses.csv
/// (stamp_s, tx ty tz qx qy qz qw: left camera in the world). Body B is the left camera, looking forward. So are an
/// EuRoC folder, and KITTI's image_0, image_1 and image_2, image_3. Images that are called by nanoseconds have these as
/// stamps, and those without a partner are left out.
struct FolderRecording {
  BagRig rig;
  std::shared_ptr<const Rectifier> rectifier;  ///< Of raw images; null: they are rectified.
  std::string calibration;                     ///< In words.
  cv::Size image_size_px;
  std::vector<Stamped<ImagePair>> pairs;
  std::vector<Stamped<double>> ranges_m;
  std::vector<Stamped<Eigen::Isometry3d>> poses_W_B;
};

/// Data missing in a folder.
struct FolderReading {
  double rate_hz = 10.0;                            ///< Rate of the pairs if there are no stamps.
  std::vector<std::string> calibration_files = {};  ///< In place of the folder's own; see readCalibration.
  ImageState images = ImageState::AsNamed;          ///< AsNamed: raw if the calibration can rectify.
  PairNames cameras = {};                           ///< In these files, where they name their cameras.
};

/// Stamps move by one second where the recording starts before 1 s, because ROS reads stamp 0 as "no time".
/// @throws std::runtime_error naming the file and its fault; in a table also the line.
FolderRecording readFolder(const std::string& folder, const FolderReading& reading);

/// @param on_pair called after each pair.
/// @throws std::runtime_error naming an image that cannot be read or has another size, or the bag.
void writeBag(const FolderRecording& recording, const std::string& bag_path, const std::function<void()>& on_pair);

}  // namespace flight_corridor::tools
