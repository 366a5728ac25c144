#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "flight_corridor/corridor/corridor.hpp"
#include "support/raw_rig.hpp"
#include "support/temporary_folder.hpp"
#include "tools/folder.hpp"
#include "tools/stereo_bag_reader.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    fs::create_directory(folder.path("left"));
    fs::create_directory(folder.path("right"));
    for (const char* name : {"left/000000.png", "left/000001.png", "right/000000.png", "right/000001.png"}) {
      cv::imwrite(folder.path(name), cv::Mat(6, 8, CV_8UC1, 77));
    }
    write("calib.yaml", "# rectified\nfx: 10\nfy: 10\ncx: 4\ncy: 3\nbaseline: 0.2\ndoffs: 1.5\nnote: \"any\"\n");
    write("timestamps.csv", "frame,stamp_s\n0,1403715273.262142976\n1,1403715273.312143104\n");
    write("range.csv", "# why\nframe,stamp_s,range_m\n0,1403715273.262142976,2.5\n1,1403715273.312143104,\n");
    write("poses.csv", "stamp_s,tx,ty,tz,qx,qy,qz,qw\n1403715273.262142976,1,2,3,0,0,0,1\n");
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder.path(name)) << text; }
  std::string root() const { return fs::path(folder.path("left")).parent_path().string(); }

  std::string error() const {
    try {
      writeBag(readFolder(root(), {}), folder.path("out.bag"), [] {});
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  test_support::TemporaryFolder folder;
};

TEST_F(FolderTest, IsReadWithStampsRangesPosesAndCalibration) {
  const FolderRecording recording = readFolder(root(), {});
  EXPECT_EQ(recording.rig.calibration.cx_right_px, 5.5);
  EXPECT_EQ(recording.rig.calibration.baseline_m, 0.2);
  EXPECT_EQ(recording.rig.calibration.size_px, cv::Size(8, 6));
  ASSERT_EQ(recording.pairs.size(), 2u);
  EXPECT_EQ(recording.pairs[1].stamp, ros::Time(1403715273, 312143104));
  EXPECT_EQ(recording.pairs[1].value.right, folder.path("right/000001.png"));
  ASSERT_EQ(recording.ranges_m.size(), 1u) << "an empty cell is no reading";
  EXPECT_EQ(recording.ranges_m[0].value, 2.5);
  ASSERT_EQ(recording.poses_W_B.size(), 1u);
}

TEST_F(FolderTest, PoseOfTheCameraIsPoseOfTheBodyTimesItsMounting) {
  const FolderRecording recording = readFolder(root(), {});
  Eigen::Isometry3d T_W_C = Eigen::Isometry3d::Identity();
  T_W_C.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE((recording.poses_W_B[0].value * recording.rig.T_B_C).isApprox(T_W_C));
}

TEST_F(FolderTest, BeamLiesOnTheOpticalAxis) {
  const BagRig rig = readFolder(root(), {}).rig;
  const Eigen::Isometry3d T_C_L = rig.T_B_C.inverse() * rig.T_B_L;
  EXPECT_TRUE(T_C_L.translation().isZero());
  EXPECT_TRUE((T_C_L.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_F(FolderTest, BecomesABagOfTheSamePairsAndRanges) {
  ASSERT_EQ(error(), "");
  const StereoBagReader bag(folder.path("out.bag"), {});
  int pairs = 0, ranges = 0;
  bag.play({}, {[&](const StereoMessages& pair) {
                  ++pairs;
                  EXPECT_EQ(pair.left->data.front(), 77);
                },
                [&](const sensor_msgs::RangeConstPtr&) { ++ranges; }});
  EXPECT_EQ(pairs, 2);
  EXPECT_EQ(ranges, 1);
}

TEST_F(FolderTest, WholeNumbersCountByTheirValueAndOtherNamesAsTheyAre) {
  const auto rename = [&](const std::string& old_0, const std::string& old_1, const std::string& new_0,
                          const std::string& new_1) {
    for (const std::string side : {"left/", "right/"}) {
      fs::rename(folder.path(side + old_0), folder.path(side + new_0));
      fs::rename(folder.path(side + old_1), folder.path(side + new_1));
    }
    return readFolder(root(), {}).pairs;
  };
  auto pairs = rename("000000.png", "000001.png", "10.png", "2.png");
  EXPECT_EQ(pairs[0].value.left, folder.path("left/2.png"));
  pairs = rename("10.png", "2.png", "12.25.png", "12.3.png");  // stamps
  EXPECT_EQ(pairs[0].value.left, folder.path("left/12.25.png"));
  pairs = rename("12.25.png", "12.3.png", "1a.png", "2.png");
  EXPECT_EQ(pairs[0].value.left, folder.path("left/2.png")) << "numbers before names";
}

TEST_F(FolderTest, NeedsOnlyImagesAndCalibration) {
  for (const char* name : {"timestamps.csv", "range.csv", "poses.csv"}) fs::remove(folder.path(name));
  const FolderRecording recording = readFolder(root(), {});
  EXPECT_EQ(recording.pairs[1].stamp - recording.pairs[0].stamp, ros::Duration(0.1));
  EXPECT_TRUE(recording.ranges_m.empty());
}

TEST_F(FolderTest, StampZeroMovesToOneSecondEverywhere) {
  write("timestamps.csv", "frame,stamp_s\n0,0\n1,0.1044989\n");
  write("range.csv", "frame,stamp_s,range_m\n0,0.0,2.5\n");
  write("poses.csv", "stamp_s,tx,ty,tz,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n");
  const FolderRecording recording = readFolder(root(), {});
  EXPECT_EQ(recording.pairs[0].stamp, ros::Time(1, 0));
  EXPECT_EQ(recording.pairs[1].stamp, ros::Time(1, 104498900));
  EXPECT_EQ(recording.ranges_m[0].stamp, ros::Time(1, 0));
  EXPECT_EQ(recording.poses_W_B[0].stamp, ros::Time(1, 0));
}

TEST_F(FolderTest, NamesWhatIsMissing) {
  fs::remove(folder.path("right/000001.png"));
  EXPECT_EQ(error(),
            folder.path("right/000001.png") + ": is missing, but " + folder.path("left/000001.png") + " is there");
}

TEST_F(FolderTest, NamesAFolderThatIsNotThere) { EXPECT_THROW(readFolder("/no/such/folder", {}), std::runtime_error); }

TEST_F(FolderTest, NamesAnImageThatIsEmpty) {
  write("right/000001.png", "");
  EXPECT_EQ(error(), folder.path("right/000001.png") + ": is not a readable image");
}

TEST_F(FolderTest, NamesAnImageOfAnotherSize) {
  cv::imwrite(folder.path("right/000001.png"), cv::Mat(6, 7, CV_8UC1, 77));
  EXPECT_EQ(error(), folder.path("right/000001.png") + ": is 7x6, the recording's first image is 8x6");
}

TEST_F(FolderTest, NamesAMissingKeyOfTheCalibration) {
  write("calib.yaml", "fx: 10\nfy: 10\ncx: 4\ncy: 3\nbaseline: 0.2\n");
  EXPECT_EQ(error().find(folder.path("calib.yaml") + ": missing: doffs [px]. "), 0u) << error();
}

TEST_F(FolderTest, OfAChainTheNamedCamerasAreTaken) {
  std::string chain;
  for (int i = 0; i < 3; ++i) {
    chain += "cam" + std::to_string(i) + ":\n  camera_model: pinhole\n  distortion_model: none\n" +
             "  intrinsics: [10, 10, 4, 3]\n  resolution: [8, 6]\n  T_cn_cnm1: [[1, 0, 0, -0." + std::to_string(i) +
             "], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  }
  write("calib.yaml", chain);
  const FolderReading reading{10.0, {}, ImageState::AsNamed, {"cam1", "cam2"}};
  EXPECT_NEAR(readFolder(root(), reading).rig.calibration.baseline_m, 0.2, 1e-6);
  EXPECT_EQ(readFolder(root(), reading).calibration.find("calibration: left cam1 plumb_bob of 4 coefficients, "), 0u);
  EXPECT_NE(error().find("which of its cameras are left and right is not known: cam0, cam1, cam2. Name them: --calib-"),
            std::string::npos)
      << error();
}

TEST_F(FolderTest, RefusesAZeroBaseline) {
  write("calib.yaml", "fx: 10\nfy: 10\ncx: 4\ncy: 3\nbaseline: 0\ndoffs: 0\n");
  EXPECT_EQ(error().find(folder.path("calib.yaml") + ": "), 0u) << error();
  EXPECT_NE(error().find("baseline"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(folder.path("out.bag")));
}

TEST_F(FolderTest, RefusesStampsThatDoNotMatchTheImages) {
  write("timestamps.csv", "frame,stamp_s\n0,1\n");
  EXPECT_EQ(error(), folder.path("timestamps.csv") + ": 1 stamps, but left/ holds 2 images");
}

TEST_F(FolderTest, RefusesTheStampsOfEuroc) {
  const std::string data = "1403636579763555584,1403636579763555584.png\n1403636579813555456,1403636579813555456.png\n";
  write("timestamps.csv", "#timestamp [ns],filename\n" + data);
  EXPECT_EQ(error().find(folder.path("timestamps.csv") + ": no column 'stamp_s'; line 2, the header, is '140363"), 0u);
  EXPECT_NE(error().find("'#timestamp [ns],filename' above it is a comment"), std::string::npos) << error();
  EXPECT_NE(error().find("stamps in seconds"), std::string::npos) << error();
  write("timestamps.csv", "stamp_s,filename\n" + data);
  EXPECT_EQ(error(), folder.path("timestamps.csv") +
                         ":2: column 'stamp_s': '1403636579763555584' is in nanoseconds; wanted are seconds, "
                         "sec.nanosec");
}

TEST_F(FolderTest, RefusesStampsOfASmallerUnitThatBeginAtZero) {
  for (const char* text : {"stamp_s\n0\n50000000\n", "stamp_s\n0\n50000\n", "stamp_s\n0\n50\n"}) {
    write("timestamps.csv", text);
    EXPECT_NE(error().find("s apart, more than 10"), std::string::npos) << error();
  }
}

TEST_F(FolderTest, RefusesADecimalComma) {
  write("timestamps.csv", "stamp_s\n1403636579,763555584\n1403636579,813555456\n");
  EXPECT_EQ(error(), folder.path("timestamps.csv") + ":2: 2 cells, the header has 1");
}

TEST_F(FolderTest, NamesTheFileAndTheUnitOfABaselineInMillimetres) {
  write("calib.yaml", "fx: 10\nfy: 10\ncx: 4\ncy: 3\nbaseline: 193.001\ndoffs: 0\n");
  EXPECT_EQ(error().find(folder.path("calib.yaml") + ": "), 0u) << error();
  EXPECT_NE(error().find("193.001"), std::string::npos) << error();
  EXPECT_NE(error().find("mm"), std::string::npos) << error();
}

TEST_F(FolderTest, RefusesStampsThatDoNotAscend) {
  const std::string complaint = "column 'stamp_s': 1.000000000 is not later than the one before, ";
  write("timestamps.csv", "frame,stamp_s\n0,1\n1,1\n");
  EXPECT_EQ(error(), folder.path("timestamps.csv") + ":3: " + complaint + "1.000000000");
  write("timestamps.csv", "frame,stamp_s\n0,1\n1,2\n");
  write("range.csv", "# why\nframe,stamp_s,range_m\n1,2,2.5\n0,1,2.5\n");
  EXPECT_EQ(error(), folder.path("range.csv") + ":4: " + complaint + "2.000000000");
  write("range.csv", "frame,stamp_s,range_m\n0,1,2.5\n");
  write("poses.csv", "stamp_s,tx,ty,tz,qx,qy,qz,qw\n2,1,2,3,0,0,0,1\n1,1,2,3,0,0,0,1\n");
  EXPECT_EQ(error(), folder.path("poses.csv") + ":3: " + complaint + "2.000000000");
}

TEST_F(FolderTest, RefusesANegativeRangeButKeepsWhatRep117Allows) {
  write("range.csv", "stamp_s,range_m\n1,inf\n2,-inf\n3,nan\n4,0\n");
  EXPECT_EQ(readFolder(root(), {}).ranges_m.size(), 4u);
  write("range.csv", "stamp_s,range_m\n1,-0.5\n");
  EXPECT_EQ(error(), folder.path("range.csv") + ":2: column 'range_m': a range is not negative; too close is -inf");
}

TEST_F(FolderTest, DoubtsTheUnitOfRanges) {
  const auto complaint = [&](const std::string& rows, const std::string& header = "stamp_s,range_m") {
    write("range.csv", header + "\n" + rows);
    return error();
  };
  EXPECT_NE(complaint("1,3200.5\n2,3190.0\n3,inf\n4,3300.0\n")
                .find("3200.5 or more, farther than a LiDAR measures: likely in mm "
                      "(3.2005 m), or in cm (32.005 m). Divide to metres"),
            std::string::npos)
      << error();
  EXPECT_NE(complaint("1,320\n2,\n3,320\n").find("likely in mm (0.32 m), or in cm (3.2 m)"), std::string::npos)
      << error();
  EXPECT_NE(complaint("1,150\n2,149\n3,148\n").find("all are whole numbers: likely in cm (1.49 m)"), std::string::npos)
      << error();
  EXPECT_NE(complaint("1,150\n2,149\n").find("write decimals"), std::string::npos) << error();
  EXPECT_NE(complaint("1,1e9\n").find("in which unit?"), std::string::npos) << error();
  EXPECT_NE(complaint("1,320 m\n").find(":2: column 'range_m': '320 m' is not a number: leave 'm' out"),
            std::string::npos)
      << error();
  EXPECT_NE(complaint("1,3.2mm\n").find("leave 'mm' out"), std::string::npos) << error();
  EXPECT_NE(complaint("1,3200\n", "stamp_s,range_mm").find("Wanted are metres under this name"), std::string::npos)
      << error();
}

TEST_F(FolderTest, TakesRangesThatMayBeMetres) {
  for (const char* rows : {"1,3\n2,4\n", "1,149.5\n2,148.0\n", "1,130.00\n2,130.00\n3,2.5\n", "1,inf\n2,nan\n",
                           "1,12.0\n", "1,65535\n2,3.5\n3,3.4\n", "", "1,\n"}) {
    write("range.csv", std::string("stamp_s,range_m\n") + rows);
    EXPECT_EQ(error(), "") << rows;
  }
}

TEST_F(FolderTest, RefusesAPositionThatIsNotFinite) {
  write("poses.csv", "stamp_s,tx,ty,tz,qx,qy,qz,qw\n1,1,nan,3,0,0,0,1\n");
  EXPECT_EQ(error(), folder.path("poses.csv") + ":2: column 'tx': the position is not finite");
}

TEST_F(FolderTest, NamesAMissingCalibrationOnce) {
  fs::remove(folder.path("calib.yaml"));
  EXPECT_EQ(error(), folder.path("calib.yaml") + ": cannot be read");
}

/// A folder as EuRoC's recordings are unpacked.
class EurocFolderTest : public testing::Test {
 protected:
  EurocFolderTest() {
    rig = test_support::makeRawRig(clean, false);
    for (const char* camera : {"mav0/cam0", "mav0/cam1"}) fs::create_directories(folder.path(camera) + "/data");
    for (const char* stamp : {"1403636579763555584", "1403636579813555456"}) {
      for (const char* camera : {"mav0/cam0", "mav0/cam1"}) {
        cv::imwrite(folder.path(camera) + "/data/" + stamp + ".png", cv::Mat(clean.size_px, CV_8UC1, 77));
      }
    }
    const Eigen::Isometry3d T_B_left(test_support::turned(0.0, 0.0, 1.57));
    std::ofstream(folder.path("mav0/cam0/sensor.yaml")) << test_support::eurocYaml(rig.cameras.left, T_B_left);
    std::ofstream(folder.path("mav0/cam1/sensor.yaml"))
        << test_support::eurocYaml(rig.cameras.right, T_B_left * rig.T_right_left.inverse());
  }
  std::string root() const { return fs::path(folder.path("mav0")).parent_path().string(); }

  StereoCalibration clean{{64, 48}, 50.0, 50.0, 31.5, 23.5, 31.5, 0.11};
  test_support::RawRig rig;
  test_support::TemporaryFolder folder;
};

TEST_F(EurocFolderTest, IsRectifiedAndStampedByItsNames) {
  const FolderRecording recording = readFolder(root(), {});
  ASSERT_TRUE(recording.rectifier);
  EXPECT_NEAR(recording.rig.calibration.baseline_m, 0.11, 1e-6);
  EXPECT_EQ(recording.pairs[1].stamp, ros::Time(1403636579, 813555456));
  writeBag(recording, folder.path("out.bag"), [] {});
  const StereoBagReader bag(folder.path("out.bag"), {});
  int pairs = 0;
  bag.play({}, {[&](const StereoMessages& pair) {
                  ++pairs;
                  EXPECT_EQ(pair.left->data[24 * 64 + 32], 77);
                },
                [](const sensor_msgs::RangeConstPtr&) {}});
  EXPECT_EQ(pairs, 2);
}

TEST_F(EurocFolderTest, LeavesOutAnImageWhosePartnerWasDropped) {
  fs::remove(folder.path("mav0/cam1/data/1403636579763555584.png"));
  EXPECT_EQ(readFolder(root(), {}).pairs.size(), 1u);
  fs::remove(folder.path("mav0/cam1/data/1403636579813555456.png"));
  EXPECT_THROW(readFolder(root(), {}), std::runtime_error);
}

TEST_F(EurocFolderTest, CannotBeTakenForRectified) {
  FolderReading reading;
  reading.images = ImageState::Rectified;
  EXPECT_THROW(readFolder(root(), reading), std::runtime_error);
}

TEST_F(EurocFolderTest, ACalibrationThatIsNamedComesBeforeTheFoldersOwn) {
  std::ofstream(folder.path("ost_left.yaml")) << test_support::rosYaml(rig.cameras.left);
  std::ofstream(folder.path("ost_right.yaml")) << test_support::rosYaml(rig.cameras.right);
  FolderReading reading;
  reading.calibration_files = {folder.path("ost_left.yaml"), folder.path("ost_right.yaml")};
  EXPECT_NEAR(readFolder(root(), reading).rig.calibration.fx_px, 50.0, 1e-9);  // as P has it
  reading.images = ImageState::Rectified;
  EXPECT_FALSE(readFolder(root(), reading).rectifier);
}

TEST_F(FolderTest, LeavesTheOldBagWhenItFails) {
  std::ofstream(folder.path("out.bag")) << "old";
  write("right/000001.png", "");
  EXPECT_NE(error(), "");
  EXPECT_EQ(fs::file_size(folder.path("out.bag")), 3u);
  EXPECT_FALSE(fs::exists(folder.path("out.bag.unfinished")));
}

TEST_F(FolderTest, RefusesAPoseWhoseQuaternionIsNone) {
  write("poses.csv", "stamp_s,tx,ty,tz,qx,qy,qz,qw\n1,1,2,3,0,0,0,0\n");
  EXPECT_EQ(error(), folder.path("poses.csv") + ":2: column 'qw': the quaternion's norm is not 1");
}

}  // namespace
}  // namespace flight_corridor::tools
