#include "flight_corridor/stereo/semi_global_matcher.hpp"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "stereo/row_matcher.hpp"

namespace flight_corridor {

namespace {

void throwIfImpossible(const MatcherSize& size) {
  const auto require = [](bool holds, const std::string& rule) {
    if (!holds) throw std::invalid_argument("semi-global matcher: " + rule);
  };
  require(size.width_px >= 2 && size.height_px >= 2, "images must be 2 or more pixels wide and high");
  require(0 < size.num_disparities && size.num_disparities <= kLargestDisparities && size.num_disparities % 32 == 0,
          "the number of disparities must be a multiple of 32, up to " + std::to_string(kLargestDisparities));
}

}  // namespace

struct SemiGlobalMatcher::Memory {
  explicit Memory(const MatcherSize& size) : subpixels(size) {}

  SubpixelPlane subpixels;
  std::vector<RowMatcher> bands;  // one a thread
};

SemiGlobalMatcher::SemiGlobalMatcher(const MatcherSize& size, BandWorkers& workers)
    : size_(size), bands_(bandsOf(size.height_px)), workers_(workers) {
  throwIfImpossible(size);
  memory_ = std::make_unique<Memory>(size);
  for (int thread = 0; thread < workers.threads(); ++thread) memory_->bands.emplace_back(size);
}

SemiGlobalMatcher::~SemiGlobalMatcher() = default;

void SemiGlobalMatcher::match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) {
  const auto firstRow = [this](int band) { return size_.height_px * band / bands_; };
  workers_.run(bands_, [&](int band, int thread) {
    memory_->bands[thread].matchBand({left, right}, firstRow(band), firstRow(band + 1), out, memory_->subpixels);
  });
  workers_.run(bands_, [&](int band, int) {
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) memory_->subpixels.average(v, out);
  });
}

}  // namespace flight_corridor
