#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "support/temporary_folder.hpp"
#include "tools/csv.hpp"

namespace flight_corridor::tools {
namespace {

class CsvTest : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string path = folder.path("table.csv");
    std::ofstream(path) << text;
    return path;
  }

  template <typename Read>
  std::string error(const Read& read) {
    try {
      read();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  test_support::TemporaryFolder folder;
};

std::string readText(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Stamp, KeepsAllNineDecimalsAtPresentDayEpochs) {
  const ros::Time stamp(1603715273, 262142977);
  EXPECT_EQ(formatStamp(stamp), "1603715273.262142977");
  EXPECT_EQ(parseStamp(formatStamp(stamp)), stamp);
}

TEST(Stamp, ReadsFewerDecimals) {
  EXPECT_EQ(parseStamp("0"), ros::Time(0, 0));
  EXPECT_EQ(parseStamp("0.1044989"), ros::Time(0, 104498900));
  EXPECT_EQ(parseStamp("12.5"), ros::Time(12, 500000000));
}

TEST(Stamp, RefusesWhatRosTimeCannotHold) {
  for (const char* text : {"", ".", "-1", "1e3", "1.", "1.0000000001", "4294967296.0", "nan", "1.5s"}) {
    EXPECT_THROW(parseStamp(text), std::invalid_argument) << text;
  }
}

TEST(Stamp, NamesTheUnitOfPresentDayStampsThatAreNotInSeconds) {
  for (const auto& [text, unit] :
       {std::pair("1403636579763", "milliseconds"), std::pair("1403636579763.5", "milliseconds"),
        std::pair("1403636579763555", "microseconds"), std::pair("1403636579763555584", "nanoseconds")}) {
    try {
      parseStamp(text);
      FAIL() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), "'" + std::string(text) + "' is in " + unit + "; wanted are seconds, sec.nanosec");
    }
  }
}

TEST_F(CsvTest, ResultsHaveTheAgreedHeader) {
  writeResults(folder.path("r.csv"), {});
  EXPECT_EQ(readText(folder.path("r.csv")),
            "stamp,state,clear_distance_m,range_fused_m,range_fused_sigma_m,range_lidar_m,range_stereo_m,scale,"
            "unknown_fraction,stereo_ms,fusion_ms,cloud_ms,map_ms,corridor_ms,total_ms,reasons\n");
}

TEST_F(CsvTest, ResultsComeBackAsWritten) {
  ResultRow row;
  row.stamp = ros::Time(1603715273, 1);
  row.state = State::Blocked;
  row.clear_distance_m = kInfinity;
  row.range_fused_m = 3.125;
  row.range_fused_sigma_m = -kNaN;
  row.scale = 1.0625;
  row.unknown_fraction = 0.25;
  row.times.total_ms = 41.5;
  row.reasons = "OCCUPIED_CELL|SHORT_RANGE";
  writeResults(folder.path("r.csv"), {row});
  const std::vector<ResultRow> rows = readResults(folder.path("r.csv"));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].stamp, row.stamp);
  EXPECT_EQ(rows[0].state, State::Blocked);
  EXPECT_EQ(rows[0].clear_distance_m, kInfinity);
  EXPECT_EQ(rows[0].range_fused_m, 3.125);
  EXPECT_TRUE(std::isnan(rows[0].range_fused_sigma_m));
  EXPECT_EQ(rows[0].scale, 1.0625);
  EXPECT_EQ(rows[0].unknown_fraction, 0.25);
  EXPECT_EQ(rows[0].times.total_ms, 41.5);
  EXPECT_EQ(rows[0].reasons, row.reasons);
}

TEST_F(CsvTest, ResultsOfBeforeTheReasonsAreReadToo) {
  writeResults(folder.path("r.csv"), {ResultRow()});
  std::string text = readText(folder.path("r.csv"));
  for (const char* last : {",reasons\n", ",\n"}) text.replace(text.find(last), std::string(last).size(), "\n");
  const std::vector<ResultRow> rows = readResults(write(text));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].reasons, "");
}

TEST_F(CsvTest, TruthComesBackAsWritten) {
  writeTruth(folder.path("t.csv"), {{ros::Time(7, 5), 2.5, kInfinity, 2.25}});
  EXPECT_EQ(readText(folder.path("t.csv")),
            "stamp,clear_exact,clear_shrunk,clear_inflated\n7.000000005,2.500000,inf,2.250000\n");
  const std::vector<TruthRow> rows = readTruth(folder.path("t.csv"));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].stamp, ros::Time(7, 5));
  EXPECT_EQ(rows[0].clear_exact_m, 2.5);
  EXPECT_EQ(rows[0].clear_shrunk_m, kInfinity);
  EXPECT_EQ(rows[0].clear_inflated_m, 2.25);
}

TEST_F(CsvTest, CommentsAreSkippedAndLinesStillCounted) {
  const std::string path = write("# why\nstamp,clear_exact,clear_shrunk,clear_inflated\n1,inf,inf,inf\n2,x,inf,inf\n");
  EXPECT_EQ(error([&] { readTruth(path); }), path + ":4: column 'clear_exact': 'x' is not a number");
}

TEST_F(CsvTest, NamesAMissingFile) {
  EXPECT_EQ(error([] { CsvTable("/no/t.csv"); }), "/no/t.csv: cannot be read");
}

TEST_F(CsvTest, NamesAnEmptyFile) {
  const std::string path = write("");
  EXPECT_EQ(error([&] { CsvTable{path}; }), path + ": no header line");
}

TEST_F(CsvTest, NamesAMissingColumn) {
  const std::string path = write("stamp,clear_exact\n1,inf\n");
  EXPECT_EQ(error([&] { readTruth(path); }),
            path + ": no column 'clear_shrunk'; line 1, the header, is 'stamp,clear_exact'");
}

TEST_F(CsvTest, NamesTheCommentThatMayHaveBeenMeantAsTheHeader) {
  const std::string path = write("# EuRoC\r\n#timestamp [ns],filename\r\n7,7.png\r\n");
  EXPECT_EQ(error([&] { CsvTable(path).stamps("stamp_s"); }),
            path +
                ": no column 'stamp_s'; line 3, the header, is '7,7.png'; '#timestamp [ns],filename' above it is a "
                "comment, as it begins with #. Wanted is a header with it, and stamps in seconds");
}

TEST_F(CsvTest, ReadsWhatSpreadsheetsWriteUnderWindows) {
  const CsvTable table(write("\xEF\xBB\xBFstamp_s,range_m\r\n1.5,2.25\r\n\r\n"));
  EXPECT_EQ(table.stamps("stamp_s"), std::vector<ros::Time>{ros::Time(1.5)});
  EXPECT_EQ(table.number(0, "range_m"), 2.25);
}

TEST_F(CsvTest, NamesALineWithTooFewCells) {
  const std::string path = write("a,b\n1,2\n3\n");
  EXPECT_EQ(error([&] { CsvTable{path}; }), path + ":3: 1 cells, the header has 2");
}

TEST_F(CsvTest, NamesAStampAndAStateThatAreNone) {
  const std::string truth = write("stamp,clear_exact,clear_shrunk,clear_inflated\nsoon,inf,inf,inf\n");
  EXPECT_EQ(error([&] { readTruth(truth); }),
            truth + ":2: column 'stamp': 'soon' is not a stamp of the form sec.nanosec");
  const std::string result = write("stamp,state\n1,Free\n");
  EXPECT_EQ(error([&] { readResults(result); }), result + ":2: column 'state': must be FREE, BLOCKED or UNKNOWN");
}

TEST_F(CsvTest, NamesAStampThatIsThereTwiceOrRunsBack) {
  const std::string twice = write("stamp,clear_exact,clear_shrunk,clear_inflated\n1.5,inf,inf,inf\n1.5,inf,inf,inf\n");
  EXPECT_EQ(error([&] { readTruth(twice); }),
            twice + ":3: column 'stamp': 1.500000000 is not later than the one before, 1.500000000");
  const std::string back = write("stamp,state\n2,FREE\n1,FREE\n");
  EXPECT_EQ(error([&] { readResults(back); }),
            back + ":3: column 'stamp': 1.000000000 is not later than the one before, 2.000000000");
}

TEST_F(CsvTest, NamesAStampThatIsALifetimeAfterTheFirst) {
  const std::string path = write("stamp,state\n10.5,FREE\n2979446295.6,FREE\n");
  EXPECT_EQ(error([&] { readResults(path); }),
            path + ":3: column 'stamp': 2979446295.600000000 is more than 68 years " + "after the first, 10.500000000");
}

TEST_F(CsvTest, RefusesTruthThatIsNoDistance) {
  const std::string path = write("stamp,clear_exact,clear_shrunk,clear_inflated\n1,nan,inf,inf\n");
  EXPECT_EQ(error([&] { readTruth(path); }), path + ":2: column 'clear_exact': truth must be a distance >= 0 or inf");
}

TEST_F(CsvTest, NamesAFileThatCannotBeWritten) {
  EXPECT_EQ(error([] { writeTruth("/no/t.csv", {}); }), "/no/t.csv: cannot be written");
}

}  // namespace
}  // namespace flight_corridor::tools
