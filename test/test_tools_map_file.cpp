#include <gtest/gtest.h>

#include <CLI/Error.hpp>
#include <memory>
#include <stdexcept>

#include "support/temporary_folder.hpp"
#include "tools/map_file.hpp"

namespace flight_corridor::tools {
namespace {

class MapFileTest : public testing::Test {
 protected:
  MapFileTest() {
    tree.updateNode(octomap::point3d(1.0f, 0.0f, 0.0f), 2.0f);
    tree.updateNode(octomap::point3d(1.0f, 0.0f, 0.5f), -0.7f);
  }

  std::string complaintAbout(const std::string& path) const {
    try {
      writeMap(path, tree);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  test_support::TemporaryFolder folder;
  octomap::OcTree tree{0.1};
};

TEST_F(MapFileTest, KeepsTheLogOddsInOt) {
  writeMap(folder.path("map.ot"), tree);
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(folder.path("map.ot")));
  ASSERT_TRUE(read);
  EXPECT_TRUE(dynamic_cast<octomap::OcTree&>(*read) == tree);
}

TEST_F(MapFileTest, KeepsOccupiedFreeAndUnknownInBt) {
  writeMap(folder.path("map.bt"), tree);
  octomap::OcTree read(1.0);
  ASSERT_TRUE(read.readBinary(folder.path("map.bt")));
  EXPECT_EQ(read.getResolution(), 0.1);
  EXPECT_TRUE(read.isNodeOccupied(read.search(1.0, 0.0, 0.0)));
  EXPECT_FALSE(read.isNodeOccupied(read.search(1.0, 0.0, 0.5)));
  EXPECT_EQ(read.search(1.0, 0.0, 1.0), nullptr);
}

TEST_F(MapFileTest, AnEmptyMapIsAnEmptyFileThatCanBeRead) {
  const octomap::OcTree empty(0.05);
  writeMap(folder.path("map.ot"), empty);
  writeMap(folder.path("map.bt"), empty);
  const std::unique_ptr<octomap::AbstractOcTree> full(octomap::AbstractOcTree::read(folder.path("map.ot")));
  octomap::OcTree binary(1.0);
  ASSERT_TRUE(full);
  ASSERT_TRUE(binary.readBinary(folder.path("map.bt")));
  EXPECT_EQ(full->size(), 0u);
  EXPECT_EQ(binary.size(), 0u);
}

TEST_F(MapFileTest, AnotherExtensionIsAWrongCommandLine) {
  for (const char* name : {"map.pcd", "map", "map.ot.gz"}) {
    EXPECT_THROW(writeMap(folder.path(name), tree), CLI::ValidationError) << name;
  }
}

TEST_F(MapFileTest, NamesTheFileThatCannotBeWritten) {
  const std::string path = folder.path("missing/map.bt");
  EXPECT_EQ(complaintAbout(path), path + ": cannot be written");
}

}  // namespace
}  // namespace flight_corridor::tools
