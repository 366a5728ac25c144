#include <cstdio>

#include "tools/calibration_file.hpp"
#include "tools/command_line.hpp"
#include "tools/folder.hpp"
#include "tools/programs.hpp"
#include "tools/progress.hpp"

namespace flight_corridor::tools {
namespace {

void importFolder(const std::string& folder, const FolderReading& reading, const std::string& bag) {
  const FolderRecording recording = readFolder(folder, reading);
  std::fprintf(stderr, "import_folder: %s\n", recording.calibration.c_str());
  Progress progress("import_folder", recording.pairs.size());
  writeBag(recording, bag, [&] { progress.advance(); });
  std::printf("%s: %zu pairs, %zu ranges, %zu poses\n", bag.c_str(), recording.pairs.size(), recording.ranges_m.size(),
              recording.poses_W_B.size());
}

}  // namespace
}  // namespace flight_corridor::tools

int flight_corridor::programs::import_folder(int argc, char** argv) {
  using namespace tools;
  FolderReading reading;
  std::string folder, bag;
  CLI::App app("Writes a folder of stereo images as a bag of rectified ones.", "import_folder");
  app.add_option("--folder", folder,
                 "folder with left/, right/ (2.png comes before 10.png) and calib.yaml,\nor an EuRoC folder")
      ->type_name("D")
      ->required();
  app.add_option("--out", bag, "bag to write")->type_name("F.bag")->check(outputFile())->required();
  app.add_option("--rate", reading.rate_hz, "rate of the pairs where nothing gives their stamps")
      ->type_name("HZ")
      ->check(number(0.001));
  app.add_option("--calib", reading.calibration_files,
                 "calibration, in place of the folder's; where each camera has a file:\nleft first")
      ->type_name("FILE")
      ->allow_extra_args(false);
  app.add_option("--calib-left", reading.cameras.left, "left camera in a calibration of several, e.g. cam2")
      ->type_name("NAME");
  app.add_option("--calib-right", reading.cameras.right, "right camera in it")->type_name("NAME");
  app.add_flag_callback(
      "--rectified", [&] { reading.images = ImageState::Rectified; },
      "the images are rectified already: of the calibration only their\nprojection matrices count");
  app.footer(
      "In D: left/NAME.png and right/NAME.png, grey or colour; or mav0/cam0/data, mav0/cam1/data (EuRoC), or "
      "image_0,\n"
      "image_1, or image_2, image_3 (KITTI). Images called by nanoseconds have these as stamps.\n"
      "The calibration is calib.yaml, calib.txt, mav0/cam0/sensor.yaml and cam1's, or left.yaml and right.yaml; "
      "images\n"
      "are rectified where it has distortion or a rotation. It may be\n" +
      calibrationKinds() +
      "Optional: timestamps.csv (stamp_s), range.csv (stamp_s,range_m), along the left camera's optical axis,\n"
      "poses.csv (stamp_s,tx,ty,tz,qx,qy,qz,qw), rectified left camera to world.\n"
      "A recording that starts before 1 s is moved by 1 s: ROS reads stamp 0 as \"no time\".");
  return runTool(app, argc, argv, [&] { tools::importFolder(folder, reading, bag); });
}
