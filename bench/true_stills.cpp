#include "true_stills.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "sim/simulation.hpp"

namespace flight_corridor::bench {

namespace {

/// "key: number" lines of a file.
std::map<std::string, double> numbersOf(const std::filesystem::path& file) {
  std::map<std::string, double> numbers;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) numbers[line.substr(0, colon)] = std::atof(line.c_str() + colon + 2);
  }
  return numbers;
}

/// Portable float map, little-endian, last row first; OpenCV's reader scales it by what is no scale here.
cv::Mat readFloatMap(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string kind;
  int width = 0, height = 0;
  double scale = 0.0;
  stream >> kind >> width >> height >> scale;
  stream.get();
  cv::Mat map(height, width, CV_32FC1);
  for (int v = height - 1; v >= 0; --v) {
    stream.read(map.ptr<char>(v), static_cast<std::streamsize>(width) * static_cast<std::streamsize>(sizeof(float)));
  }
  return map;
}

TrueStill readStill(const std::filesystem::path& folder) {
  TrueStill still;
  still.name = folder.filename().string();
  still.frame.left = cv::imread((folder / "left/000000.png").string(), cv::IMREAD_GRAYSCALE);
  still.frame.right = cv::imread((folder / "right/000000.png").string(), cv::IMREAD_GRAYSCALE);
  const auto rig = numbersOf(folder / "calib.yaml");
  const double offset_px = rig.at("doffs");
  still.calibration = {still.frame.left.size(),  rig.at("fx"),      rig.at("fy"), rig.at("cx"), rig.at("cy"),
                       rig.at("cx") + offset_px, rig.at("baseline")};
  still.truth_px = readFloatMap(folder / "disp_gt/000000.pfm") + offset_px;
  still.visible = cv::imread((folder / "mask_nocc/000000.png").string(), cv::IMREAD_GRAYSCALE);
  return still;
}

/// 255 where no pixel of the same row that is nearer by more than a pixel lies at the same place of the right image.
cv::Mat visibleInBoth(const cv::Mat& truth_px) {
  cv::Mat visible(truth_px.size(), CV_8UC1, cv::Scalar(0));
  std::vector<float> nearest_px(truth_px.cols);
  for (int v = 0; v < truth_px.rows; ++v) {
    const float* const row_px = truth_px.ptr<float>(v);
    const auto rightOf = [row_px](int u) { return static_cast<int>(std::lround(static_cast<float>(u) - row_px[u])); };
    const auto seen = [&](int u) { return std::isfinite(row_px[u]) && 0 <= rightOf(u) && rightOf(u) < truth_px.cols; };
    std::fill(nearest_px.begin(), nearest_px.end(), 0.0f);
    for (int u = 0; u < truth_px.cols; ++u) {
      if (seen(u)) nearest_px[rightOf(u)] = std::max(nearest_px[rightOf(u)], row_px[u]);
    }
    for (int u = 0; u < truth_px.cols; ++u) {
      if (seen(u) && row_px[u] >= nearest_px[rightOf(u)] - 1.0f) visible.at<std::uint8_t>(v, u) = 255;
    }
  }
  return visible;
}

TrueStill simulatedStill(const std::string& scene) {
  sim::SimulationOptions options;
  options.scene = scene;
  options.seed = 1;
  options.baseline_error = options.disparity_offset_px = 0.0;
  const sim::Simulation simulation(options);
  const StereoGeometry geometry(simulation.calibration());
  const std::size_t middle = simulation.frameTimes().size() / 2;
  TrueStill still{scene, simulation.frame(middle), simulation.calibration(), simulation.depth(middle), {}};
  still.truth_px.forEach<float>([&geometry](float& value, const int*) {
    value = static_cast<float>(geometry.disparity(static_cast<double>(value)));
  });
  still.visible = visibleInBoth(still.truth_px);
  return still;
}

}  // namespace

std::vector<TrueStill> readStills(const std::filesystem::path& data) {
  std::vector<std::filesystem::path> folders;
  if (std::filesystem::is_directory(data)) {
    for (const auto& entry : std::filesystem::directory_iterator(data)) {
      if (entry.is_directory()) folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  std::vector<TrueStill> stills;
  for (const auto& folder : folders) stills.push_back(readStill(folder));
  return stills;
}

std::vector<TrueStill> simulatedStills() {
  std::vector<TrueStill> stills;
  for (const sim::Family& family : sim::sceneFamilies()) {
    if (family.visibility == sim::Visibility::Visible) stills.push_back(simulatedStill(family.name));
  }
  return stills;
}

}  // namespace flight_corridor::bench
