// Semi-global matching on an OpenCL 1.2 device: the same evidence, bit by bit, as the CPU's matcher finds.
// The rules are those of matching_rules.hpp; kernels.hpp defines its constants here, and the sizes. Planes have
// HEIGHT rows of WIDTH pixels; volumes have DISPARITIES bytes a pixel.

#define PER_LANE (DISPARITIES / LANES)  // disparities of a curve that LANES work-items share
#define STRIDE (DISPARITIES + 4)        // of a tile's pixels in local memory: no two of them in one bank
#define WORDS ((DISPARITIES + 63) / 64)
#define REACH kWindowReach_px

int greyAt(__global const uchar* image, int u, int v) {
  return image[clamp(v, 0, HEIGHT - 1) * WIDTH + clamp(u, 0, WIDTH - 1)];
}

/// The cost C of a left pixel's code at disparity index d.
int costAt(ushort code, __global const ushort* right_row, int u, int d) {
  const int u_right = u - MIN_DISPARITY - d;
  return 0 <= u_right && u_right < WIDTH ? popcount((uint)(code ^ right_row[u_right])) : kUnseenCost;
}

/// Census codes of an image, a pixel a work-item.
__kernel void census(__global const uchar* image, __global ushort* codes) {
  const int u = get_global_id(0), v = get_global_id(1);
  if (u >= WIDTH || v >= HEIGHT) return;
  int code = 0, bit = 0;
  for (int du = -kCensusReach_px; du <= kCensusReach_px; ++du) {
    code |= (greyAt(image, u + du, v - 1) - greyAt(image, u - du, v + 1) > kBrighter_grey) << bit++;
  }
  for (int du = 1; du <= kCensusReach_px; ++du) {
    code |= (greyAt(image, u - du, v) - greyAt(image, u + du, v) > kBrighter_grey) << bit++;
  }
  for (int du = -1; du <= 1; ++du) {
    code |= (greyAt(image, u + du, v - 1) - greyAt(image, u, v) > kBrighter_grey) << bit++;
  }
  codes[v * WIDTH + u] = (ushort)code;
}

/// L of Hirschmueller 2008, eq. 13, along five paths. A group is a line of a path in a band of rows: groups (line, band,
/// path). A lane holds some disparities; one barrier a pixel brings it its neighbours and the minimum.
__kernel __attribute__((reqd_work_group_size(LANES, 1, 1)))
void aggregate(__global const uchar* grey, __global const ushort* left_codes, __global const ushort* right_codes,
               __global uchar* from_left, __global uchar* from_right, __global uchar* from_above,
               __global uchar* from_above_left, __global uchar* from_above_right) {
  __local int first_of[2][LANES + 1], last_of[2][LANES + 1], smallest[3];
  const int line = get_group_id(0), band = get_group_id(1), path = get_group_id(2), lane = get_local_id(0);
  const int first_v = HEIGHT * band / BANDS, end_v = HEIGHT * (band + 1) / BANDS, begin_v = max(0, first_v - RUN_UP);
  __global uchar* const out = path == 0   ? from_left
                              : path == 1 ? from_right
                              : path == 2 ? from_above
                              : path == 3 ? from_above_left
                                          : from_above_right;
  const int du = path == 0 || path == 3 ? 1 : path == 2 ? 0 : -1, dv = path > 1;
  const int side_u = du > 0 ? 0 : WIDTH - 1;
  int u, v;
  if (dv == 0) {
    u = side_u, v = first_v + line;
  } else if (line < WIDTH) {
    u = line, v = begin_v;
  } else {
    u = du == 0 ? WIDTH : side_u, v = begin_v + line - WIDTH + 1;
  }
  int length[PER_LANE], below = 255, above = 255, least = 0;
  for (int k = 0; k < PER_LANE; ++k) length[k] = 0;
  if (lane > 0) below = 0;
  if (lane < LANES - 1) above = 0;
  if (lane == 0) {
    for (int i = 0; i < 2; ++i) last_of[i][0] = first_of[i][LANES] = 255;  // beyond the curve's ends
    smallest[0] = smallest[1] = 255;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = 0; 0 <= u && u < WIDTH && v < end_v; u += du, v += dv, ++i) {
    const int step = abs(greyAt(grey, u, v) - greyAt(grey, u - du, v - dv));
    const int jump = least + (step > kEdge_grey ? kEdgeStepPenalty : kLargeStepPenalty);
    const ushort code = left_codes[v * WIDTH + u];
    __global const ushort* const right_row = right_codes + v * WIDTH;
    int before = below, own_least = 255;
    for (int k = 0; k < PER_LANE; ++k) {
      const int next = k + 1 < PER_LANE ? length[k + 1 < PER_LANE ? k + 1 : k] : above;
      const int stepped = min(min(length[k], min(before, next) + kSmallStepPenalty), jump);
      before = length[k];
      length[k] = costAt(code, right_row, u, lane * PER_LANE + k) + stepped - least;
      own_least = min(own_least, length[k]);
    }
    first_of[i & 1][lane] = length[0];
    last_of[i & 1][lane + 1] = length[PER_LANE - 1];
    atomic_min(&smallest[i % 3], own_least);
    if (lane == 0) smallest[(i + 1) % 3] = 255;
    if (v >= first_v) {
      __global uchar* const to = out + (size_t)(v * WIDTH + u) * DISPARITIES + lane * PER_LANE;
#if PER_LANE % 4 == 0
      for (int k = 0; k < PER_LANE; k += 4) {
        vstore4(convert_uchar4((int4)(length[k], length[k + 1], length[k + 2], length[k + 3])), 0, to + k);
      }
#else
      for (int k = 0; k < PER_LANE; ++k) to[k] = (uchar)length[k];
#endif
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    below = last_of[i & 1][lane];
    above = first_of[i & 1][lane + 1];
    least = smallest[i % 3];
  }
}

/// Best match, set and agreement of both views. A group is a row.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void findMinima(__global const uchar* from_left, __global const uchar* from_right, __global const uchar* from_above,
                __global const uchar* from_above_left, __global const uchar* from_above_right,
                __global uchar* winners, __global uchar* rises_below, __global uchar* rises_above,
                __global uchar* flags, __global ulong* set) {
  __local uint right_best[WIDTH];  // smallest sum of a right pixel, and the smallest disparity it belongs to
  __local uchar left_winner[WIDTH], sums[TILE][STRIDE];
  const int v = get_group_id(0), item = get_local_id(0);
  for (int u = item; u < WIDTH; u += GROUP) right_best[u] = 255u << 8;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int first_u = 0; first_u < WIDTH; first_u += TILE) {
    const int count = min(TILE, WIDTH - first_u);
    for (int i = item; i < count * (DISPARITIES / 4); i += GROUP) {
      const int pixel = i / (DISPARITIES / 4), first_d = i % (DISPARITIES / 4) * 4;
      const size_t at = (size_t)(v * WIDTH + first_u) * (DISPARITIES / 4) + i;
      const uchar4 sum = vload4(at, from_left) + vload4(at, from_right) + vload4(at, from_above) +
                         vload4(at, from_above_left) + vload4(at, from_above_right);
      uchar parts[4];
      vstore4(sum, 0, parts);
      for (int k = 0; k < 4; ++k) {
        sums[pixel][first_d + k] = parts[k];
        const int u_right = first_u + pixel - MIN_DISPARITY - first_d - k;
        const uint key = (uint)parts[k] << 8 | (uint)(first_d + k);
        if (0 <= u_right && u_right < WIDTH) atomic_min(&right_best[u_right], key);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int pixel = item; pixel < count; pixel += GROUP) {
      __local const uchar* const sum = sums[pixel];
      int winner = 0;
      for (int d = 1; d < DISPARITIES; ++d) {
        if (sum[d] < sum[winner]) winner = d;
      }
      const int limit = sum[winner] + kContradiction;
      const size_t at = (size_t)v * WIDTH + first_u + pixel;
      for (int word = 0; word < WORDS; ++word) {
        ulong bits = 0;
        for (int d = 64 * word; d < min(64 * word + 64, DISPARITIES); ++d) {
          bits |= (ulong)(sum[d] <= limit) << (d - 64 * word);
        }
        set[at * WORDS + word] = bits;
      }
      const int step = 0 < winner && winner < DISPARITIES - 1;  // 0: the sums end there
      left_winner[first_u + pixel] = winners[at] = (uchar)winner;
      rises_below[at] = sum[winner - step] - sum[winner];
      rises_above[at] = sum[winner + step] - sum[winner];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  for (int u = item; u < WIDTH; u += GROUP) {
    const int winner = left_winner[u], u_right = u - winner - MIN_DISPARITY;
    const bool seen = 0 <= u_right && u_right < WIDTH;
    flags[v * WIDTH + u] =
        seen && abs((int)(right_best[u_right] & 255) - winner) <= kConsistent_px ? kConsistent : 0;
  }
}

/// Distinct matches and their competitors, in the costs of a window. A group is a part of a row: groups (part, row).
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void judge(__global const ushort* left_codes, __global const ushort* right_codes, __global const uchar* winners,
           __global uchar* flags, __global uchar* farthest, __global uchar* nearest) {
  __local uchar columns[TILE + 2 * REACH][STRIDE], windows[TILE][STRIDE];
  const int first_u = get_group_id(0) * TILE, v = get_group_id(1), item = get_local_id(0);
  const int count = min(TILE, WIDTH - first_u);
  for (int i = item; i < (count + 2 * REACH) * DISPARITIES; i += GROUP) {
    const int column = i / DISPARITIES, d = i % DISPARITIES, u = clamp(first_u + column - REACH, 0, WIDTH - 1);
    int sum = 1;  // rounds
    for (int dv = -1; dv <= 1; ++dv) {
      const int row = clamp(v + dv, 0, HEIGHT - 1) * WIDTH;
      sum += costAt(left_codes[row + u], right_codes + row, u, d);
    }
    columns[column][d] = (uchar)(sum / 2);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = item; i < count * DISPARITIES; i += GROUP) {
    const int pixel = i / DISPARITIES, d = i % DISPARITIES;
    int sum = 0;
    for (int column = pixel; column <= pixel + 2 * REACH; ++column) sum += columns[column][d];
    windows[pixel][d] = (uchar)sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int pixel = item; pixel < count; pixel += GROUP) {
    __local const uchar* const costs = windows[pixel];
    const int u = first_u + pixel, at = v * WIDTH + u, winner = winners[at], last = DISPARITIES - 1;
    const int best = min(min((int)costs[max(winner - 1, 0)], (int)costs[winner]), (int)costs[min(winner + 1, last)]);
    const int right_most = min(u + REACH, WIDTH - 1), left_most = max(u - REACH, 0);
    const int first_whole = max(0, right_most - (WIDTH - 1) - MIN_DISPARITY);
    const int last_whole = min(last, left_most - MIN_DISPARITY);
    farthest[at] = nearest[at] = 0;
    uchar found = flags[at];
    if (!(found & kConsistent)) continue;
    int worse = 0;
    for (int d = first_whole; d <= last_whole; ++d) worse += costs[d] >= best + kClearlyWorse;
    if (winner < first_whole || winner > last_whole || 2 * worse < last_whole - first_whole + 1) continue;
    found |= kDistinct;
    int upper = winner + 1, lower = winner - 1;  // the first barriers on either side
    while (upper <= last && costs[upper] < best + kBarrier) ++upper;
    while (lower >= 0 && costs[lower] < best + kBarrier) --lower;
    const int first_seen = max(0, u - (WIDTH - 1) - MIN_DISPARITY), last_seen = min(last, u - MIN_DISPARITY);
    int first = DISPARITIES, end = -1;
    for (int d = first_seen; d <= last_seen; ++d) {
      if ((lower < d && d < upper) || costs[d] > best + kAsGood) continue;
      first = min(first, d);
      end = d;
    }
    if (end >= 0) {
      found |= first < winner ? kCompetitor | kRepeated : kCompetitor;
      farthest[at] = (uchar)first;
      nearest[at] = (uchar)end;
    }
    flags[at] = found;
  }
}

/// A half, rounded away from zero.
int halved(int value) { return (value + (value > 0)) >> 1; }

int withSignOf(int sign, int magnitude) { return sign < 0 ? -magnitude : magnitude; }

/// Sub-pixel indices [1 / kSubpixels], a pixel a work-item.
__kernel void fit(__global const uchar* left, __global const uchar* right, __global const uchar* winners,
                  __global const uchar* rises_below, __global const uchar* rises_above, __global const uchar* flags,
                  __global short* fixed) {
  const int u = get_global_id(0), v = get_global_id(1), at = v * WIDTH + u;
  if (u >= WIDTH || v >= HEIGHT) return;
  fixed[at] = kNoSubpixel;
  if (!(flags[at] & kDistinct)) return;
  int g = 0, e = 0, gg = 0, ge = 0;
  const int shift_px = winners[at] + MIN_DISPARITY, pixels = 3 * (2 * REACH + 1);
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - REACH; x <= u + REACH; ++x) {
      const int gradient = greyAt(left, x + 1, y) + greyAt(right, x + 1 - shift_px, y) - greyAt(left, x - 1, y) -
                           greyAt(right, x - 1 - shift_px, y);
      const int error = greyAt(right, x - shift_px, y) - greyAt(left, x, y);
      g += gradient, e += error, gg += gradient * gradient, ge += gradient * error;
    }
  }
  const int slope = rises_below[at] - rises_above[at], rise = rises_below[at] + rises_above[at];
  int offset = 0;
  if (rise > 0) {
    const int p = withSignOf(slope, halved(kSubpixels * abs(slope) / rise));
    const int num = 4 * (pixels * ge - g * e), den = pixels * gg - g * g;
    const int drawn = num + kNoise / kSubpixels * p;
    offset = p;
    if (abs(num) < den) {
      const int shift = halved((int)((ulong)abs(drawn) * (2 * kSubpixels) / (ulong)(den + kNoise)));
      offset = halved(p + withSignOf(drawn, shift));
    }
  }
  fixed[at] = (short)(winners[at] * kSubpixels + offset);
}

/// Matches averaged over their neighbours, a pixel a work-item; repeated ones apart.
/// @param pair_number goes to done: the kernels of this pair, the last of which this is, have run.
__kernel void average(__global const short* fixed, __global const uchar* flags, __global float* best,
                      __global float* repeated, __global const uint* pair_number, __global uint* done) {
  const int u = get_global_id(0), v = get_global_id(1), at = v * WIDTH + u;
  if (u == 0 && v == 0) *done = *pair_number;
  if (u >= WIDTH || v >= HEIGHT) return;
  best[at] = repeated[at] = NAN;
  const int middle = fixed[at];
  if (middle == kNoSubpixel) return;
  int shift = 0, weight = 0;
  for (int y = max(v - kAverageReach_px, 0); y <= min(v + kAverageReach_px, HEIGHT - 1); ++y) {
    for (int x = max(u - kAverageReach_px, 0); x <= min(u + kAverageReach_px, WIDTH - 1); ++x) {
      const int difference = fixed[y * WIDTH + x] - middle, likeness = max(kSubpixels - (int)abs(difference), 0);
      shift += difference * likeness;
      weight += likeness;
    }
  }
  const int fine = kFineSteps * middle + kFineSteps * shift / weight;
  const float match = (float)fine * (1.0f / (kSubpixels * kFineSteps)) + (MIN_DISPARITY - OFFSET_PX);
  if (fine < 0 || !(match >= -kLargestOffset_px)) return;
  (flags[at] & kRepeated ? repeated : best)[at] = max(match, kSmallestDisparity_px);
}
