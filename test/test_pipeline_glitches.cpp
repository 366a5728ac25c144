#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flight_corridor/pipeline.hpp"
#include "support/calibrations.hpp"
#include "support/pipeline_inputs.hpp"
#include "support/wall_scene.hpp"

// One faulty message among good ones is forgotten.

namespace flight_corridor {
namespace {

using namespace test_support;

constexpr double kPair_s = 0.25;
constexpr int kBefore = 4;             // good pairs before the fault
constexpr double kRemembered_s = 1.0;  // of a contradiction, at most

/// What comes with one pair.
struct Messages {
  StereoFrame pair;
  std::vector<RangeReading> ranges;
  std::vector<std::pair<double, Eigen::Vector3d>> accelerations;
  std::optional<Eigen::Isometry3d> T_W_C = Eigen::Isometry3d::Identity();
};

struct Glitch {
  std::string name;
  std::function<void(Messages&)> spoil;
};

/// A LiDAR at 100 Hz and a wall.
Messages goodMessages(int i, int disparity_px) {
  const double stamp_s = 1.0 + kPair_s * i;
  Messages messages;
  messages.pair = wallFrame(kSmallGeometry, disparity_px, stamp_s);
  for (int k = 9; k >= 0; --k) {
    const double reading_s = stamp_s - 0.01 * k;
    messages.ranges.push_back(reading(reading_s, kSmallGeometry.depth(disparity_px) + 0.001 * (k % 3)));
    messages.accelerations.emplace_back(reading_s, Eigen::Vector3d::Zero());
  }
  return messages;
}

std::vector<Glitch> rangeGlitches() {
  std::vector<Glitch> glitches;
  for (const double range_m : {kNaN, -kInfinity, kInfinity, 0.0, -1.0, 0.1, 1.0, 2.0, 5.0, 20.0, 99.0, 9509.0, 1e308}) {
    glitches.push_back(
        {"range " + std::to_string(range_m), [range_m](Messages& messages) { messages.ranges[5].range_m = range_m; }});
  }
  for (const double late_s : {kNaN, kInfinity, 1e9, 60.0, 0.9, 0.2, -0.5, -60.0}) {
    glitches.push_back({"range late by " + std::to_string(late_s), [late_s](Messages& messages) {
                          messages.ranges[5].stamp_s -= late_s;
                          messages.ranges[5].range_m = 1.5;
                        }});
  }
  return glitches;
}

std::vector<Glitch> accelerationGlitches() {
  std::vector<Glitch> glitches;
  for (const double acceleration_mps2 : {kNaN, kInfinity, 30.0, 1e3, -1e3, 1e6, -1e6, 1e308, -1e308}) {
    for (const int last : {5, 9}) {
      glitches.push_back({"acceleration " + std::to_string(acceleration_mps2), [=](Messages& messages) {
                            messages.accelerations[last].second = {0.0, 0.0, acceleration_mps2};
                          }});
    }
  }
  glitches.push_back({"two accelerations", [](Messages& messages) {
                        messages.accelerations[3].second = {0.0, 0.0, 1.7e308};
                        messages.accelerations[4].second = {0.0, 0.0, -1.7e308};
                      }});
  return glitches;
}

std::vector<Glitch> imageGlitches() {
  const auto both = [](const cv::Scalar& grey) {
    return [grey](Messages& messages) {
      for (cv::Mat* image : {&messages.pair.left, &messages.pair.right}) image->setTo(grey);
    };
  };
  return {
      {"black", both(0)},
      {"white", both(255)},
      {"blank right image", [](Messages& messages) { messages.pair.right.setTo(128); }},
      {"empty left image", [](Messages& messages) { messages.pair.left = cv::Mat(); }},
      {"half a right image", [](Messages& messages) { messages.pair.right = messages.pair.right.rowRange(0, 100); }},
      {"one camera twice", [](Messages& messages) { messages.pair.right = messages.pair.left; }},
      {"swapped cameras", [](Messages& messages) { std::swap(messages.pair.left, messages.pair.right); }},
      {"an earlier pair",
       [](Messages& messages) {
         messages.pair = {messages.pair.stamp_s, goodMessages(kBefore - 1, 3).pair.left,
                          goodMessages(kBefore - 1, 3).pair.right};
       }},
      {"an earlier stamp", [](Messages& messages) { messages.pair.stamp_s -= 5.0; }},
      {"no stamp", [](Messages& messages) { messages.pair.stamp_s = kNaN; }},
      {"another scene",
       [](Messages& messages) { messages.pair = wallFrame(kSmallGeometry, 12, messages.pair.stamp_s); }}};
}

std::vector<Glitch> poseGlitches() {
  std::vector<Glitch> glitches{{"no pose", [](Messages& messages) { messages.T_W_C.reset(); }}};
  for (const double moved_m : {kNaN, 1e308, 50.0, 3.5, 0.5, -0.5, -3.5, -50.0}) {
    glitches.push_back({"moved by " + std::to_string(moved_m),
                        [moved_m](Messages& messages) { messages.T_W_C->translation().z() = moved_m; }});
  }
  glitches.push_back(
      {"turned", [](Messages& messages) { messages.T_W_C->rotate(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY())); }});
  return glitches;
}

/// The verdicts on all pairs, of which one comes with a fault.
std::vector<Verdict> verdicts(int pairs, int disparity_px, const Config& config, const Glitch& glitch) {
  Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
  std::vector<Verdict> verdicts;
  for (int i = 0; i < pairs; ++i) {
    Messages messages = goodMessages(i, disparity_px);
    if (i == kBefore) glitch.spoil(messages);
    for (const RangeReading& reading : messages.ranges) pipeline.addRange(reading);
    for (const auto& [stamp_s, acceleration] : messages.accelerations) pipeline.addAcceleration(stamp_s, acceleration);
    verdicts.push_back(pipeline.process(messages.pair, messages.T_W_C).verdict);
  }
  return verdicts;
}

void expectForgotten(const std::vector<Glitch>& glitches, const Config& config) {
  const double memory_s = std::max({config.corridor.hold_s, config.fusion.max_gap_s, kRemembered_s});
  const int recovered = kBefore + 1 + static_cast<int>(std::ceil(memory_s / kPair_s));
  const int pairs = recovered + 2;
  for (const int disparity_px : {3, 7}) {
    const std::vector<Verdict> clean = verdicts(pairs, disparity_px, config, {"", [](Messages&) {}});
    ASSERT_EQ(clean.back().state, disparity_px == 3 ? State::Free : State::Blocked);
    for (const Glitch& glitch : glitches) {
      const std::vector<Verdict> spoilt = verdicts(pairs, disparity_px, config, glitch);
      for (int i = recovered; i < pairs; ++i) {
        EXPECT_EQ(describeReasons(spoilt[i].reasons), describeReasons(clean[i].reasons))
            << glitch.name << ", pair " << i << ", " << disparity_px << " px";
        EXPECT_EQ(spoilt[i].state, clean[i].state) << glitch.name;
        if (clean[i].state == State::Blocked) {
          EXPECT_NEAR(spoilt[i].free_distance_m, clean[i].free_distance_m, 0.02) << glitch.name;
        }
      }
    }
  }
}

TEST(PipelineGlitches, ARangeIsForgotten) { expectForgotten(rangeGlitches(), Config()); }

TEST(PipelineGlitches, AnAccelerationIsForgotten) { expectForgotten(accelerationGlitches(), Config()); }

TEST(PipelineGlitches, AnImageIsForgotten) { expectForgotten(imageGlitches(), Config()); }

TEST(PipelineGlitches, APoseIsForgotten) {
  Config config;
  config.map.frame_id = "odom";
  expectForgotten(poseGlitches(), config);
}

TEST(PipelineGlitches, AContradictionIsForgottenThoughTheLidarMeetsNothingAnyMore) {
  Config config;
  for (const double range_m : {kNaN, kInfinity, 9509.0, 0.0}) {
    Pipeline pipeline(config, kSmallGeometry, rigWithLidar());
    bool contradicted = false;
    for (int i = 0; i < 12; ++i) {
      Messages messages = goodMessages(i, 3);
      for (RangeReading& reading : messages.ranges) reading.range_m = i < 3 ? 4.7 : range_m;
      for (const RangeReading& reading : messages.ranges) pipeline.addRange(reading);
      const Verdict verdict = pipeline.process(messages.pair).verdict;
      contradicted |= (verdict.reasons & kLidarNearer) != 0;
      if (i <= 3 + config.fusion.max_gap_s / kPair_s) continue;
      EXPECT_EQ(verdict.state, State::Free) << range_m << ", pair " << i;
    }
    EXPECT_TRUE(contradicted);
  }
}

}  // namespace
}  // namespace flight_corridor
