#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "ros/conversions.hpp"
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
    const StereoCameras cameras = readCalibration({path()}, {{640, 480}});
    return flight_corridor_ros::toCalibration(cameras.left, cameras.right);
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
  EXPECT_THROW(readCalibration({folder.path("no.yaml")}, {{640, 480}}), std::runtime_error);
}

TEST_F(CalibrationFileTest, NamesTheFileTheNumbersAndTheLikelySizeWhereItIsOfAnotherSize) {
  std::string text = with("cx", "427");
  text.replace(text.find("cy: 240"), 7, "cy: 322");
  EXPECT_NE(error(text).find("the principal point (427, 322) is far from the middle of 640 x 480 px: the calibration "
                             "is likely of "),
            std::string::npos)
      << error(text);
}

TEST_F(CalibrationFileTest, NamesNoCamerasToChooseFrom) {
  std::ofstream(path()) << kGood;
  EXPECT_THROW(readCalibration({path()}, {{640, 480}, false, {}, {"cam1", ""}}), std::runtime_error);
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
    {"an ORB-SLAM settings file",
     "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\nCamera.bf: 47.9\n",
     "Camera.bf / Camera.fx"},
    {"a ROS camera calibration as text",
     "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\ncamera matrix\n350 0 320\n\nprojection\n350 0 320 0\n",
     "-P_right[3] / fx"},
};

INSTANTIATE_TEST_SUITE_P(Kinds, ForeignCalibrationTest, testing::ValuesIn(kForeign));

}  // namespace
}  // namespace flight_corridor::tools
