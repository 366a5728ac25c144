#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kSource = FLIGHT_CORRIDOR_SOURCE_DIR;

std::vector<std::string> rosIncludes(const fs::path& file) {
  static const std::regex ros_header(
      "#include.*[<\"](ros|tf|tf2|tf2_\\w+|\\w+_msgs|std_srvs|rosbag|cv_bridge|image_transport|message_filters|nodelet|"
      "pluginlib|diagnostic_updater|pcl_conversions|pcl_ros|flight_corridor/[A-Z]\\w*\\.h).*");
  std::vector<std::string> found;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (std::regex_match(line, ros_header)) found.push_back(file.string() + ": " + line);
  }
  return found;
}

std::vector<fs::path> coreFiles() {
  std::vector<fs::path> files;
  for (const char* root : {"include/flight_corridor", "src"}) {
    for (auto entry = fs::recursive_directory_iterator(kSource / root); entry != fs::end(entry); ++entry) {
      const std::string name = entry->path().filename();
      if (name == "ros" || name == "tools") entry.disable_recursion_pending();
      const bool is_program = name == "main.cpp";  // of any library
      if (entry->is_regular_file() && !is_program) files.push_back(entry->path());
    }
  }
  return files;
}

TEST(Architecture, CoreAndSimulationIncludeNoRosHeader) {
  const auto files = coreFiles();
  ASSERT_GT(files.size(), 60u);
  for (const fs::path& file : files) EXPECT_EQ(rosIncludes(file), std::vector<std::string>());
}

/// The module that a file of the core lies in: a folder, or "" for what composes them.
std::string moduleOf(const fs::path& file) {
  const fs::path folder = file.parent_path().filename();
  return folder == "src" || folder == "flight_corridor" ? "" : folder.string();
}

TEST(Architecture, ArrowsBetweenTheModulesPointDownwards) {
  static const std::map<std::string, std::set<std::string>> may_use{
      {"geometry", {}},
      {"stereo", {"geometry"}},
      {"opencl", {"stereo"}},
      {"range", {"geometry"}},
      {"map", {"geometry"}},
      {"motion", {"geometry", "stereo", "range"}},
      {"corridor", {"geometry", "stereo", "range", "motion", "map"}},
      {"", {"geometry", "stereo", "range", "motion", "map", "corridor"}},
      {"view", {"geometry", "stereo", "range", "motion", "map", "corridor", ""}},
      {"serial", {}}};
  static const std::set<std::string> kForAll{"types", "parameter", "band_workers", "disjoint_sets"};
  static const std::regex own("#include \"flight_corridor/(?:(\\w+)/)?(\\w+)\\.hpp\"");
  int arrows = 0;
  for (const fs::path& file : coreFiles()) {
    const std::string module = moduleOf(file);
    if (module == "sim") continue;
    ASSERT_TRUE(may_use.count(module)) << file;
    std::ifstream stream(file);
    std::smatch match;
    for (std::string line; std::getline(stream, line);) {
      if (!std::regex_match(line, match, own) || match[1] == module || kForAll.count(match[2])) continue;
      EXPECT_TRUE(may_use.at(module).count(match[1])) << file << ": " << line;
      ++arrows;
    }
  }
  EXPECT_GT(arrows, 40);
}

TEST(Architecture, OnlyTheViewKnowsPcl) {
  for (const fs::path& file : coreFiles()) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
      EXPECT_TRUE(line.rfind("#include <pcl/", 0) != 0 || moduleOf(file) == "view") << file << ": " << line;
    }
  }
}

TEST(Architecture, RosHeadersWouldBeFound) {
  EXPECT_FALSE(rosIncludes(kSource / "src/ros/node.cpp").empty());
  EXPECT_FALSE(rosIncludes(kSource / "src/ros/conversions.hpp").empty());
}

}  // namespace
