#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "flight_corridor/geometry/stereo_geometry.hpp"
#include "ros/camera_info_file.hpp"
#include "ros/conversions.hpp"
#include "support/contains.hpp"
#include "support/raw_rig.hpp"
#include "support/temporary_folder.hpp"

namespace flight_corridor_ros {
namespace {

using flight_corridor::test_support::contains;

const std::string kEuroc = FLIGHT_CORRIDOR_SOURCE_DIR "/config/euroc/";

std::string complaintAboutCalibration(const std::string& path) {
  try {
    readCameraInfo(path);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

class CameraInfoFile : public testing::Test {
 protected:
  /// The shipped file of the left camera with a text replaced.
  std::string write(const std::string& text, const std::string& replacement) const {
    std::stringstream file;
    file << std::ifstream(kEuroc + "left.yaml").rdbuf();
    std::string content = file.str();
    content.replace(content.find(text), text.size(), replacement);
    std::ofstream(path()) << content;
    return path();
  }
  std::string path() const { return folder.path("camera.yaml"); }

  flight_corridor::test_support::TemporaryFolder folder;
};

TEST_F(CameraInfoFile, TheShippedPairIsARectifiedRig) {
  const sensor_msgs::CameraInfo left = readCameraInfo(kEuroc + "left.yaml"),
                                right = readCameraInfo(kEuroc + "right.yaml");
  const auto calibration = toCalibration(left, right);
  EXPECT_EQ(calibration.size_px, cv::Size(752, 480));
  EXPECT_NEAR(calibration.baseline_m, 0.1101, 1e-4);  // between T_BS of cam0 and cam1
  EXPECT_EQ(left.distortion_model, "plumb_bob");
  EXPECT_EQ(left.D.size(), 5u);
  EXPECT_EQ(left.K[0], 458.654);
  EXPECT_EQ(right.R[1], -0.00362581187);
}

TEST_F(CameraInfoFile, NamesAMissingFileAndOneThatHoldsNoMap) {
  EXPECT_TRUE(contains(complaintAboutCalibration("/no/such.yaml"), "/no/such.yaml"));
  std::ofstream(path()) << "- 1\n";
  EXPECT_TRUE(contains(complaintAboutCalibration(path()), path() + ": holds no calibration"));
}

TEST_F(CameraInfoFile, NamesEveryKeyThatIsMissingOrWrong) {
  EXPECT_TRUE(contains(complaintAboutCalibration(write("image_width", "width")), "image_width"));
  EXPECT_TRUE(contains(complaintAboutCalibration(write("image_height: 480", "image_height: tall")), "image_height"));
  EXPECT_TRUE(contains(complaintAboutCalibration(write("458.654, ", "")), "camera_matrix: 8 numbers, must be 9"));
  sensor_msgs::CameraInfo info = readCameraInfo(kEuroc + "left.yaml");
  info.R.fill(0.0);
  std::ofstream(path()) << flight_corridor::test_support::rosYaml(info);
  EXPECT_TRUE(contains(complaintAboutCalibration(path()), "rectification_matrix is all 0"));
  std::ofstream(path()) << "image_width: 752\n";
  const std::string complaint = complaintAboutCalibration(path());
  for (const char* key : {"image_height", "distortion_model", "distortion_coefficients", "camera_matrix",
                          "rectification_matrix", "projection_matrix"}) {
    EXPECT_TRUE(contains(complaint, key)) << complaint;
  }
}

}  // namespace
}  // namespace flight_corridor_ros
