#include <gtest/gtest.h>
#include <std_msgs/Bool.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "support/temporary_folder.hpp"
#include "tools/new_bag.hpp"

namespace flight_corridor::tools {
namespace {

namespace fs = std::filesystem;

class NewBagTest : public testing::Test {
 protected:
  std::string path() const { return folder.path("new.bag"); }

  test_support::TemporaryFolder folder;
};

TEST_F(NewBagTest, IsThereOnceFinished) {
  NewBag bag(path());
  bag.write("/free", ros::Time(1, 0), std_msgs::Bool());
  EXPECT_FALSE(fs::exists(path()));
  bag.finish();
  EXPECT_FALSE(fs::exists(path() + ".unfinished"));
  EXPECT_GT(rosbag::Bag(path(), rosbag::bagmode::Read).getSize(), 0u);
}

TEST_F(NewBagTest, LeavesWhatWasThereWhenItIsNotFinished) {
  std::ofstream(path()) << "old";
  {
    NewBag bag(path());
    bag.write("/free", ros::Time(1, 0), std_msgs::Bool());
  }
  EXPECT_EQ(fs::file_size(path()), 3u);
  EXPECT_FALSE(fs::exists(path() + ".unfinished"));
}

TEST_F(NewBagTest, LeavesARecordersUnfinishedBagAlone) {
  std::ofstream(path() + ".active") << "flight";
  NewBag(path()).finish();
  EXPECT_EQ(fs::file_size(path() + ".active"), 6u);
}

TEST_F(NewBagTest, ReplacesNoFolder) { EXPECT_THROW(NewBag(folder.path("")), std::runtime_error); }

TEST_F(NewBagTest, NamesItsFileWhenAMessageIsRefused) {
  NewBag bag(path());
  try {
    bag.write("/free", ros::Time(0, 0), std_msgs::Bool());  // rosbag keeps no stamp 0
    FAIL() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find(path() + ": cannot be written: "), 0u) << error.what();
  }
}

}  // namespace
}  // namespace flight_corridor::tools
