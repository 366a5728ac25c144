#pragma once

#include <ros/time.h>

#include <string>
#include <vector>

#include "flight_corridor/pipeline.hpp"

namespace flight_corridor::tools {

/// Seconds with all nine decimals, e.g. "1403715273.262142976": a double cannot hold them.
std::string formatStamp(const ros::Time& stamp);
/// @throws std::invalid_argument unless the text is a stamp that ros::Time holds; names the unit when it is another.
ros::Time parseStamp(const std::string& text);

/// A text table with a header line: the cells by column name, and errors with their place. Lines that begin with '#'
/// are comments.
class CsvTable {
 public:
  /// @throws std::runtime_error naming the file when it cannot be read, is empty, or a line has another number of
  /// cells.
  explicit CsvTable(const std::string& path);

  std::size_t size() const { return rows_.size(); }
  bool has(const std::string& column) const;
  /// @throws std::runtime_error naming file and column if there is no such column, with the actual header.
  const std::string& text(std::size_t row, const std::string& column) const;
  /// A number, inf or nan.  @throws std::runtime_error naming file, line, column and value if it is not a number.
  double number(std::size_t row, const std::string& column) const;
  /// The whole column.  @throws std::runtime_error naming file, line and value if one is not a stamp, or not later than
  /// the one before.
  std::vector<ros::Time> stamps(const std::string& column) const;
  /// Text for errors: that there is no such column, with the actual header.
  std::string missing(const std::string& column) const;
  [[noreturn]] void fail(std::size_t row, const std::string& column, const std::string& what) const;

 private:
  std::size_t index(const std::string& column) const;
  ros::Time stamp(std::size_t row, const std::string& column) const;

  std::string path_;
  std::vector<std::string> header_;
  std::string header_origin_;  // for errors
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> lines_;  // line in the file of each row
};

/// One line of R.csv: the pipeline's answer for one stereo pair.
struct ResultRow {
  ros::Time stamp;
  State state = State::Unknown;
  double clear_distance_m = kNaN;  ///< +inf when nothing is in the box.
  double range_fused_m = kNaN, range_fused_sigma_m = kNaN, range_lidar_m = kNaN, range_stereo_m = kNaN;
  double scale = kNaN, unknown_fraction = kNaN;
  StageTimes times;
  std::string reasons;  ///< describeReasons(); "" without any, or in older tables.
};
ResultRow resultRow(const ros::Time& stamp, const Report& report);

/// One line of T.csv: distance along the corridor to the first true surface in the box, +inf when none [m].
struct TruthRow {
  ros::Time stamp;
  double clear_exact_m = kNaN;     ///< In the box itself.
  double clear_shrunk_m = kNaN;    ///< In the box 0.10 m smaller on every side.
  double clear_inflated_m = kNaN;  ///< In the box 0.10 m larger on every side.
};

/// @throws std::runtime_error naming the file when it cannot be written.
void writeResults(const std::string& path, const std::vector<ResultRow>& rows);
void writeTruth(const std::string& path, const std::vector<TruthRow>& rows);

/// @throws std::runtime_error naming file, line and column of the fault.
std::vector<ResultRow> readResults(const std::string& path);
std::vector<TruthRow> readTruth(const std::string& path);

}  // namespace flight_corridor::tools
