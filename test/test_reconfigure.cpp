#include <gtest/gtest.h>

#include "ros/reconfigure.hpp"
#include "support/contains.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

dynamic_reconfigure::Config request(const std::string& key, double value) {
  dynamic_reconfigure::Config config;
  config.doubles.emplace_back();
  config.doubles.back().name = key;
  config.doubles.back().value = value;
  return config;
}

std::string complaintAbout(const dynamic_reconfigure::Config& config) {
  try {
    changed(NodeConfig(), config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Reconfigure, ChangesWhatIsNamedAndNothingElse) {
  NodeConfig before;
  before.core.corridor.height_m = 0.7;
  Values expected = toValues(before);
  expected["corridor/length_m"] = 2.5;
  EXPECT_EQ(toValues(changed(before, request("corridor/length_m", 2.5))), expected);
}

TEST(Reconfigure, EmptyRequestChangesNothing) {
  EXPECT_EQ(toValues(changed(NodeConfig(), {})), toValues(NodeConfig()));
}

TEST(Reconfigure, BrokenRulesAreNamedAllAtOnce) {
  dynamic_reconfigure::Config config = request("corridor/length_m", -1.0);
  config.doubles.push_back(request("corridor/hold_s", 99.0).doubles[0]);
  const std::string complaint = complaintAbout(config);
  EXPECT_TRUE(contains(complaint, "corridor/length_m")) << complaint;
  EXPECT_TRUE(contains(complaint, "corridor/hold_s")) << complaint;
}

TEST(Reconfigure, EveryChangeableParameterTakesItsDefaultButNotNaN) {
  NodeConfig defaults;
  ASSERT_FALSE(changeable(defaults).empty());
  for (const auto& row : changeable(defaults)) {
    EXPECT_TRUE(contains(complaintAbout(request(row.key, flight_corridor::kNaN)), row.key)) << row.key;
    EXPECT_EQ(complaintAbout(request(row.key, *std::get<double*>(row.field))), "") << row.key;
  }
}

TEST(Reconfigure, KeysThatCannotChangeInFlightAreNamedWhateverTheirType) {
  dynamic_reconfigure::Config config = request("map/resolution_m", 0.2);
  config.ints.emplace_back();
  config.ints.back().name = "stereo/num_disparities_px";
  config.strs.emplace_back();
  config.strs.back().name = "map/frame_id";
  config.bools.emplace_back();
  config.bools.back().name = "scale/enabled";
  const std::string complaint = complaintAbout(config);
  for (const char* key : {"map/resolution_m", "stereo/num_disparities_px", "map/frame_id", "scale/enabled"}) {
    EXPECT_TRUE(contains(complaint, std::string(key) + ": cannot change in flight")) << complaint;
  }
}

}  // namespace
}  // namespace flight_corridor_ros
