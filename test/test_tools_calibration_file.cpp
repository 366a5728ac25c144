#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "support/temporary_folder.hpp"
#include "tools/calibration_file.hpp"

namespace flight_corridor::tools {
namespace {

constexpr char kGood[] = "# rectified\nfx: 350\nfy: 351.5\ncx: 320\ncy: 240\ndoffs: -1.5\nbaseline: 0.12\nnote: any\n";

class CalibrationFileTest : public testing::Test {
 protected:
  std::string path() const { return folder.path("calib.yaml"); }
  StereoCalibration read(const std::string& text) const {
    std::ofstream(path()) << text;
    return readCalibration(path(), {640, 480});
  }
  /// Without the file's name, which stands before it.
  std::string error(const std::string& text) const {
    try {
      read(text);
    } catch (const std::runtime_error& e) {
      const std::string message = e.what();
      EXPECT_EQ(message.find(path() + ": "), 0u) << message;
      return message.substr(path().size() + 2);
    }
    return "";
  }
  static std::string with(const std::string& key, const std::string& value) {
    std::string text = kGood;
    const std::size_t begin = text.find("\n" + key + ":") + 1;
    return text.replace(begin, text.find('\n', begin) - begin, key + ": " + value);
  }

  test_support::TemporaryFolder folder;
};

TEST_F(CalibrationFileTest, HoldsTheNumbersOfTheRectifiedPair) {
  const StereoCalibration calibration = read(kGood);
  EXPECT_EQ(calibration.size_px, cv::Size(640, 480));
  EXPECT_EQ(calibration.fx_px, 350.0);
  EXPECT_EQ(calibration.fy_px, 351.5);
  EXPECT_EQ(calibration.cx_px, 320.0);
  EXPECT_EQ(calibration.cy_px, 240.0);
  EXPECT_EQ(calibration.cx_right_px, 318.5);
  EXPECT_EQ(calibration.baseline_m, 0.12);
  EXPECT_EQ(read("{fx: 350, fy: 351.5, cx: 320, cy: 240, doffs: -1.5, baseline: 0.12}").cx_right_px, 318.5);
}

TEST_F(CalibrationFileTest, NamesEveryKeyThatIsMissingOrNoNumber) {
  EXPECT_EQ(
      error("fx: wide\ncx: 320,0\ncy: [240]\nbaseline: 0.12\n")
          .find("missing: fy [px], doffs [px]; no numbers: fx [px] 'wide', cx [px] '320,0', cy [px]. Wanted are lines"),
      0u);
  EXPECT_EQ(error("focal: 350\n")
                .find("missing: fx [px], fy [px], cx [px], cy [px], doffs [px], baseline [m]. Wanted are lines"),
            0u);
  EXPECT_EQ(error(with("fy", "")).find("no numbers: fy [px]. "), 0u);
}

TEST_F(CalibrationFileTest, NamesABaselineInAnotherUnit) {
  for (const char* baseline : {"193.001", "120", "12", "4.7244", "-0.12", "0", ".nan", ".inf"}) {
    const std::string text = error(with("baseline", baseline));
    EXPECT_NE(text.find("baseline"), std::string::npos) << baseline << ": " << text;
  }
  EXPECT_NE(error(with("baseline", "193.001")).find("mm"), std::string::npos);
  EXPECT_NE(error(with("baseline", "12")).find("cm"), std::string::npos);
  EXPECT_NE(error(with("baseline", "4.7244")).find("inches"), std::string::npos);
}

TEST_F(CalibrationFileTest, NamesAnEmptyFileAndOneThatIsNotThere) {
  EXPECT_EQ(error("").find("is empty. Wanted are lines"), 0u);
  EXPECT_THROW(readCalibration(folder.path("no.yaml"), {640, 480}), std::runtime_error);
}

TEST_F(CalibrationFileTest, SaysWhatIsNotToBeReadAsYaml) {
  const std::string text = error("fx: 350\n\tfy: [350\n");
  EXPECT_NE(text.find("as YAML it cannot be read: "), std::string::npos) << text;
}

struct Foreign {
  const char* kind;
  const char* text;
  const char* conversion;  // a part of it
};

void PrintTo(const Foreign& foreign, std::ostream* out) { *out << foreign.kind; }

class ForeignCalibrationTest : public CalibrationFileTest, public testing::WithParamInterface<Foreign> {};

TEST_P(ForeignCalibrationTest, IsRefusedWithItsKindAllMissingKeysAndTheConversion) {
  for (const std::string& line_end : {std::string("\n"), std::string("\r\n")}) {
    std::string text;
    for (const char c : std::string(GetParam().text)) text += c == '\n' ? line_end : std::string(1, c);
    const std::string message = error(text);
    EXPECT_EQ(message.find("missing: fx [px], fy [px], cx [px], cy [px], doffs [px], baseline [m]"), 0u) << message;
    EXPECT_NE(message.find(std::string("; it looks like ") + GetParam().kind + ". "), std::string::npos) << message;
    EXPECT_NE(message.find(GetParam().conversion), std::string::npos) << message;
  }
}

constexpr Foreign kForeign[] = {
    {"a Kalibr camchain",
     "cam0:\n  camera_model: pinhole\n  intrinsics: [454.01, 453.84, 328.79, 248.33]\n  resolution: [640, 480]\ncam1:\n"
     "  T_cn_cnm1:\n  - [0.9997, -0.0053, 0.0211, -0.0751]\n  camera_model: pinhole\n",
     "stereoRectify"},
    {"a Kalibr camchain", "cam0: {cam_overlaps: [1], camera_model: omni}\ncam1:\n  T_cn_cnm1: [[1, 0, 0, -0.1]]\n",
     "stereoRectify"},
    {"an EuRoC sensor.yaml",
     "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\nT_BS:\n  cols: 4\n  rows: "
     "4\n"
     "  data: [0.0148, -0.9998, 0.0041, -0.0216]\nrate_hz: 20\nintrinsics: [458.654, 457.296, 367.215, 248.375]\n",
     "stereoRectify"},
    {"a KITTI calibration",
     "P0: 7.18e+02 0.0 6.07e+02 0.0 0.0 7.18e+02 1.85e+02 0.0 0.0 0.0 1.0 0.0\n"
     "P1: 7.18e+02 0.0 6.07e+02 -3.86e+02 0.0 7.18e+02 1.85e+02 0.0 0.0 0.0 1.0 0.0\n",
     "(P0[3] - P1[3]) / fx"},
    {"a KITTI calibration",
     "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\nS_rect_00: 1.2e+03 3.7e+02\n"
     "P_rect_00: 7.2e+02 0.0 6.0e+02 0.0 0.0 7.2e+02 1.7e+02 0.0 0.0 0.0 1.0 0.0\n",
     "(P0[3] - P1[3]) / fx"},
    {"an OpenCV calibration",
     "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 350., 0., 320., 0., 350., "
     "240., "
     "0., 0., 1. ]\nT: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -120., 0., 0. ]\n",
     "stereoRectify"},
    {"an OpenCV calibration", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1 type_id=\"opencv-matrix\">\n</M1>\n",
     "stereoRectify"},
    {"an ORB-SLAM settings file",
     "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\nCamera.bf: 47.9\n",
     "Camera.bf / Camera.fx"},
    {"a ROS camera calibration",
     "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [350, 0, "
     "320, "
     "0, 350, 240, 0, 0, 1]\ndistortion_model: plumb_bob\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: [350, 0, "
     "320, "
     "0, 0, 350, 240, 0, 0, 0, 1, 0]\n",
     "-P_right[3] / fx"},
    {"a ROS camera calibration",
     "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\ncamera matrix\n350 0 320\n\nprojection\n350 0 320 0\n",
     "-P_right[3] / fx"},
    {"a ROS CameraInfo message",
     "header: \n  seq: 1\nheight: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\nD: [0.0]\nK: [350.0]\nP: [350.0, "
     "0.0]\n",
     "-P_right[3] / fx"},
    {"a Middlebury calibration",
     "cam0=[5806.559 0 1429.219; 0 5806.559 993.403; 0 0 1]\ncam1=[5806.559 0 1543.51; 0 5806.559 993.403; 0 0 1]\n"
     "doffs=114.291\nbaseline=174.019\nwidth=2960\nheight=2016\nndisp=250\n",
     "baseline / 1000"},
    {"a ZED factory calibration",
     "[STEREO]\nBaseline=120.0\nCV_2K=0.01\n\n[LEFT_CAM_HD]\nfx=700.9\nfy=700.9\ncx=641.2\ncy=364.3\nk1=-0.17\n\n"
     "[RIGHT_CAM_HD]\nfx=701.2\n",
     "Baseline / 1000"},
};

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignCalibrationTest, testing::ValuesIn(kForeign));

}  // namespace
}  // namespace flight_corridor::tools
