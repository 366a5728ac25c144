#include "flight_corridor/stereo/aligned_bytes.hpp"

#include <algorithm>
#include <new>

namespace flight_corridor {

namespace {

constexpr std::align_val_t kAligned{AlignedBytes::kAlignment};

}  // namespace

AlignedBytes::AlignedBytes(std::size_t size)
    : bytes_(static_cast<std::uint8_t*>(::operator new(size + AlignedBytes::kAlignment, kAligned))) {
  std::fill_n(bytes_.get(), size + AlignedBytes::kAlignment, std::uint8_t{0});
}

void AlignedBytes::Free::operator()(std::uint8_t* bytes) const { ::operator delete(bytes, kAligned); }

}  // namespace flight_corridor
