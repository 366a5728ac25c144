#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "ros/conversions.hpp"
#include "support/raw_rig.hpp"
#include "support/temporary_folder.hpp"
#include "tools/calibration_file.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;
using test_support::RawRig;

StereoCalibration truth() {
  StereoCalibration calibration;
  calibration.size_px = {1280, 720};
  calibration.fx_px = calibration.fy_px = 700.0;
  calibration.cx_px = calibration.cx_right_px = 640.0;
  calibration.cy_px = 360.0;
  calibration.baseline_m = 0.12;
  return calibration;
}

/// The files of one recording, in the order in which they are given.
struct Kind {
  const char* name;
  bool is_equidistant;
  std::function<std::vector<std::string>(const RawRig& rig)> write;
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

std::vector<std::string> writeEuroc(const RawRig& rig) {
  Eigen::Isometry3d T_B_left(test_support::turned(0.1, -0.2, 1.57));
  T_B_left.translation() = Eigen::Vector3d(-0.02, -0.06, 0.01);
  const Eigen::Isometry3d T_B_right = T_B_left * rig.T_right_left.inverse();
  return {test_support::eurocYaml(rig.cameras.left, T_B_left), test_support::eurocYaml(rig.cameras.right, T_B_right)};
}

std::vector<std::string> writeRos(const RawRig& rig) {
  return {test_support::rosYaml(rig.cameras.left), test_support::rosYaml(rig.cameras.right)};
}

/// As rostopic echo prints them.
std::vector<std::string> writeInfos(const RawRig& rig) {
  const auto info = [](const sensor_msgs::CameraInfo& camera) {
    return "header: \n  seq: 1\nheight: " + std::to_string(camera.height) + "\nwidth: " + std::to_string(camera.width) +
           "\ndistortion_model: \"" + camera.distortion_model + "\"\nD: [" + test_support::listed(camera.D) +
           "]\nK: [" + test_support::listed(camera.K) + "]\nR: [" + test_support::listed(camera.R) + "]\nP: [" +
           test_support::listed(camera.P) + "]\nbinning_x: 0\n---\n";
  };
  return {info(rig.cameras.left), info(rig.cameras.right)};
}

const Kind kKinds[] = {
    {"Kalibr radtan", false, [](const RawRig& rig) { return std::vector{test_support::kalibrYaml(rig)}; }},
    {"Kalibr equidistant", true, [](const RawRig& rig) { return std::vector{test_support::kalibrYaml(rig)}; }},
    {"EuRoC radtan", false, writeEuroc},
    {"EuRoC equidistant", true, writeEuroc},
    {"ost.yaml radtan", false, writeRos},
    {"ost.yaml equidistant", true, writeRos},
    {"CameraInfo", false, writeInfos},
    {"OpenCV R, T", false, [](const RawRig& rig) { return std::vector{test_support::openCvYaml(rig, false)}; }},
    {"OpenCV R, T of fisheyes", true,
     [](const RawRig& rig) { return std::vector{test_support::openCvYaml(rig, false)}; }},
    {"OpenCV R1, P1, R2, P2", false,
     [](const RawRig& rig) { return std::vector{test_support::openCvYaml(rig, true)}; }},
    {"ZED", false, [](const RawRig& rig) { return std::vector{test_support::zedConf(rig)}; }},
};

class CalibrationKindsTest : public testing::TestWithParam<Kind> {
 protected:
  StereoCameras read(const std::vector<std::string>& texts) const {
    std::vector<std::string> paths;
    for (const std::string& text : texts) {
      paths.push_back(folder.path("calibration" + std::to_string(paths.size())));
      std::ofstream(paths.back()) << text;
    }
    return readCalibration(paths, {truth().size_px});
  }

  test_support::TemporaryFolder folder;
};

/// Points before the rig go through its true lenses and then through what was read: they must come out on one row, at
/// their depth. Iterative undistortion is exact to 1e-3 px within these lenses; on the depth Z that is Z / (f B) *
/// 1e-3.
TEST_P(CalibrationKindsTest, RectifiesPointsToOneRowAndTheirDepth) {
  const RawRig rig = test_support::makeRawRig(truth(), GetParam().is_equidistant);
  const StereoCameras cameras = read(GetParam().write(rig));
  EXPECT_FALSE(areRectified(cameras));
  const StereoCameras ideal = rectified(cameras);
  const StereoGeometry geometry(flight_corridor_ros::toCalibration(ideal.left, ideal.right));
  EXPECT_NEAR(geometry.calibration().baseline_m, 0.12, 1e-6);
  std::vector<cv::Point3d> in_left, in_right;
  for (const double x : {-1.0, -0.3, 0.5, 1.1}) {
    for (const double y : {-0.6, 0.1, 0.7}) {
      for (const double z : {2.0, 5.0}) {
        const Eigen::Vector3d p_left(x, y, z), p_right = rig.T_right_left * p_left;
        in_left.emplace_back(p_left.x(), p_left.y(), p_left.z());
        in_right.emplace_back(p_right.x(), p_right.y(), p_right.z());
      }
    }
  }
  const auto left = test_support::rectify(cameras.left, test_support::projectRaw(rig.cameras.left, in_left));
  const auto right = test_support::rectify(cameras.right, test_support::projectRaw(rig.cameras.right, in_right));
  const cv::Matx33d R(cameras.left.R.data());
  for (std::size_t i = 0; i < left.size(); ++i) {
    EXPECT_NEAR(left[i].y, right[i].y, 2e-3);
    const double disparity_px = left[i].x - right[i].x - geometry.principalPointDifference();
    const double depth_m = (R * in_left[i]).z;
    EXPECT_NEAR(geometry.depth(disparity_px), depth_m, geometry.depthSigma(depth_m, 2e-3));
  }
}

/// A tool must survive what a person cuts out of a file, and name it.
TEST_P(CalibrationKindsTest, RefusesWhatIsCutOffNamingTheFile) {
  const RawRig rig = test_support::makeRawRig(truth(), GetParam().is_equidistant);
  const std::vector<std::string> texts = GetParam().write(rig);
  int refused = 0;
  for (std::size_t size = 1; size + 1 < texts.front().size(); size += 37) {
    std::vector<std::string> cut = texts;
    cut.front().resize(size);
    try {
      read(cut);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find(folder.path("calibration0")), 0u) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
}

INSTANTIATE_TEST_SUITE_P(Kinds, CalibrationKindsTest, testing::ValuesIn(kKinds));

class CalibrationFaultsTest : public CalibrationKindsTest {
 protected:
  std::string error(const std::vector<std::string>& texts) const {
    try {
      read(texts);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  static RawRig rig() { return test_support::makeRawRig(truth(), false); }
};

TEST_F(CalibrationFaultsTest, NamesABaselineInMillimetres) {
  const std::string text = error({test_support::openCvYaml(rig(), false, 1000.0)});
  EXPECT_NE(text.find("baseline must be 0.01 to 2 m (120 m; likely in mm (0.120000 m)"), std::string::npos) << text;
}

TEST_F(CalibrationFaultsTest, NamesLeftAndRightExchanged) {
  std::vector<std::string> texts = writeEuroc(rig());
  std::swap(texts[0], texts[1]);
  EXPECT_NE(error(texts).find("left and right are exchanged"), std::string::npos) << error(texts);
}

TEST_F(CalibrationFaultsTest, NamesAFileThatIsGivenAloneOrOnceTooOften) {
  EXPECT_NE(error({writeEuroc(rig())[0]}).find("give both files, left and right"), std::string::npos);
  const std::string kalibr = test_support::kalibrYaml(rig());
  EXPECT_NE(error({kalibr, kalibr}).find("holds both cameras: give it alone"), std::string::npos);
}

TEST_F(CalibrationFaultsTest, NamesAnotherSize) {
  RawRig other = rig();
  other.cameras.left.width = other.cameras.right.width = 640;
  EXPECT_NE(error(writeRos(other)).find("it is for images of 640x720, these are 1280x720"), std::string::npos);
}

TEST_F(CalibrationFaultsTest, NamesAModelThatIsNotRead) {
  std::string text = test_support::kalibrYaml(rig());
  text.replace(text.find("radtan"), 6, "fov");
  EXPECT_NE(error({text}).find("cam0: distortion_model 'fov' is not read"), std::string::npos) << error({text});
}

TEST_F(CalibrationFaultsTest, NamesWhatIsNoNumberNorRotation) {
  std::string text = test_support::kalibrYaml(rig());
  const std::size_t begin = text.find("intrinsics: [") + 13;
  text.replace(begin, 3, "wid");
  EXPECT_NE(error({text}).find("cam0: intrinsics: 'wid"), std::string::npos) << error({text});
  RawRig scaled = rig();
  scaled.T_right_left.linear() *= 2.0;
  EXPECT_NE(error({test_support::kalibrYaml(scaled)}).find("T_cn_cnm1: is no rotation"), std::string::npos);
}

TEST_F(CalibrationFaultsTest, AnAliasToItselfHasAnEnd) { EXPECT_NE(error({"%YAML:1.0\nM1: &a [*a]\nD1: [0]\n"}), ""); }

class RectifiedCalibrationTest : public CalibrationKindsTest {
 protected:
  StereoCalibration readRectified(const std::string& text, const ImageFormat& images) const {
    std::ofstream(folder.path("calib.txt")) << text;
    const StereoCameras cameras = readCalibration({folder.path("calib.txt")}, images);
    EXPECT_TRUE(areRectified(cameras));
    return flight_corridor_ros::toCalibration(cameras.left, cameras.right);
  }
};

TEST_F(RectifiedCalibrationTest, MiddleburysBaselineIsInMillimetres) {
  const StereoCalibration calibration = readRectified(
      "cam0=[ 989.886 0 392.942 ; 0 989.886 243.221 ; 0 0 1 ]\n cam1=[ 989.886 0 412.274 ; 0 989.886 243.221 ; 0 0 1 "
      "]\n"
      "doffs= 19.331\r\nbaseline= 236.922 \n width= 735 \nheight= 485\n",
      {{735, 485}});
  EXPECT_NEAR(calibration.baseline_m, 0.236922, 1e-9);
  EXPECT_EQ(calibration.fx_px, 989.886);
  EXPECT_NEAR(calibration.cx_right_px - calibration.cx_px, 19.331, 1e-9);
}

TEST_F(RectifiedCalibrationTest, KittisGreyAndColourPairsHaveTheirOwnNumbers) {
  const std::string text =
      "P0: 7.07e+02 0 6.01e+02 0 0 7.07e+02 1.83e+02 0 0 0 1 0\n"
      "P1: 7.07e+02 0 6.01e+02 -3.7961e+02 0 7.07e+02 1.83e+02 0 0 0 1 0\n"
      "P2: 7.07e+02 0 6.01e+02 4.688783e+01 0 7.07e+02 1.83e+02 1.178601e-01 0 0 1 6.203223e-03\n"
      "P3: 7.07e+02 0 6.01e+02 -3.334597e+02 0 7.07e+02 1.83e+02 1.930130e+00 0 0 1 3.318498e-03\n";
  EXPECT_NEAR(readRectified(text, {{1224, 370}, false}).baseline_m, 379.61 / 707.0, 1e-9);
  EXPECT_NEAR(readRectified(text, {{1224, 370}, true}).baseline_m,
              (46.88783 - 601 * 0.006203223 + 333.4597 + 601 * 0.003318498) / 707.0, 1e-9);
}

/// Recordings of others, where they are at hand: their calibrations beside what others computed of them.
class RealCalibrationTest : public RectifiedCalibrationTest {
 protected:
  void SetUp() override {
    if (!fs::is_directory(data)) GTEST_SKIP() << data << " is not there";
  }
  void expectSame(const std::vector<std::string>& originals, const std::string& computed, const ImageFormat& images) {
    const StereoCameras original = rectified(readCalibration(originals, images));
    const StereoCameras taken = readCalibration({computed}, images);
    for (std::size_t i = 0; i < taken.right.P.size(); ++i) {
      EXPECT_NEAR(original.left.P[i], taken.left.P[i], 1e-3);  // as they were rounded
      EXPECT_NEAR(original.right.P[i], taken.right.P[i], 1e-3);
    }
  }

  // A workspace holds links to the repository's folders.
  const fs::path repository = fs::canonical(fs::path(FLIGHT_CORRIDOR_SOURCE_DIR) / "src").parent_path();
  const fs::path data = repository / ".." / "shared" / "data";
};

TEST_F(RealCalibrationTest, OfMiddleburyAgrees) {
  const fs::path scene = data / "middlebury_v3_quarter" / "Pipes";
  expectSame({(scene / "calib_original.txt").string()}, (scene / "calib.yaml").string(), {{735, 485}, true});
}

TEST_F(RealCalibrationTest, OfKittisColourImagesAgrees) {
  const fs::path still = data / "kitti_object_stills" / "000001";
  expectSame({(still / "calib_original.txt").string()}, (still / "calib.yaml").string(), {{1242, 375}, true});
}

TEST_F(RealCalibrationTest, OfEurocAgrees) {
  const fs::path flight = data / "euroc_mh01_handheld";
  expectSame({(flight / "calib_original_cam0.yaml").string(), (flight / "calib_original_cam1.yaml").string()},
             (flight / "calib.yaml").string(), {{752, 480}});
}

}  // namespace
}  // namespace flight_corridor::tools
