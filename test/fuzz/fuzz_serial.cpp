// Bytes of a serial line, for each protocol: readings keep the limits, counts add up, memory is bounded, and how the
// stream is cut into pieces changes no reading and no count.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "scratch.hpp"
#include "serial/range_parser.hpp"

namespace flight_corridor::serial {
namespace {

constexpr double kByte_s = 10.0 / 115200;
constexpr double kStart_s = 1000.0;

RangeLimits limitsOf(Protocol protocol) {
  const SensorDefaults defaults = defaultsOf(protocol);
  return {defaults.min_range_m, defaults.max_range_m, defaults.strength_min};
}

void require(bool holds, const char* law) {
  if (!holds) fuzz::fail(law);
}

/// Equal, or both NaN.
bool isSame(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void checkReading(const WireReading& reading, const RangeLimits& limits, double newest_s) {
  const bool is_within = limits.min_range_m <= reading.range_m && reading.range_m < limits.max_range_m;
  require(!std::isfinite(reading.range_m) || is_within, "a range keeps the limits");
  require(std::isnan(reading.strength) || reading.strength >= limits.strength_min || !is_within,
          "a weak return has no range");
  require(reading.stamp_s <= newest_s, "no stamp is of the future");
}

void checkCounts(const RangeParser& parser, std::size_t size, std::size_t readings) {
  const WireCounts& counts = parser.counts();
  require(counts.bytes == size && counts.readings == readings, "all are counted");
  require(counts.refused_bytes + parser.held() <= counts.bytes, "a byte is refused once");
  require(parser.held() <= LineReader::kLongest, "memory is bounded");
}

void check(Protocol protocol, std::uint8_t piece, const std::uint8_t* data, std::size_t size) {
  const RangeLimits limits = limitsOf(protocol);
  const double unit_m = 0.001;
  RangeParser whole(protocol, limits, kByte_s, unit_m), pieces(protocol, limits, kByte_s, unit_m);
  std::vector<WireReading> readings, pieces_readings;
  whole.feed(data, size, kStart_s, readings);
  double now_s = kStart_s;
  for (std::size_t at = 0, length = 0; at < size; at += length) {
    length = std::min<std::size_t>(1 + (piece + at * 7) % (1 + piece), size - at);
    pieces.feed(data + at, length, now_s += 0.001, pieces_readings);
    checkCounts(pieces, at + length, pieces_readings.size());
  }
  checkCounts(whole, size, readings.size());
  require(readings.size() == pieces_readings.size(), "pieces give as many readings");
  require(whole.counts().refused_bytes == pieces.counts().refused_bytes &&
              whole.counts().checksum_errors == pieces.counts().checksum_errors,
          "pieces give the same counts");
  for (std::size_t i = 0; i < readings.size(); ++i) {
    checkReading(readings[i], limits, kStart_s);
    checkReading(pieces_readings[i], limits, now_s);
    require(isSame(readings[i].range_m, pieces_readings[i].range_m) &&
                isSame(readings[i].strength, pieces_readings[i].strength),
            "pieces give the same readings");
  }
}

}  // namespace
}  // namespace flight_corridor::serial

/// One byte that chooses the protocol, one how the stream is cut, then the stream.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace flight_corridor::serial;
  if (size < 2) return 0;
  check(kProtocols[data[0] % kProtocols.size()], data[1], data + 2, size - 2);
  return 0;
}
