#include "flight_corridor/disparity_refiner.hpp"

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "flight_corridor/wide_registers.hpp"

namespace flight_corridor {

namespace {

constexpr int kReachOfWindow_px = 3;  // the window that is registered, from its centre
constexpr int kWindow_px = 2 * kReachOfWindow_px + 1;
constexpr float kLargestStep_px = 0.3f;  // the bias is less; a longer step follows noise or another surface
constexpr float kNoise = 0.5f;           // squared gradient [grey^2/px^2] that noise alone shows
constexpr int kReach_px = 7;             // how far a surface is averaged, along rows and columns
constexpr float kSameSurface_px = 1.0f;  // neighbours that differ by less, the more the less they differ
constexpr int kSteps = 2;                // of registration: a match may be off by more than one mends
constexpr double kThin = 0.45;           // of the neighbours on the same surface: fewer belong to a thin thing

/// Planes of a row: 1, residual e, gradient g, e g, g^2; all 0 where there is no disparity.
constexpr int kPlanes = 5;
constexpr int kTaps = 2;  // of the gradient, on each side

/// @param planes kPlanes of cols + 2 kReachOfWindow_px each: room for the window at both ends.
void multiply(const std::uint8_t* left, const std::uint8_t* right, const float* disparity_px, int cols, float* planes) {
  const int stride = cols + 2 * kReachOfWindow_px;
  for (int u = kTaps; u < cols - kTaps; ++u) {
    const float x = static_cast<float>(u) - disparity_px[u];
    if (!(0.0f <= x && x < static_cast<float>(cols - 1))) continue;
    const int i = static_cast<int>(x);
    const float there = right[i] + (x - static_cast<float>(i)) * static_cast<float>(right[i + 1] - right[i]);
    const float e = there - left[u];
    // Four taps, not two: a gradient that is too small makes the step too long.
    const float g = static_cast<float>(left[u - 2] - left[u + 2] + 8 * (left[u + 1] - left[u - 1])) / 12.0f;
    float* out = planes + kReachOfWindow_px + u;
    out[0] = 1.0f;
    out[stride] = e;
    out[2 * stride] = g;
    out[3 * stride] = e * g;
    out[4 * stride] = g * g;
  }
}

/// Adds count runs of a length that begin step apart.
FLIGHT_CORRIDOR_WIDE void addRuns(const float* runs, int count, std::size_t step, int length, float* sum) {
  std::fill_n(sum, length, 0.0f);
  for (int k = 0; k < count; ++k) {
    const float* run = runs + k * step;
    for (int i = 0; i < length; ++i) sum[i] += run[i];
  }
}

/// The least-squares step from a window's sums.
FLIGHT_CORRIDOR_WIDE void step(const float* sums, const float* disparity_px, int cols, float* registered_px) {
  const float *n_row = sums, *e = sums + cols, *g = sums + 2 * cols, *eg = sums + 3 * cols, *gg = sums + 4 * cols;
  for (int u = 0; u < cols; ++u) {
    const float n = std::max(n_row[u], 1.0f);
    const float covariance = eg[u] - e[u] * g[u] / n;
    const float variance = gg[u] - g[u] * g[u] / n;
    registered_px[u] =
        disparity_px[u] + std::clamp(covariance / (variance + n * kNoise), -kLargestStep_px, kLargestStep_px);
  }
}

/// Sums over the neighbours of each pixel of a row.
struct Neighbours {
  Neighbours(float* sums, int cols) : values(sums), same(sums + cols), count(sums + 2 * cols) {}

  float* values;  // weighted by
  float* same;    // how much each lies on the same surface [0..1]
  float* count;   // of those that have a disparity
};

/// Adds one neighbour each. The compiler reckons several at once: without __restrict, or with another choice that
/// depends on the same comparison, it does not and is ten times slower.
FLIGHT_CORRIDOR_WIDE void add(const float* __restrict neighbour_px, const float* __restrict centre_px,
                              const float* __restrict value, int length, float* __restrict values,
                              float* __restrict same, float* __restrict count) {
  for (int i = 0; i < length; ++i) {
    const float away = (neighbour_px[i] - centre_px[i]) / kSameSurface_px;
    const float closeness = 1.0f - away * away;
    const float weight = closeness > 0.0f ? closeness : 0.0f;  // 0 also of NaN
    const float weighted = weight * value[i];
    values[i] += weighted == weighted ? weighted : 0.0f;
    same[i] += weight;
    count[i] += neighbour_px[i] == neighbour_px[i] ? 1.0f : 0.0f;
  }
}

}  // namespace

void DisparityRefiner::refine(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity_px, cv::Mat& thin) {
  const int bands = static_cast<int>(bands_.size());
  const auto eachBand = [&](const auto& work) {
    cv::parallel_for_({0, bands}, [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) {
        work(cv::Range(left.rows * i / bands, left.rows * (i + 1) / bands), bands_[static_cast<std::size_t>(i)]);
      }
    });
  };
  for (cv::Mat* image : {&registered_, &smoothed_, &row_share_, &column_share_, &share_}) {
    image->create(left.size(), CV_32FC1);
  }
  const auto average = [&](const cv::Mat& surfaces_px, const cv::Mat& values, cv::Point step, cv::Mat& mean,
                           cv::Mat& own_share) {
    eachBand([&](cv::Range rows, Band& band) { averageRows(surfaces_px, values, step, rows, mean, own_share, band); });
  };
  const cv::Point kAlongRow(1, 0), kAlongColumn(0, 1);
  for (int i = 0; i < kSteps; ++i) {
    eachBand([&](cv::Range rows, Band& band) { registerRows(left, right, disparity_px, rows, band); });
    average(registered_, registered_, kAlongRow, smoothed_, row_share_);
    average(smoothed_, smoothed_, kAlongColumn, disparity_px, column_share_);
  }
  cv::multiply(row_share_, column_share_, share_);
  average(disparity_px, share_, kAlongRow, smoothed_, row_share_);
  average(disparity_px, smoothed_, kAlongColumn, share_, column_share_);
  cv::compare(share_, kThin, thin, cv::CMP_LT);
}

/// R(u - d - step) = L(u) to first order, in the least-squares sense over a window, whatever the exposures' difference.
void DisparityRefiner::registerRows(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity_px,
                                    cv::Range rows, Band& band) {
  const int cols = left.cols, stride = cols + 2 * kReachOfWindow_px;
  const auto row_size = static_cast<std::size_t>(kPlanes * cols);
  band.rows.resize(kWindow_px * row_size);  // the window's rows, each summed along the row
  band.sums.resize(row_size);
  for (int v = rows.start - kReachOfWindow_px; v < rows.end + kReachOfWindow_px; ++v) {
    float* row = &band.rows[static_cast<std::size_t>(v + kWindow_px) % kWindow_px * row_size];
    band.products.assign(static_cast<std::size_t>(kPlanes * stride), 0.0f);
    if (0 <= v && v < left.rows) {
      multiply(left.ptr<std::uint8_t>(v), right.ptr<std::uint8_t>(v), disparity_px.ptr<float>(v), cols,
               band.products.data());
    }
    for (int plane = 0; plane < kPlanes; ++plane) {
      addRuns(&band.products[static_cast<std::size_t>(plane * stride)], kWindow_px, 1, cols, row + plane * cols);
    }
    const int centre = v - kReachOfWindow_px;
    if (centre < rows.start) continue;
    addRuns(band.rows.data(), kWindow_px, row_size, kPlanes * cols, band.sums.data());
    step(band.sums.data(), disparity_px.ptr<float>(centre), cols, registered_.ptr<float>(centre));
  }
}

/// The mean of what the neighbours along one direction have that lie on the same surface.
/// @param own_share of the neighbours that have a disparity, those on the same surface; 1 where there is none.
void DisparityRefiner::averageRows(const cv::Mat& surfaces_px, const cv::Mat& values, cv::Point step, cv::Range rows,
                                   cv::Mat& mean, cv::Mat& own_share, Band& band) {
  const cv::Size size = surfaces_px.size();
  band.sums.resize(static_cast<std::size_t>(3 * size.width));
  const Neighbours sums(band.sums.data(), size.width);
  for (int v = rows.start; v < rows.end; ++v) {
    const auto* centre_px = surfaces_px.ptr<float>(v);
    std::fill(band.sums.begin(), band.sums.end(), 0.0f);
    for (int k = -kReach_px; k <= kReach_px; ++k) {
      const int row = v + k * step.y, shift = k * step.x;
      if (row < 0 || row >= size.height) continue;
      const int first = std::max(0, -shift), last = std::min(size.width, size.width - shift);
      add(surfaces_px.ptr<float>(row) + shift + first, centre_px + first, values.ptr<float>(row) + shift + first,
          last - first, sums.values + first, sums.same + first, sums.count + first);
    }
    auto* out = mean.ptr<float>(v);
    auto* share = own_share.ptr<float>(v);
    for (int u = 0; u < size.width; ++u) {
      out[u] = sums.values[u] / sums.same[u];  // 0 / 0 only where there is no disparity
      share[u] = sums.same[u] > 0.0f ? sums.same[u] / sums.count[u] : 1.0f;
    }
  }
}

}  // namespace flight_corridor
