#include <gtest/gtest.h>
#include <std_msgs/Float64.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/small_flight.hpp"
#include "tools/bag_file.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

class BagFileTest : public test_support::SmallFlightTest {
 protected:
  std::string openError() const {
    rosbag::Bag bag;
    try {
      openBag(path(), bag);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(BagFileTest, NamesAMissingBag) {
  EXPECT_EQ(openError(), path() + ": cannot be read: No such file or directory");
}

TEST_F(BagFileTest, NamesAFileThatIsNoBag) {
  for (const char* text : {"", "#ROS", "stamp,state\n"}) {
    std::ofstream(path()) << text;
    EXPECT_EQ(openError(), path() + ": cannot be read: is not a bag");
  }
}

TEST_F(BagFileTest, NamesABagThatWasCutOffAndItsRemedy) {
  writeFlight();
  for (const std::uintmax_t size : {20u, 5000u}) {
    fs::resize_file(path(), size);
    const std::string error = openError();
    EXPECT_EQ(error.find(path() + ": cannot be read: "), 0u) << error;
    EXPECT_NE(error.find("rosbag reindex " + path()), std::string::npos) << error;
  }
}

/// Writes a number over four bytes of a file, `skip` bytes from where a text begins first.
void overwrite(const std::string& path, const std::string& text, std::ptrdiff_t skip, std::uint32_t number) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::ptrdiff_t>(content.str().find(text)) + skip);
  file.write(reinterpret_cast<const char*>(&number), sizeof(number));
}

TEST_F(BagFileTest, NamesABagWhoseLengthsLie) {
  const std::string message("op=\2", 4), index("op=\4", 4);  // behind the header's length, and "conn=...." with its own
  for (const std::ptrdiff_t skip : {-21, -17}) {
    writeFlight();
    overwrite(path(), message, skip, 100000);
    EXPECT_NE(openError().find("a record"), std::string::npos) << openError();
  }
  writeFlight();
  overwrite(path(), "message_definition=", -4, 100000);  // a field of a connection
  EXPECT_NE(openError().find("a record's header is cut off at byte"), std::string::npos) << openError();
  writeFlight();
  overwrite(path(), index, 28, 7);  // behind "ver=....", the length of the data, and the time
  EXPECT_NE(openError().find("the index leads to no message at byte"), std::string::npos) << openError();
}

TEST_F(BagFileTest, NamesAChunkWhoseIndexLeadsToNoMessageThoughTheOneBeforeHasOne) {
  rosbag::Bag bag(path(), rosbag::bagmode::Write);
  bag.setChunkThreshold(1);  // each message has its own
  for (const std::uint32_t second : {1u, 0x74686973u}) bag.write("/number", ros::Time(second, 0), std_msgs::Float64());
  bag.close();
  EXPECT_EQ(openError(), "");
  const std::string second_message("op=\2\x0d\0\0\0time=siht", 17);  // behind the second chunk's header
  overwrite(path(), second_message, 0, 0x073d706f);                  // "op=\7": a connection
  EXPECT_NE(openError().find("the index leads to no message at byte"), std::string::npos) << openError();
}

TEST_F(BagFileTest, TellsTheTypeOfEachTopic) {
  writeFlight();
  rosbag::Bag bag;
  openBag(path(), bag);
  const auto types = typesByTopic(bag);
  EXPECT_EQ(types.size(), 8u);
  EXPECT_EQ(types.at("/range"), "sensor_msgs/Range");
  EXPECT_EQ(types.at("/tf_static"), "tf2_msgs/TFMessage");
}

TEST_F(BagFileTest, SaysThatABagHoldsNothing) {
  rosbag::Bag(path(), rosbag::bagmode::Write).close();
  rosbag::Bag bag;
  openBag(path(), bag);
  try {
    failMissing(bag, "no topic /range");
    FAIL() << "returned";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path() + ": no topic /range; it has no messages");
  }
}

}  // namespace
}  // namespace flight_corridor::tools
