#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "ros/params.hpp"
#include "support/contains.hpp"
#include "support/temporary_folder.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

std::string complaintAbout(const Values& values) {
  try {
    makeConfig(values);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string complaintAboutFile(const std::string& path) {
  try {
    readYaml(path);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Names of the fields of every `struct <Section>Config {...}` in a header, as keys "section/field".
std::set<std::string> fieldsIn(const std::string& header) {
  std::stringstream file;
  file << std::ifstream(header).rdbuf();
  const std::string text = file.str();
  std::set<std::string> keys;
  const std::regex structure("struct (\\w+)Config \\{([^]*?)\\n\\};");
  const std::regex field("\\n  [\\w:]+ (\\w+)[^;\\n]*;");
  for (std::sregex_iterator s(text.begin(), text.end(), structure), end; s != end; ++s) {
    const std::string name = std::regex_replace((*s)[1].str(), std::regex("(.)([A-Z])"), "$1_$2");
    std::string section;
    for (const char letter : name) section += static_cast<char>(std::tolower(letter));
    const std::string body = (*s)[2];
    for (std::sregex_iterator f(body.begin(), body.end(), field); f != end; ++f) {
      keys.insert(section + "/" + (*f)[1].str());
    }
  }
  return keys;
}

TEST(Params, BindsEveryFieldOfEveryConfigStruct) {
  std::set<std::string> declared = fieldsIn(FLIGHT_CORRIDOR_SOURCE_DIR "/src/ros/params.hpp");
  for (const auto& file : std::filesystem::recursive_directory_iterator(FLIGHT_CORRIDOR_SOURCE_DIR "/include")) {
    if (file.is_regular_file()) declared.merge(fieldsIn(file.path()));
  }
  declared.erase("node/core");
  declared.erase("node/ros");
  declared.erase("node/mask");  // a file of the shell's: the core gets the image
  declared.insert("stereo/mask");
  std::set<std::string> bound;
  for (const auto& [key, value] : toValues(NodeConfig())) bound.insert(key);
  EXPECT_EQ(bound, declared);
}

TEST(Params, PaperYamlHoldsThePapersNumbers) {
  const NodeConfig config = makeConfig(readYaml(FLIGHT_CORRIDOR_SOURCE_DIR "/config/paper.yaml"));
  EXPECT_EQ(config.core.fusion.acceleration_sigma_mps2, 0.0);
  EXPECT_EQ(config.core.fusion.stereo_variance_m2, 0.0254800198);
  EXPECT_EQ(config.core.fusion.lidar_variance_m2, 0.0005798584);
  EXPECT_EQ(config.core.fusion.disparity_sigma_px, 0.0);
  EXPECT_EQ(config.core.fusion.gate_sigma, flight_corridor::kInfinity);
  EXPECT_EQ(config.core.corridor.width_m, 1.2);
  EXPECT_EQ(config.core.corridor.height_m, 0.4);
  EXPECT_EQ(config.core.corridor.length_m, 4.0);
}

TEST(Params, NoValuesGiveTheDefaults) { EXPECT_EQ(toValues(makeConfig({})), toValues(NodeConfig())); }

/// A value of a key that is not its default, and that no rule forbids.
Value otherThan(const std::string& key, const Value& value) {
  static const Values chosen = {{"stereo/num_disparities_px", 64},
                                {"stereo/device", std::string("auto")},
                                {"map/log_odds_min", -1.9},
                                {"ros/scale", 0.5}};
  if (const auto found = chosen.find(key); found != chosen.end()) return found->second;
  if (const bool* flag = std::get_if<bool>(&value)) return !*flag;
  if (const int* integer = std::get_if<int>(&value)) return *integer + 1;
  if (const double* number = std::get_if<double>(&value)) return *number == 0.0 ? 0.01 : 1.01 * *number;
  if (std::holds_alternative<std::string>(value)) return std::string("other");
  return std::vector<double>{0.1, -0.2, 0.3};
}

TEST(Params, EveryKeyReachesItsOwnField) {
  const Values defaults = toValues(NodeConfig());
  for (const auto& [key, value] : defaults) {
    Values expected = defaults;
    expected[key] = otherThan(key, value);
    ASSERT_NE(expected[key], value) << key;
    EXPECT_EQ(complaintAbout({{key, expected[key]}}), "") << key;
    EXPECT_EQ(toValues(makeConfig({{key, expected[key]}})), expected) << key;
  }
}

TEST(Params, ListsEveryUnknownKeyWrongTypeAndBrokenRuleAtOnce) {
  const std::string complaint = complaintAbout({{"corridor/wdith_m", 1.2},
                                                {"stereo/num_disparities_px", 64.0},
                                                {"corridor/height_m", -0.4},
                                                {"scale/enabled", std::string("maybe")},
                                                {"corridor/offset_m", std::vector<double>{1.0, 2.0}},
                                                {"ros/watchdog_s", 0},
                                                {"ros/tf_timeout_s", flight_corridor::kInfinity},
                                                {"map/frame_id", std::monostate()}});
  EXPECT_TRUE(contains(complaint, "corridor/wdith_m: unknown key (1.2)")) << complaint;
  EXPECT_TRUE(contains(complaint, "stereo/num_disparities_px: expects an integer (64")) << complaint;
  EXPECT_TRUE(contains(complaint, "corridor/height_m: ")) << complaint;
  EXPECT_TRUE(contains(complaint, "(-0.4)")) << complaint;
  EXPECT_TRUE(contains(complaint, "scale/enabled: expects true or false (\"maybe\")")) << complaint;
  EXPECT_TRUE(contains(complaint, "corridor/offset_m: expects a list of three numbers (a list of 2 numbers)"));
  EXPECT_TRUE(contains(complaint, "ros/watchdog_s: positive (0)")) << complaint;
  EXPECT_TRUE(contains(complaint, "ros/tf_timeout_s: 0 to 10 (inf)")) << complaint;
  EXPECT_TRUE(contains(complaint, "map/frame_id: expects a text")) << complaint;
}

TEST(Params, AnImageScaleOtherThanAHalvingIsRefusedByItsKey) {
  for (const double scale : {0.3, 0.0, -1.0, 2.0}) {
    EXPECT_TRUE(contains(complaintAbout({{"ros/scale", scale}}), "ros/scale: 1, 0.5, 0.25 or 0.125 (")) << scale;
  }
  EXPECT_EQ(makeConfig({{"ros/scale", 0.25}}).ros.scale, 0.25);
  EXPECT_EQ(makeConfig({{"ros/scale", 1}}).ros.scale, 1.0);
}

TEST(Params, IntegersAreNumbersButNumbersAreNoIntegers) {
  EXPECT_EQ(makeConfig({{"corridor/length_m", 3}}).core.corridor.length_m, 3.0);
  EXPECT_NE(complaintAbout({{"ros/sync_queue", 3.0}}), "");
}

TEST(Params, SettingOneParameterReadsItsValueAsYaml) {
  Values values;
  setParameter(values, "map/frame_id=odom");
  setParameter(values, "corridor/frame_id=");
  setParameter(values, "corridor/length_m=3");
  setParameter(values, "scale/enabled=false");
  setParameter(values, "corridor/offset_m=[0.5, 0, -0.25]");
  const NodeConfig config = makeConfig(values);
  EXPECT_EQ(config.core.map.frame_id, "odom");
  EXPECT_EQ(config.core.corridor.frame_id, "");
  EXPECT_EQ(config.core.corridor.length_m, 3.0);
  EXPECT_FALSE(config.core.scale.enabled);
  EXPECT_EQ(config.core.corridor.offset_m, Eigen::Vector3d(0.5, 0.0, -0.25));
}

TEST(Params, SettingRefusesWhatIsNoKeyAndValue) {
  Values values;
  EXPECT_THROW(setParameter(values, "corridor/length_m"), std::invalid_argument);
  EXPECT_THROW(setParameter(values, "=3"), std::invalid_argument);
  EXPECT_THROW(setParameter(values, "corridor/offset_m=[1, 2"), std::invalid_argument);
}

TEST(Params, FilesThatCannotBeReadAreNamed) {
  const flight_corridor::test_support::TemporaryFolder folder;
  EXPECT_TRUE(contains(complaintAboutFile(folder.path("absent.yaml")), "absent.yaml"));
  std::ofstream(folder.path("broken.yaml")) << "corridor: [1, 2";
  EXPECT_TRUE(contains(complaintAboutFile(folder.path("broken.yaml")), "broken.yaml"));
  std::ofstream(folder.path("empty.yaml")) << "";
  EXPECT_TRUE(contains(complaintAboutFile(folder.path("empty.yaml")), "not a map of parameters"));
}

TEST(Params, FramesAreNamedAsTf2NamesThem) {
  EXPECT_EQ(makeConfig({{"map/frame_id", std::string("/odom")}}).core.map.frame_id, "odom");
  for (const char* key : {"map/frame_id", "corridor/frame_id", "ros/gravity_frame"}) {
    EXPECT_NE(complaintAbout({{key, std::string("/")}}).find(key), std::string::npos) << key;
  }
}

TEST(Params, MapsThatHoldThemselvesEnd) {
  const flight_corridor::test_support::TemporaryFolder folder;
  const std::string path = folder.path("endless.yaml");
  std::ofstream(path) << "stereo: &again\n  deeper: *again\n";
  EXPECT_THROW(makeConfig(readYaml(path)), std::invalid_argument);
}

TEST(Params, QuotedNumbersAreTexts) {
  const flight_corridor::test_support::TemporaryFolder folder;
  std::ofstream(folder.path("quoted.yaml")) << "corridor: {length_m: \"3\"}";
  EXPECT_TRUE(contains(complaintAbout(readYaml(folder.path("quoted.yaml"))), "corridor/length_m: expects a number"));
}

}  // namespace
}  // namespace flight_corridor_ros
