#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace flight_corridor {

/// Bytes that vector instructions may load whole: aligned, zero at first, with room for one vector behind the last.
class AlignedBytes {
 public:
  static constexpr std::size_t kAlignment = 64;  ///< A cache line; no vector is longer.

  AlignedBytes() = default;
  explicit AlignedBytes(std::size_t size);

  std::uint8_t* data() { return bytes_.get(); }
  const std::uint8_t* data() const { return bytes_.get(); }

 private:
  struct Free {
    void operator()(std::uint8_t* bytes) const;
  };
  std::unique_ptr<std::uint8_t, Free> bytes_;
};

}  // namespace flight_corridor
