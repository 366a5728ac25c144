#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "sim/simulation.hpp"

namespace flight_corridor::sim {
namespace {

Visibility visibilityOf(const std::string& name) {
  for (const Family& family : sceneFamilies()) {
    if (family.name == name) return family.visibility;
  }
  throw std::invalid_argument(name);
}

Simulation flightOf(const std::string& scene, std::uint64_t seed) {
  SimulationOptions options;
  options.scene = scene;
  options.seed = seed;
  options.rate_hz = 10.0;
  return Simulation(options);
}

/// Index of the first frame whose corridor is truly blocked.
std::size_t firstBlocked(const Simulation& simulation) {
  std::size_t index = 0;
  while (simulation.truth(index).clear_exact_m == kInfinity) ++index;
  return index;
}

/// What the left camera shows of the corridor's far end at 4 m, a few pixels short of its border.
cv::Mat window(const cv::Mat& image) { return image(cv::Rect(270, 225, 100, 30)); }

TEST(SceneFamilies, AreTheSceneNamesInTheirOrder) {
  std::vector<std::string> names;
  for (const Family& family : sceneFamilies()) names.push_back(family.name);
  EXPECT_EQ(names, sceneNames());
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_GE(names.size(), 24u);
}

TEST(SceneFamilies, SayWhichOnesACameraCannotJudge) {
  for (const char* name :
       {"bare_beam", "bare_column", "bare_hall", "bare_hallway", "bare_on_bare", "bare_slant", "black_wall",
        "blank_wall", "dazzled", "glass", "mirror", "open_sky", "projector", "white_wall"}) {
    EXPECT_EQ(visibilityOf(name), Visibility::Unseeable) << name;
  }
  EXPECT_EQ(visibilityOf("close_pole"), Visibility::TooNear);
  EXPECT_EQ(visibilityOf("glass_passed"), Visibility::Hidden);
  for (const char* name : {"dark_wall", "low_light", "low_sun", "wall", "wire"}) {
    EXPECT_EQ(visibilityOf(name), Visibility::Visible) << name;
  }
}

TEST(Scenes, ABlankAndABlackWallShowOnlyNoise) {
  for (const char* scene : {"blank_wall", "black_wall"}) {
    const Simulation simulation = flightOf(scene, 1);
    cv::Scalar mean, std;
    cv::meanStdDev(window(simulation.frame(firstBlocked(simulation)).left), mean, std);
    // The sensor's 0.8 in the dark, with shot noise and rounding at most sqrt(0.64 + 0.012 * 170 + 1/12).
    EXPECT_LT(std[0], 1.7) << scene;
  }
}

TEST(Scenes, AWhiteWallSaturatesTheCamera) {
  const Simulation simulation = flightOf("white_wall", 1);
  const cv::Mat saturated = window(simulation.frame(firstBlocked(simulation)).left) == 255;
  EXPECT_EQ(cv::countNonZero(saturated), static_cast<int>(saturated.total()));
}

TEST(Scenes, OnPaintOnlyTheLightChanges) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Simulation simulation = flightOf("bare_slant", seed);
    cv::Mat image, blurred;
    window(simulation.frame(firstBlocked(simulation)).left).convertTo(image, CV_32F);
    cv::blur(image, blurred, {9, 9});
    cv::Scalar mean, std;
    cv::meanStdDev(image - blurred, mean, std);
    EXPECT_LT(std[0], 1.7) << seed;  // noise, as on a blank wall
  }
}

TEST(Scenes, OfBareFamiliesSomeFlyWithoutALidar) {
  for (const char* scene : {"bare_beam", "bare_column", "bare_hall", "bare_hallway", "bare_on_bare", "bare_slant"}) {
    int without = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) without += makeScene(scene, seed).lidar.rate_hz == 0.0 ? 1 : 0;
    EXPECT_GT(without, 0) << scene;
    EXPECT_LT(without, 20) << scene;
  }
}

TEST(Scenes, ADazzledCameraSeesWhiteWhereTheWallIs) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Simulation simulation = flightOf("dazzled", seed);
    const std::size_t blocked = firstBlocked(simulation);
    const cv::Mat white = window(simulation.frame(blocked).left) == 255;
    EXPECT_GT(cv::countNonZero(white), 0.99 * static_cast<double>(white.total())) << seed;
    EXPECT_LT(cv::countNonZero(simulation.depth(blocked) < 4.5f), 640 * 480);
  }
}

TEST(Scenes, ALowSunLeavesTheCorridorUnsaturated) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Simulation simulation = flightOf("low_sun", seed);
    const cv::Mat left = simulation.frame(firstBlocked(simulation)).left;
    EXPECT_EQ(cv::countNonZero(window(left) == 255), 0) << seed;
    EXPECT_GT(cv::countNonZero(left == 255), 1000) << seed;
  }
}

TEST(Scenes, AMirrorIsThereForTheLidarAndShowsTheCameraWhatIsBehindIt) {
  const Simulation simulation = flightOf("mirror", 0);
  EXPECT_LT(simulation.ranges().front().range_m, 9.0);
  cv::Scalar mean, std;
  cv::meanStdDev(window(simulation.frame(0).left), mean, std);
  EXPECT_GT(std[0], 5.0);  // the house behind, not the steel's own texture of a tenth
}

TEST(Scenes, APaneThatTheBeamPassesIsThereForNeitherSensor) {
  const Simulation simulation = flightOf("glass_passed", 0);
  EXPECT_GT(simulation.ranges().front().range_m, 10.0);
  EXPECT_GT(simulation.depth(0).at<float>(240, 320), 10.0f);
  EXPECT_LT(simulation.truth(firstBlocked(simulation)).clear_exact_m, 4.0);
}

TEST(Scenes, SpeedsReachFromHoveringToFourMetresPerSecond) {
  double slowest_m_s = kInfinity, fastest_m_s = 0.0;
  for (const std::string& name : sceneNames()) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const double speed_m_s = makeScene(name, seed).flight.speed_m_s;
      slowest_m_s = std::min(slowest_m_s, speed_m_s);
      fastest_m_s = std::max(fastest_m_s, speed_m_s);
    }
  }
  EXPECT_EQ(slowest_m_s, 0.0);
  EXPECT_GT(fastest_m_s, 3.5);
  EXPECT_LE(fastest_m_s, 4.0);
}

TEST(Scenes, TurningFlightsTurnAtSixtyDegreesASecondAndMore) {
  for (const char* scene : {"turning", "weaving"}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Flight flight = makeScene(scene, seed).flight;
      double fastest_rad_s = 0.0;
      for (double time_s = 0.0; time_s < flight.duration_s; time_s += 0.01) {
        const Eigen::Matrix3d turned = flight.T_W_B(time_s).linear().transpose() * flight.T_W_B(time_s + 0.01).linear();
        fastest_rad_s = std::max(fastest_rad_s, Eigen::AngleAxisd(turned).angle() / 0.01);
      }
      EXPECT_GT(fastest_rad_s, 1.04) << scene << " seed " << seed;
      EXPECT_LT(fastest_rad_s, 2.5) << scene << " seed " << seed;
    }
  }
}

TEST(Scenes, TheBeamOfATurnedFlightPassesBetweenThePickets) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Simulation simulation = flightOf("turning", seed);
    const CorridorTruth last = simulation.truth(simulation.frameTimes().size() - 1);
    EXPECT_NEAR(last.clear_exact_m, 2.5, 0.1) << seed;
    EXPECT_GT(simulation.ranges().back().range_m, 7.0) << seed;
  }
}

TEST(Scenes, AWeavingFlightTouchesNothing) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Scene scene = makeScene("weaving", seed);
    for (double time_s = 0.0; time_s < scene.flight.duration_s; time_s += 0.1) {
      const Eigen::Isometry3d T_W_B = scene.flight.T_W_B(time_s);
      for (const Primitive& primitive : scene.world) {
        EXPECT_FALSE(overlaps(T_W_B * Eigen::Translation3d(-0.3, 0.0, 0.0), {0.6, 0.6, 0.2}, primitive))
            << seed << " at " << time_s;
      }
    }
  }
}

TEST(Scenes, ABankingFlightRollsByThirtyAndPitchesByTwentyFiveDegrees) {
  const Flight flight = makeScene("banking", 0).flight;
  double roll_rad = 0.0, pitch_rad = 0.0;
  for (double time_s = 0.0; time_s < flight.duration_s; time_s += 0.01) {
    const Eigen::Matrix3d R_W_B = flight.T_W_B(time_s).linear();
    roll_rad = std::max(roll_rad, std::abs(std::atan2(R_W_B(2, 1), R_W_B(2, 2))));
    pitch_rad = std::max(pitch_rad, std::abs(std::asin(R_W_B(2, 0))));
  }
  EXPECT_GT(roll_rad, 0.4);
  EXPECT_LE(roll_rad, 0.525);  // 30 degrees
  EXPECT_GT(pitch_rad, 0.35);
  EXPECT_LE(pitch_rad, 0.44);  // 25 degrees
}

TEST(Scenes, TheForestIsToBeLookedAtAndIsNoFamily) {
  EXPECT_EQ(shownSceneNames(), std::vector<std::string>{"forest_gate"});
  EXPECT_EQ(sceneNames().size(), 55u);
  for (const std::string& name : sceneNames()) EXPECT_NE(name, "forest_gate");
  EXPECT_EQ(flightOf("forest_gate", 1).frame(0).left.size(), cv::Size(640, 480));
}

TEST(Scenes, TheForestBlocksTheCorridorFourTimesAndIsNeverTouched) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Simulation simulation = flightOf("forest_gate", seed);
    std::string story;  // of what is surely blocked and surely free
    for (std::size_t i = 0; i < simulation.frameTimes().size(); ++i) {
      const CorridorTruth truth = simulation.truth(i);
      if (truth.clear_shrunk_m != kInfinity && (story.empty() || story.back() != 'B')) story += 'B';
      if (truth.clear_inflated_m == kInfinity && (story.empty() || story.back() != 'F')) story += 'F';
      EXPECT_GT(truth.clear_inflated_m, 0.5) << seed << " frame " << i;
    }
    EXPECT_EQ(story, "FBFBFBFB") << seed;
  }
}

}  // namespace
}  // namespace flight_corridor::sim
