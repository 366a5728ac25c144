#include <cstdio>

#include "tools/calibration_file.hpp"
#include "tools/command_line.hpp"
#include "tools/folder.hpp"
#include "tools/progress.hpp"

namespace flight_corridor::tools {
namespace {

int importFolder(const CommandLine& options) {
  const ImageState images = options.given("rectified") ? ImageState::Rectified : ImageState::AsNamed;
  const PairNames cameras{options.text("calib-left"), options.text("calib-right")};
  const FolderRecording recording =
      readFolder(options.text("folder"), {options.number("rate", 0.001), options.all("calib"), images, cameras});
  std::fprintf(stderr, "import_folder: %s\n", recording.calibration.c_str());
  Progress progress("import_folder", recording.pairs.size());
  writeBag(recording, options.text("out"), [&] { progress.advance(); });
  std::printf("%s: %zu pairs, %zu ranges, %zu poses\n", options.text("out").c_str(), recording.pairs.size(),
              recording.ranges_m.size(), recording.poses_W_B.size());
  return 0;
}

}  // namespace
}  // namespace flight_corridor::tools

int main(int argc, char** argv) {
  using namespace flight_corridor::tools;
  CommandLine options("import_folder", "Writes a folder of stereo images as a bag of rectified ones.");
  options
      .required("folder", "D",
                "folder with left/, right/ (2.png comes before 10.png) and calib.yaml, or an EuRoC folder")
      .required("out", "F.bag", "bag to write")
      .optional("rate", "HZ", "rate of the pairs where nothing gives their stamps", "10")
      .repeatable("calib", "FILE", "calibration, in place of the folder's; where each camera has a file: left first")
      .optional("calib-left", "NAME", "left camera in a calibration of several, e.g. cam2")
      .optional("calib-right", "NAME", "right camera in it")
      .flag("rectified", "the images are rectified already: of the calibration only their projection matrices count")
      .notes(
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
  return runTool(options, argc, argv, [&] { return importFolder(options); });
}
