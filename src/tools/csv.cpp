#include "tools/csv.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace flight_corridor::tools {
namespace {

constexpr unsigned long long kLatest_s = 3999999999;  // 2096: near the end of ros::Time its arithmetic throws
constexpr std::uint32_t kLongest_s = 0x7fffffff;      // between two stamps: ros::Duration holds no more

struct NumberColumn {
  const char* name;
  int decimals;
  double& (*cell)(ResultRow& row);
};

const std::array<NumberColumn, 13> kResultColumns{{
    {"clear_distance_m", 6, [](ResultRow& row) -> double& { return row.clear_distance_m; }},
    {"range_fused_m", 6, [](ResultRow& row) -> double& { return row.range_fused_m; }},
    {"range_fused_sigma_m", 6, [](ResultRow& row) -> double& { return row.range_fused_sigma_m; }},
    {"range_lidar_m", 6, [](ResultRow& row) -> double& { return row.range_lidar_m; }},
    {"range_stereo_m", 6, [](ResultRow& row) -> double& { return row.range_stereo_m; }},
    {"scale", 6, [](ResultRow& row) -> double& { return row.scale; }},
    {"unknown_fraction", 6, [](ResultRow& row) -> double& { return row.unknown_fraction; }},
    {"stereo_ms", 3, [](ResultRow& row) -> double& { return row.times.stereo_ms; }},
    {"fusion_ms", 3, [](ResultRow& row) -> double& { return row.times.fusion_ms; }},
    {"cloud_ms", 3, [](ResultRow& row) -> double& { return row.times.cloud_ms; }},
    {"map_ms", 3, [](ResultRow& row) -> double& { return row.times.map_ms; }},
    {"corridor_ms", 3, [](ResultRow& row) -> double& { return row.times.corridor_ms; }},
    {"total_ms", 3, [](ResultRow& row) -> double& { return row.times.total_ms; }},
}};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

/// Byte order mark that some spreadsheets write.
std::string withoutByteOrderMark(const std::string& line) {
  const std::string mark = "\xEF\xBB\xBF";
  return line.compare(0, mark.size(), mark) == 0 ? line.substr(mark.size()) : line;
}

/// Line ending of Windows.
std::string withoutReturn(const std::string& line) { return line.substr(0, line.find('\r')); }

std::string formatNumber(double value, int decimals) {
  if (std::isnan(value)) return "nan";  // printf may write "-nan"
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::ofstream openForWriting(const std::string& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be written");
  return file;
}

void closeWritten(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) throw std::runtime_error(path + ": writing failed (disk full?)");
}

State parseState(const CsvTable& table, std::size_t row) {
  for (const State state : {State::Unknown, State::Free, State::Blocked}) {
    if (table.text(row, "state") == toString(state)) return state;
  }
  table.fail(row, "state", "must be FREE, BLOCKED or UNKNOWN");
}

double knownDistance(const CsvTable& table, std::size_t row, const char* column) {
  const double distance_m = table.number(row, column);
  if (!(distance_m >= 0.0)) table.fail(row, column, "truth must be a distance >= 0 or inf");
  return distance_m;
}

bool isDigits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

bool isLetter(unsigned char c) { return std::isalpha(c) != 0; }

std::string withoutSpaces(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// The unit of a present-day stamp that is not in seconds, by its digits before the point; "" where it may be.
std::string unitOf(const std::string& stamp) {
  const std::string whole = stamp.substr(0, stamp.find('.'));
  if (!isDigits(whole) || whole.size() < 12) return "";
  if (whole.size() < 15) return "milliseconds";
  return whole.size() < 18 ? "microseconds" : "nanoseconds";
}

}  // namespace

std::string formatStamp(const ros::Time& stamp) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%u.%09u", stamp.sec, stamp.nsec);
  return text.data();
}

ros::Time parseStamp(const std::string& text) {
  const std::string unit = unitOf(text);
  if (!unit.empty()) throw std::invalid_argument("'" + text + "' is in " + unit + "; wanted are seconds, sec.nanosec");
  const std::size_t point = text.find('.');
  const std::string seconds = text.substr(0, point);
  std::string decimals = point == std::string::npos ? "0" : text.substr(point + 1);
  if (!isDigits(seconds) || !isDigits(decimals) || seconds.size() > 10 || decimals.size() > 9) {
    throw std::invalid_argument("'" + text + "' is not a stamp of the form sec.nanosec");
  }
  decimals.resize(9, '0');
  const unsigned long long sec = std::stoull(seconds);
  if (sec > kLatest_s) {
    throw std::invalid_argument("'" + text + "' is not a stamp; wanted are seconds up to " + std::to_string(kLatest_s));
  }
  return {static_cast<std::uint32_t>(sec), static_cast<std::uint32_t>(std::stoul(decimals))};
}

CsvTable::CsvTable(const std::string& path) : path_(path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::string line;
  std::string comment;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (number == 1) line = withoutByteOrderMark(line);
    if (line.empty() || line == "\r") continue;
    if (line.front() == '#') {
      comment = line;
      continue;
    }
    std::vector<std::string> cells = split(line);
    if (header_.empty()) {
      header_ = std::move(cells);
      header_origin_ = "line " + std::to_string(number) + ", the header, is '" + withoutReturn(line) + "'";
      if (!comment.empty())
        header_origin_ += "; '" + withoutReturn(comment) + "' above it is a comment, as it begins with #";
    } else if (cells.size() == header_.size()) {
      rows_.push_back(std::move(cells));
      lines_.push_back(number);
    } else {
      throw std::runtime_error(path + ":" + std::to_string(number) + ": " + std::to_string(cells.size()) +
                               " cells, the header has " + std::to_string(header_.size()));
    }
  }
  if (header_.empty()) throw std::runtime_error(path + ": no header line");
}

bool CsvTable::has(const std::string& column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::string CsvTable::missing(const std::string& column) const {
  return path_ + ": no column '" + column + "'; " + header_origin_;
}

std::size_t CsvTable::index(const std::string& column) const {
  if (!has(column)) throw std::runtime_error(missing(column));
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), column) - header_.begin());
}

const std::string& CsvTable::text(std::size_t row, const std::string& column) const {
  return rows_.at(row)[index(column)];
}

double CsvTable::number(std::size_t row, const std::string& column) const {
  const std::string& cell = text(row, column);
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (!cell.empty() && *end == '\0') return value;
  const std::string unit = withoutSpaces(end);
  const bool is_unit = end != cell.c_str() && !unit.empty() && std::all_of(unit.begin(), unit.end(), isLetter);
  fail(row, column,
       "'" + cell + "' is not a number" + (is_unit ? ": leave '" + unit + "' out, in the column's unit" : ""));
}

ros::Time CsvTable::stamp(std::size_t row, const std::string& column) const {
  try {
    return parseStamp(text(row, column));
  } catch (const std::invalid_argument& error) {
    fail(row, column, error.what());
  }
}

std::vector<ros::Time> CsvTable::stamps(const std::string& column) const {
  if (!has(column)) throw std::runtime_error(missing(column) + ". Wanted is a header with it, and stamps in seconds");
  std::vector<ros::Time> stamps;
  for (std::size_t i = 0; i < size(); ++i) {
    const ros::Time now = stamp(i, column);
    if (!stamps.empty() && now <= stamps.back()) {
      fail(i, column, formatStamp(now) + " is not later than the one before, " + formatStamp(stamps.back()));
    }
    if (!stamps.empty() && now.sec - stamps.front().sec >= kLongest_s) {
      fail(i, column, formatStamp(now) + " is more than 68 years after the first, " + formatStamp(stamps.front()));
    }
    stamps.push_back(now);
  }
  return stamps;
}

void CsvTable::fail(std::size_t row, const std::string& column, const std::string& what) const {
  throw std::runtime_error(path_ + ":" + std::to_string(lines_.at(row)) + ": column '" + column + "': " + what);
}

ResultRow resultRow(const ros::Time& stamp, const Report& report) {
  ResultRow row;
  row.stamp = stamp;
  row.state = report.verdict.state;
  row.clear_distance_m = report.verdict.clear_distance_m;
  row.range_fused_m = report.range.range_m;
  row.range_fused_sigma_m = report.range.sigma_m;
  row.range_lidar_m = report.range_lidar_m;
  row.range_stereo_m = report.range_stereo_m;
  row.scale = report.scale;
  row.unknown_fraction = report.verdict.unknown_fraction;
  row.times = report.times;
  row.reasons = describeReasons(report.verdict.reasons);
  return row;
}

void writeResults(const std::string& path, const std::vector<ResultRow>& rows) {
  std::ofstream file = openForWriting(path);
  file << "stamp,state";
  for (const NumberColumn& column : kResultColumns) file << ',' << column.name;
  file << ",reasons\n";
  for (ResultRow row : rows) {
    file << formatStamp(row.stamp) << ',' << toString(row.state);
    for (const NumberColumn& column : kResultColumns) file << ',' << formatNumber(column.cell(row), column.decimals);
    file << ',' << row.reasons << '\n';
  }
  closeWritten(file, path);
}

void writeTruth(const std::string& path, const std::vector<TruthRow>& rows) {
  std::ofstream file = openForWriting(path);
  file << "stamp,clear_exact,clear_shrunk,clear_inflated\n";
  for (const TruthRow& row : rows) {
    file << formatStamp(row.stamp);
    for (const double clear_m : {row.clear_exact_m, row.clear_shrunk_m, row.clear_inflated_m}) {
      file << ',' << formatNumber(clear_m, 6);
    }
    file << '\n';
  }
  closeWritten(file, path);
}

std::vector<ResultRow> readResults(const std::string& path) {
  const CsvTable table(path);
  const std::vector<ros::Time> stamps = table.stamps("stamp");
  std::vector<ResultRow> rows(stamps.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].stamp = stamps[i];
    rows[i].state = parseState(table, i);
    for (const NumberColumn& column : kResultColumns) column.cell(rows[i]) = table.number(i, column.name);
    if (table.has("reasons")) rows[i].reasons = table.text(i, "reasons");
  }
  return rows;
}

std::vector<TruthRow> readTruth(const std::string& path) {
  const CsvTable table(path);
  const std::vector<ros::Time> stamps = table.stamps("stamp");
  std::vector<TruthRow> rows(stamps.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].stamp = stamps[i];
    rows[i].clear_exact_m = knownDistance(table, i, "clear_exact");
    rows[i].clear_shrunk_m = knownDistance(table, i, "clear_shrunk");
    rows[i].clear_inflated_m = knownDistance(table, i, "clear_inflated");
  }
  return rows;
}

}  // namespace flight_corridor::tools
