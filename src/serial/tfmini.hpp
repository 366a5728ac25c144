#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "serial/measurement.hpp"

namespace flight_corridor::serial {

/// Finds the frames of a Benewake TFmini, TFmini-S, TFmini Plus, TF-Luna or TF03 in a stream of bytes:
///   0x59 0x59 distance (cm or mm, low byte first) strength temperature checksum (low byte of the sum of the eight
///   before)
/// A frame counts when it follows another without a gap: a false header in a stream entered halfway passes the checksum
/// once in 256 times, but hardly twice. Source: TFmini Plus manual SJ-PM-TFmini Plus-T-01, 5.3, table 7; TF-Luna manual
/// SJ-PM-TF-Luna, 5.4.
class TfminiReader {
 public:
  static constexpr std::size_t kFrameBytes = 9;
  using Frame = std::array<std::uint8_t, kFrameBytes>;

  struct Reading {
    Measurement measurement;
    double stamp_s;  ///< Time of arrival of the frame's first byte.
  };

  /// @param unit_m of the distances: 0.01, or 0.001 if the sensor is set to millimetres.
  explicit TfminiReader(double unit_m) : unit_m_(unit_m) {}

  /// @return the reading that this byte completes, if any.
  std::optional<Reading> add(std::uint8_t byte, double arrival_s);

  /// Bytes without a reading.
  std::uint64_t refused() const { return refused_; }
  std::uint64_t checksumErrors() const { return checksum_errors_; }
  /// Bytes of the incomplete frame.
  std::size_t held() const { return size_; }

 private:
  bool startsLikeAFrame() const;
  void dropFirst(std::size_t count);

  double unit_m_;
  Frame bytes_{};
  std::array<double, kFrameBytes> arrivals_s_{};
  std::size_t size_ = 0;
  bool in_step_ = false;  // the bytes begin where a frame ended
  std::uint64_t refused_ = 0, checksum_errors_ = 0;
};

/// The content of a frame; its header and checksum are not checked. Not valid: the distances that stand for errors, -1,
/// -2 and -4, and a strength of 65535, which is overexposure (TFmini-S manual SJ-PM-TFmini-S, table 8; TF-Luna, 5.4).
Measurement parseTfmini(const TfminiReader::Frame& frame, double unit_m);

}  // namespace flight_corridor::serial
