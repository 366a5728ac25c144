// A recording as a folder: pairs, ranges and poses, or std::runtime_error that names the file. The input is calib.yaml,
// timestamps.csv, range.csv and poses.csv, parted by lines "--".

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "scratch.hpp"
#include "tools/folder.hpp"

namespace flight_corridor::tools {
namespace {

constexpr char kParting[] = "\n--\n";
constexpr double kRate_hz = 10.0;

/// The part of a text up to the next parting, which is taken off.
std::string takePart(std::string& text) {
  const std::size_t end = text.find(kParting);
  const std::string part = text.substr(0, end);
  text.erase(0, end == std::string::npos ? end : end + sizeof(kParting) - 1);
  return part;
}

/// Two pairs of pictures, once.
void makePictures() {
  static const bool are_made = [] {
    for (const char* side : {"left", "right"}) {
      std::filesystem::create_directory(fuzz::scratchFolder().path(side));
      for (const char* name : {"1.png", "2.png"}) {
        cv::imwrite(fuzz::scratchFolder().path(std::string(side) + "/" + name), cv::Mat(4, 6, CV_8UC1, cv::Scalar(7)));
      }
    }
    return true;
  }();
  static_cast<void>(are_made);
}

void import(std::string text) try {
  makePictures();
  for (const char* name : {"calib.yaml", "timestamps.csv", "range.csv", "poses.csv"}) {
    const std::string part = takePart(text);
    if (part.empty()) {
      std::filesystem::remove(fuzz::scratchFolder().path(name));
    } else {
      fuzz::scratchFile(name, part);
    }
  }
  const FolderRecording recording = readFolder(fuzz::scratchFolder().path(""), {kRate_hz});
  writeBag(recording, fuzz::scratchFolder().path("recording.bag"), [] {});
} catch (const std::runtime_error& error) {
  const std::string folder = fuzz::scratchFolder().path("");
  if (std::string(error.what()).find(folder) == std::string::npos)
    fuzz::fail("errors name a file: " + std::string(error.what()));
}

}  // namespace
}  // namespace flight_corridor::tools

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flight_corridor::tools::import({reinterpret_cast<const char*>(data), size});
  return 0;
}
