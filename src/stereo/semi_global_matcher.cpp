#include "flight_corridor/stereo/semi_global_matcher.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "flight_corridor/stereo/aligned_bytes.hpp"
#include "flight_corridor/stereo/cost_minima.hpp"
#include "flight_corridor/stereo/distinct_competitor.hpp"
#include "flight_corridor/stereo/path_aggregation.hpp"
#include "flight_corridor/stereo/subpixel.hpp"

namespace flight_corridor {

namespace {

void throwIfImpossible(const MatcherSize& size, int threads) {
  const auto require = [](bool holds, const std::string& rule) {
    if (!holds) throw std::invalid_argument("semi-global matcher: " + rule);
  };
  require(size.width_px >= 2 && size.height_px >= 2, "images must be 2 or more pixels wide and high");
  require(0 < size.num_disparities && size.num_disparities <= kLargestDisparities && size.num_disparities % 32 == 0,
          "the number of disparities must be a multiple of 32, up to " + std::to_string(kLargestDisparities));
  require(threads >= 1, "one thread or more must work");
}

}  // namespace

/// What one thread needs to match a band.
struct SemiGlobalMatcher::Worker {
  Worker(const MatcherSize& matcher_size, SubpixelPlane& subpixels)
      : size(matcher_size),
        fixed(subpixels),
        stored(storedDisparities(size.num_disparities)),
        census(size.width_px, size.min_disparity_px, size.num_disparities),
        paths(size.width_px, stored),
        minima(size.width_px, size.min_disparity_px, size.num_disparities),
        competitor(size.width_px, size.min_disparity_px, size.num_disparities),
        subpixel(size.width_px, size.min_disparity_px, size.num_disparities),
        sums(static_cast<std::size_t>(size.width_px) * stored) {
    for (AlignedBytes& row : costs) row = AlignedBytes(static_cast<std::size_t>(size.width_px) * stored);
    for (AlignedBytes& row : winner) row = AlignedBytes(size.width_px);
  }

  void matchBand(int first_v, int end_v, const GreyImage& left, const GreyImage& right, const MatchPlanes& out);
  void findMinima(int v, const GreyImage& left, const GreyImage& right, const MatchPlanes& out);
  void findCompetitors(int v, const MatchPlanes& out);
  std::uint8_t* costsOf(int v) { return costs[v % 3].data(); }

  MatcherSize size;
  SubpixelPlane& fixed;  // of all workers
  int stored;
  CensusCosts census;
  PathAggregation paths;
  CostMinima minima;
  DistinctCompetitor competitor;
  SubpixelFit subpixel;
  std::array<AlignedBytes, 3> costs;   // of three rows, for the competitors' window
  std::array<AlignedBytes, 2> winner;  // of two rows: competitors are found a row later
  AlignedBytes sums;
};

void SemiGlobalMatcher::Worker::matchBand(int first_v, int end_v, const GreyImage& left, const GreyImage& right,
                                          const MatchPlanes& out) {
  paths.restart();
  for (int v = std::max(0, first_v - kRunUp_px); v <= end_v; ++v) {
    if (v < size.height_px) census.compute(left, right, v, costsOf(v));
    if (v < end_v) paths.add(costsOf(v), left.row(v), v < first_v ? nullptr : sums.data());
    if (first_v <= v && v < end_v) findMinima(v, left, right, out);
    if (v > first_v) findCompetitors(v - 1, out);
  }
}

void SemiGlobalMatcher::Worker::findMinima(int v, const GreyImage& left, const GreyImage& right,
                                           const MatchPlanes& out) {
  const std::size_t at = static_cast<std::size_t>(v) * size.width_px;
  std::uint8_t* const winners = winner[v % 2].data();
  minima.find(sums.data(),
              {winners, out.farthest + at, out.nearest + at, out.flags + at, out.set + at * (stored / 64)});
  subpixel.fit(left, right, v, sums.data(), winners, out.flags + at, fixed.row(v));
}

void SemiGlobalMatcher::Worker::findCompetitors(int v, const MatchPlanes& out) {
  const std::size_t at = static_cast<std::size_t>(v) * size.width_px;
  competitor.find({costsOf(std::max(v - 1, 0)), costsOf(v), costsOf(std::min(v + 1, size.height_px - 1))},
                  winner[v % 2].data(), {out.competitor_farthest + at, out.competitor_nearest + at, out.flags + at});
}

SemiGlobalMatcher::SemiGlobalMatcher(const MatcherSize& size, int threads)
    : size_((throwIfImpossible(size, threads), size)),
      bands_(std::max(1, (size.height_px + kBand_px / 2) / kBand_px)),
      subpixels_(size.width_px, size.height_px),
      threads_(std::min(threads, bands_)) {
  for (int thread = 0; thread < threads_.threads(); ++thread)
    workers_.push_back(std::make_unique<Worker>(size, subpixels_));
}

SemiGlobalMatcher::~SemiGlobalMatcher() = default;

void SemiGlobalMatcher::match(const GreyImage& left, const GreyImage& right, const MatchPlanes& out) {
  const auto firstRow = [this](int band) { return size_.height_px * band / bands_; };
  threads_.run(bands_, [&](int band, int thread) {
    workers_[thread]->matchBand(firstRow(band), firstRow(band + 1), left, right, out);
  });
  threads_.run(bands_, [&](int band, int) {
    for (int v = firstRow(band); v < firstRow(band + 1); ++v) {
      subpixels_.average(v, out.best + static_cast<std::size_t>(v) * size_.width_px);
    }
  });
}

}  // namespace flight_corridor
