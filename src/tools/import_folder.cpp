#include <cstdio>

#include "tools/command_line.hpp"
#include "tools/folder.hpp"

namespace flight_corridor::tools {
namespace {

int importFolder(const CommandLine& options) {
  const FolderRecording recording = readFolder(options.text("folder"), options.number("rate", 0.001));
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
  CommandLine options("import_folder", "Writes a folder of rectified stereo images as a bag.");
  options.required("folder", "D", "folder with left/, right/ (2.png comes before 10.png), calib.yaml")
      .required("out", "F.bag", "bag to write")
      .optional("rate", "HZ", "rate of the pairs where the folder has no timestamps.csv", "10")
      .notes(
          "In D: left/NAME.png and right/NAME.png, rectified, grey or colour;\n"
          "calib.yaml: fx fy cx cy doffs [px], baseline [m]; cx of the right camera is cx + doffs.\n"
          "Optional: timestamps.csv (stamp_s), range.csv (stamp_s,range_m), along the left camera's optical axis,\n"
          "poses.csv (stamp_s,tx,ty,tz,qx,qy,qz,qw), left camera to world.\n"
          "A recording that starts before 1 s is moved by 1 s: ROS reads stamp 0 as \"no time\".");
  return runTool(options, argc, argv, [&] { return importFolder(options); });
}
