#include "serial/tfmini.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace flight_corridor::serial {

namespace {

constexpr std::uint8_t kHeader = 0x59;
constexpr double kCodes = 0x10000;         // from a word to its code
constexpr unsigned kOverexposed = 0xffff;  // in place of a strength

/// In place of a distance.
struct Error {
  double code;
  const char* meaning;
};
constexpr Error kErrors[] = {
    {-1.0, "the return is too weak. Perhaps nothing returns, as from the open sky, or the lens is dirty"},
    {-2.0, "the return is saturated. There is something bright before it"},
    {-4.0, "there is too much ambient light. Perhaps the sun shines into it"}};

bool checksumHolds(const TfminiReader::Frame& frame) {
  return std::accumulate(frame.begin(), frame.end() - 1, 0u) % 256u == frame.back();
}

unsigned word(const TfminiReader::Frame& frame, std::size_t low) { return frame[low] + 256u * frame[low + 1]; }

}  // namespace

Measurement parseTfmini(const TfminiReader::Frame& frame, double unit_m) {
  const unsigned distance = word(frame, 2), strength = word(frame, 4);
  Measurement measurement;
  measurement.strength = strength;
  const auto* const error = std::find_if(std::begin(kErrors), std::end(kErrors),
                                         [&](const Error& error) { return distance - kCodes == error.code; });
  if (error != std::end(kErrors)) {
    measurement.error_code = error->code;
    measurement.error = error->meaning;
  } else if (strength != kOverexposed) {
    measurement.range_m = unit_m * distance;
  }
  return measurement;
}

std::optional<TfminiReader::Reading> TfminiReader::add(std::uint8_t byte, double arrival_s) {
  bytes_[size_] = byte;
  arrivals_s_[size_++] = arrival_s;
  while (!startsLikeAFrame()) {
    in_step_ = false;
    ++refused_;
    dropFirst(1);
  }
  if (size_ < kFrameBytes) return std::nullopt;
  if (!checksumHolds(bytes_)) {
    ++checksum_errors_;
    in_step_ = false;
    do {
      ++refused_;
      dropFirst(1);
    } while (!startsLikeAFrame());
    return std::nullopt;
  }
  size_ = 0;
  if (in_step_) return Reading{parseTfmini(bytes_, unit_m_), arrivals_s_[0]};
  in_step_ = true;
  refused_ += kFrameBytes;
  return std::nullopt;
}

bool TfminiReader::startsLikeAFrame() const {
  return std::all_of(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(size_, 2)),
                     [](std::uint8_t byte) { return byte == kHeader; });
}

void TfminiReader::dropFirst(std::size_t count) {
  std::copy(bytes_.begin() + count, bytes_.begin() + size_, bytes_.begin());
  std::copy(arrivals_s_.begin() + count, arrivals_s_.begin() + size_, arrivals_s_.begin());
  size_ -= count;
}

}  // namespace flight_corridor::serial
