#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "serial/line_reader.hpp"
#include "serial/measurement.hpp"
#include "serial/protocol.hpp"
#include "serial/tfmini.hpp"

namespace flight_corridor::serial {

/// Limits of a valid reading. 0 <= min_range_m < max_range_m.
struct RangeLimits {
  double min_range_m, max_range_m;
  double strength_min;
};

/// The range of a measurement by REP-117: NaN if it is invalid or weaker than strength_min, -inf nearer than
/// min_range_m, +inf without a return and from max_range_m on (there sensors clip), else metres.
double limitedRange(const Measurement& measurement, const RangeLimits& limits);

struct WireReading {
  double range_m;   ///< limitedRange().
  double strength;  ///< NaN: not given.
  double stamp_s;   ///< Time at which the first byte of its frame began to arrive.
  double error_code = std::numeric_limits<double>::quiet_NaN();  ///< See Measurement.
  const char* error = "";
};

/// Since the parser was made.
struct WireCounts {
  std::uint64_t bytes = 0, readings = 0;
  std::uint64_t refused_bytes = 0;  ///< Without a reading: noise, halves, wrong checksums, text that is not a number.
  std::uint64_t checksum_errors = 0;
};

/// Turns the bytes of a LiDAR into readings. How they are cut into pieces changes only stamps.
class RangeParser {
 public:
  /// @param byte_s time of a byte on the wire: 10 bits (8N1) over the baud rate.
  /// @param unit_m of a tfmini's distances.
  RangeParser(Protocol protocol, const RangeLimits& limits, double byte_s, double unit_m);

  /// Adds the readings that these bytes complete. A byte's arrival: the number of later bytes times byte_s before the
  /// read, but no earlier than the previous read: then it was not there.
  /// @param read_s time of the read.
  void feed(const std::uint8_t* bytes, std::size_t size, double read_s, std::vector<WireReading>& readings);

  /// A new stream begins: held bytes are refused.
  void restart();

  const WireCounts& counts() const { return counts_; }
  /// Bytes that wait for the rest of their frame or line.
  std::size_t held() const;

 private:
  struct Framed {
    Measurement measurement;
    double stamp_s;
  };

  std::optional<Framed> add(std::uint8_t byte, double arrival_s);
  std::optional<Framed> addToLine(LineReader& reader, std::uint8_t byte, double arrival_s);
  std::optional<Framed> addToFrame(TfminiReader& reader, std::uint8_t byte, double arrival_s);
  void makeReader();

  Protocol protocol_;
  RangeLimits limits_;
  double byte_s_, unit_m_;
  double previous_read_s_;
  std::variant<LineReader, TfminiReader> reader_;
  WireCounts counts_;
};

}  // namespace flight_corridor::serial
