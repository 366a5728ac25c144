#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core/persistence.hpp>
#include <sstream>
#include <stdexcept>
#include <tuple>

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

/// As cv::FileStorage writes it.
std::vector<std::string> writeXml(const RawRig& rig) {
  cv::FileStorage file(".xml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const auto [left, right] = std::tie(rig.cameras.left, rig.cameras.right);
  Eigen::Matrix3d R = rig.T_right_left.linear();
  Eigen::Vector3d T = rig.T_right_left.translation();
  cv::Mat R_cv, T_cv;
  cv::eigen2cv(R, R_cv);
  cv::eigen2cv(T, T_cv);
  file << "image_width" << static_cast<int>(left.width) << "image_height" << static_cast<int>(left.height);
  file << "M1" << cv::Mat(test_support::matrixK(left)) << "D1" << cv::Mat(left.D) << "R" << R_cv;
  file << "M2" << cv::Mat(test_support::matrixK(right)) << "D2" << cv::Mat(right.D) << "T" << T_cv;
  return {file.releaseAndGetString()};
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
    {"OpenCV XML", false, writeXml},
    {"ZED", false, [](const RawRig& rig) { return std::vector{test_support::zedConf(rig, "HD")}; }},
    {"ZED of fisheyes", true, [](const RawRig& rig) { return std::vector{test_support::zedConf(rig, "HD")}; }},
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
  StereoCameras readOf(const std::string& text, const ImageFormat& images) const {
    std::ofstream(folder.path("calibration")) << text;
    return readCalibration({folder.path("calibration")}, images);
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

TEST_F(CalibrationFaultsTest, NamesAnotherSizeAlsoOfAFileThatHoldsNone) {
  RawRig larger = rig();
  for (auto* camera : {&larger.cameras.left, &larger.cameras.right}) {
    for (const std::size_t i : {0, 2, 4, 5}) camera->K[i] *= 1.5;
    for (const std::size_t i : {0, 2, 3, 5, 6}) camera->P[i] *= 1.5;
  }
  for (const bool with_projections : {false, true}) {
    const std::string text = error({test_support::openCvYaml(larger, with_projections)});
    EXPECT_NE(text.find("far from the middle of 1280 x 720 px: the calibration is likely of "), std::string::npos)
        << text;
  }
}

TEST_F(CalibrationFaultsTest, NamesTheSizesOfAZedAndOfTheImages) {
  const std::string text = error({test_support::zedConf(rig(), "FHD") + test_support::zedConf(rig(), "VGA")});
  EXPECT_NE(text.find("these images are 1280x720, it is for those of 1920x1080, 672x376"), std::string::npos) << text;
}

TEST_F(CalibrationFaultsTest, NamesAZedsLensThatMayBeEither) {
  std::string text = test_support::zedConf(test_support::makeRawRig(truth(), true), "HD");
  const std::size_t begin = text.find("k4=");
  text.replace(begin, text.find('\n', begin) - begin, "k4=0");
  EXPECT_NE(error({text}).find("left_cam_hd:k4: is 0 without p1 and p2"), std::string::npos) << error({text});
}

TEST_F(CalibrationFaultsTest, NamesARectificationOfZeros) {
  RawRig none = rig();
  none.cameras.right.R.fill(0.0);
  EXPECT_NE(error(writeRos(none)).find("R of right is all 0"), std::string::npos) << error(writeRos(none));
}

TEST_F(CalibrationFaultsTest, NamesAnotherSize) {
  RawRig other = rig();
  other.cameras.left.width = other.cameras.right.width = 640;
  EXPECT_NE(error(writeRos(other)).find("it is for images of 640x720, these are 1280x720"), std::string::npos);
}

TEST_F(CalibrationFaultsTest, NamesAModelThatIsNotRead) {
  std::string text = test_support::kalibrYaml(rig());
  text.replace(text.find("radtan"), 6, "fov");
  EXPECT_NE(error({text}).find("cam0: distortion_model 'fov' is not supported"), std::string::npos) << error({text});
}

TEST_F(CalibrationFaultsTest, NamesWhatIsNoNumberNorRotation) {
  std::string text = test_support::kalibrYaml(rig());
  const std::size_t begin = text.find("intrinsics: [") + 13;
  text.replace(begin, 3, "wid");
  EXPECT_NE(error({text}).find("cam0: intrinsics: 'wid"), std::string::npos) << error({text});
  RawRig scaled = rig();
  scaled.T_right_left.linear() *= 2.0;
  EXPECT_NE(error({test_support::kalibrYaml(scaled)}).find("T_cn_cnm1: is not a rotation"), std::string::npos);
}

TEST_F(CalibrationFaultsTest, AnAliasToItselfHasAnEnd) { EXPECT_NE(error({"%YAML:1.0\nM1: &a [*a]\nD1: [0]\n"}), ""); }

/// Sections of every resolution: each image size takes its own, also of lenses of OpenCV's eight coefficients.
TEST_F(CalibrationFaultsTest, AZedsSectionIsThatOfTheImages) {
  const std::pair<const char*, cv::Size> resolutions[] = {{"VGA", {672, 376}},   {"HD", {1280, 720}},
                                                          {"FHD", {1920, 1080}}, {"2K", {2208, 1242}},
                                                          {"SVGA", {960, 600}},  {"FHD1200", {1920, 1200}}};
  std::string text;
  for (const auto& [name, size] : resolutions) {
    const double f = size.width / 1.9;
    for (const char* side : {"LEFT", "RIGHT"}) {
      text += std::string("[") + side + "_CAM_" + name + "]\nfx=" + std::to_string(f) + "\nfy=" + std::to_string(f) +
              "\ncx=" + std::to_string(size.width / 2) + "\ncy=" + std::to_string(size.height / 2) +
              "\nk1=-0.02\nk2=0.01\np1=0.001\np2=0\nk3=0\nk4=0.003\n";
    }
    text += std::string("[STEREO]\nBaseline=120\nRX_") + name + "=0\nCV_" + name + "=0\nRZ_" + name + "=0\n";
  }
  for (const auto& [name, size] : resolutions) {
    const StereoCameras cameras = readOf(text, {size});
    EXPECT_NEAR(cameras.left.K[0], size.width / 1.9, 1e-5) << name;
    EXPECT_EQ(cameras.left.distortion_model, "rational_polynomial");
    EXPECT_EQ(cameras.left.D, std::vector<double>({-0.02, 0.01, 0.001, 0, 0, 0.003, 0, 0, 0, 0, 0, 0}));
  }
}

/// Four cameras: cam0, cam1 in front, 0.24 m apart, then the rig, its left camera 0.5 m to the right of cam1 and
/// turned.
class KalibrChainTest : public CalibrationFaultsTest {
 protected:
  /// @param topics of the cameras.
  std::string chain(const std::vector<std::string>& topics) const {
    const RawRig raw = rig();
    Eigen::Isometry3d T_2_1(test_support::turned(0.02, 0.3, -0.1));
    T_2_1.translation() = Eigen::Vector3d(-0.5, 0.01, 0.02);
    const Eigen::Isometry3d poses[] = {Eigen::Isometry3d::Identity(),
                                       Eigen::Isometry3d(Eigen::Translation3d(-0.24, 0.0, 0.0)), T_2_1,
                                       raw.T_right_left};
    std::string text;
    for (std::size_t i = 0; i < topics.size(); ++i) {
      const auto& camera = i % 2 == 0 ? raw.cameras.left : raw.cameras.right;
      text += "cam" + std::to_string(i) + ":\n  camera_model: pinhole\n  distortion_model: radtan\n";
      text += "  intrinsics: [" + test_support::listed(test_support::intrinsics(camera)) + "]\n";
      text += "  distortion_coeffs: [-0.28, 0.07, 0.0004, -0.0003]\n  resolution: [1280, 720]\n";
      text += topics[i].empty() ? "" : "  rostopic: " + topics[i] + "\n";
      if (i == 0) continue;
      text += "  T_cn_cnm1: [" + test_support::listed(test_support::rowsOf(poses[i].matrix())) + "]\n";
    }
    return text;
  }
  StereoCameras readFor(const std::string& text, const PairNames& topics, const PairNames& cameras = {}) const {
    return readOf(text, {{1280, 720}, false, topics, cameras});
  }
  std::string errorFor(const PairNames& topics, const PairNames& cameras) const {
    try {
      readFor(chain(kTopics), topics, cameras);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  static double baseline(const StereoCameras& cameras) { return -cameras.right.P[3] / cameras.right.P[0]; }

  const std::vector<std::string> kTopics{"/front/left/image_raw", "/front/right/image_raw", "/stereo/left/image_raw",
                                         "/stereo/right/image_raw"};
};

TEST_F(KalibrChainTest, ThePairIsThatOfTheImagesTopics) {
  for (const std::string image : {"image_raw", "image_raw/compressed", "image_mono"}) {
    const StereoCameras cameras = readFor(chain(kTopics), {"/stereo/left/" + image, "stereo/right/" + image});
    EXPECT_EQ(cameras.names.left, "cam2");
    EXPECT_EQ(cameras.names.right, "cam3");
    EXPECT_NEAR(baseline(cameras), 0.12, 1e-6);
    EXPECT_NEAR(baseline(readFor(chain(kTopics), {"/front/left/" + image, "/front/right/" + image})), 0.24, 1e-6);
  }
}

/// cam0 lies 0.24 m beside cam1, cam2 0.5 m beyond it: |t| of the product, whatever the turn.
TEST_F(KalibrChainTest, BetweenCamerasThatAreNotNeighboursThePosesMultiply) {
  const std::string text = chain(kTopics);
  const Eigen::Vector3d t =
      Eigen::Vector3d(-0.5, 0.01, 0.02) + test_support::turned(0.02, 0.3, -0.1) * Eigen::Vector3d(-0.24, 0, 0);
  EXPECT_NEAR(baseline(readFor(text, {}, {"cam0", "cam2"})), t.norm(), 1e-6);
}

TEST_F(KalibrChainTest, WhatIsNamedCountsMoreThanTopics) {
  const StereoCameras cameras = readFor(chain(kTopics), {kTopics[0], kTopics[1]}, {"cam2", "cam3"});
  EXPECT_EQ(cameras.names.left, "cam2");
  EXPECT_NEAR(baseline(cameras), 0.12, 1e-6);
}

TEST_F(KalibrChainTest, ThatDoesNotSayWhichPairIsRefusedWithItsCamerasAndTheOptions) {
  for (const PairNames& topics : {PairNames{}, PairNames{"/a/left", "/a/right"}, PairNames{kTopics[2], "/a/right"},
                                  PairNames{kTopics[2], "/stereo/left/image"}}) {
    const std::string text = errorFor(topics, {});
    EXPECT_NE(text.find("cam0 (/front/left/image_raw), cam1"), std::string::npos) << text;
    EXPECT_NE(text.find("--calib-left NAME --calib-right NAME"), std::string::npos) << text;
  }
  EXPECT_NE(errorFor({}, {"cam2", "cam7"}).find("holds no camera cam7; it has cam0"), std::string::npos);
  EXPECT_NE(errorFor({}, {"cam2", "cam2"}).find("is not known"), std::string::npos);
}

/// The first camera of the chain is the right one.
TEST_F(KalibrChainTest, OfTwoIsTurnedByTopicOrByName) {
  RawRig turned = rig();
  std::swap(turned.cameras.left, turned.cameras.right);
  turned.T_right_left = turned.T_right_left.inverse();
  const std::string text = test_support::kalibrYaml(turned);
  for (const auto& [topics, names] : {std::pair<PairNames, PairNames>{{}, {"cam1", "cam0"}},
                                      {{}, {"cam1", ""}},
                                      {{"/cam1/image_raw", "/cam0/image_raw"}, {}},
                                      {{"/other", "/cam0/image_rect"}, {}}}) {
    const StereoCameras cameras = readFor(text, topics, names);
    EXPECT_EQ(cameras.names.left, "cam1");
    EXPECT_NEAR(baseline(cameras), 0.12, 1e-6);
    EXPECT_NEAR(cameras.left.K[2], rig().cameras.left.K[2], 1e-9);
  }
  EXPECT_NE(error({text}).find("cam1 stands to the left of cam0"), std::string::npos) << error({text});
  EXPECT_NE(error({text}).find("--calib-left cam1 --calib-right cam0"), std::string::npos) << error({text});
}

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
