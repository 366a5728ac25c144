#include "serial/range_parser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "serial/lidar_lite.hpp"
#include "serial/lightware.hpp"

namespace flight_corridor::serial {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double limitedRange(const Measurement& measurement, const RangeLimits& limits) {
  const double range_m = measurement.range_m;
  const bool is_weak = !std::isnan(measurement.strength) && !(measurement.strength >= limits.strength_min);
  if (range_m == kInfinity) return kInfinity;
  if (is_weak || !(range_m >= 0.0)) return kNaN;
  if (range_m < limits.min_range_m) return -kInfinity;
  return range_m < limits.max_range_m ? range_m : kInfinity;
}

RangeParser::RangeParser(Protocol protocol, const RangeLimits& limits, double byte_s, double unit_m)
    : protocol_(protocol), limits_(limits), byte_s_(byte_s), unit_m_(unit_m), previous_read_s_(-kInfinity) {
  makeReader();
}

void RangeParser::makeReader() {
  if (protocol_ == Protocol::Tfmini) {
    reader_ = TfminiReader(unit_m_);
  } else {
    reader_ = LineReader();
  }
}

void RangeParser::feed(const std::uint8_t* bytes, std::size_t size, double read_s, std::vector<WireReading>& readings) {
  for (std::size_t i = 0; i < size; ++i) {
    const double on_time_s = read_s - static_cast<double>(size - i) * byte_s_;
    const double arrival_s = std::min(read_s, std::max(previous_read_s_, on_time_s));  // a clock may be set back
    ++counts_.bytes;
    if (const auto framed = add(bytes[i], arrival_s)) {
      ++counts_.readings;
      const Measurement& measurement = framed->measurement;
      readings.push_back({limitedRange(measurement, limits_), measurement.strength, framed->stamp_s,
                          measurement.error_code, measurement.error});
    }
  }
  if (size > 0) previous_read_s_ = read_s;
}

void RangeParser::restart() {
  counts_.refused_bytes += held();
  makeReader();
}

std::size_t RangeParser::held() const {
  return std::visit([](const auto& reader) { return reader.held(); }, reader_);
}

std::optional<RangeParser::Framed> RangeParser::add(std::uint8_t byte, double arrival_s) {
  if (auto* frames = std::get_if<TfminiReader>(&reader_)) return addToFrame(*frames, byte, arrival_s);
  return addToLine(std::get<LineReader>(reader_), byte, arrival_s);
}

std::optional<RangeParser::Framed> RangeParser::addToLine(LineReader& reader, std::uint8_t byte, double arrival_s) {
  const std::uint64_t skipped = reader.skipped();
  const std::optional<LineReader::Line> line = reader.add(byte, arrival_s);
  counts_.refused_bytes += reader.skipped() - skipped;
  if (!line) return std::nullopt;
  const Parsed parsed = protocol_ == Protocol::Lightware ? parseLightware(line->text) : parseLidarLite(line->text);
  if (parsed.outcome == Parsed::Outcome::Valid) return Framed{parsed.measurement, line->stamp_s};
  counts_.refused_bytes += line->bytes;
  counts_.checksum_errors += parsed.outcome == Parsed::Outcome::WrongChecksum;
  return std::nullopt;
}

std::optional<RangeParser::Framed> RangeParser::addToFrame(TfminiReader& reader, std::uint8_t byte, double arrival_s) {
  const std::uint64_t refused = reader.refused(), errors = reader.checksumErrors();
  const std::optional<TfminiReader::Reading> reading = reader.add(byte, arrival_s);
  counts_.refused_bytes += reader.refused() - refused;
  counts_.checksum_errors += reader.checksumErrors() - errors;
  if (!reading) return std::nullopt;
  return Framed{reading->measurement, reading->stamp_s};
}

}  // namespace flight_corridor::serial
