// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Passes over whole depth images, a row of pixels at a time.
#include "perception/reconstruction/kernels.hpp"
#include "perception/reconstruction/simd_lanes.hpp"

namespace pcavr {
namespace {

// A straight edge has five of eight neighbours on its surface, a corner three; an outlier none.
constexpr int kMinConsistent = 3;
// Three neighbours are inconsistent at a depth discontinuity, one is next to an isolated outlier.
constexpr int kMaxInconsistent = 1;
// Four pixels are one surface where their maximum depth is at most this multiple of the minimum.
constexpr float kMaxPoolRatio = 1.02F;

inline Floats filtered_lanes(const FilterRow& row, int u) {
  const float* centre = row.centre + u;
  const Floats z = load(centre);
  const Floats position = lane_max(Floats{}, (z - row.min_depth) * row.steps_per_metre);
  const Floats step = gather(row.max_steps, to_ints(position));
  Ints consistent = {};
  Ints inconsistent = {};
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      if (dv == 0 && du == 0) continue;
      const Floats other = load(centre + dv * row.stride + du);
      const Ints is_valid = other > 0.0F;
      const Floats difference = other - z;
      const Ints is_near = (difference <= step) & (difference >= -step);
      // A true lane of a mask is -1.
      consistent -= is_valid & is_near;
      inconsistent -= is_valid & ~is_near;
    }
  }
  return masked((consistent >= kMinConsistent) & (inconsistent <= kMaxInconsistent), z);
}

void filter_row(const FilterRow& row, float* filtered) {
  int u = 0;
  for (; u + kLanes <= row.width; u += kLanes) store(filtered_lanes(row, u), filtered + u);
  if (u < row.width) store_some(filtered_lanes(row, u), row.width - u, filtered + u);
}

/// 2x2 pixels in each lane.
struct Pools {
  Floats of[4];
};

inline Pools load_pools(const float* top, const float* bottom) {
  const Floats a = load(top);
  const Floats b = load(top + kLanes);
  const Floats c = load(bottom);
  const Floats d = load(bottom + kLanes);
  return {{even_lanes(a, b), odd_lanes(a, b), even_lanes(c, d), odd_lanes(c, d)}};
}

inline Pools load_some_pools(const float* top, const float* bottom, int count) {
  Pools pools = {};
  for (int i = 0; i < count; ++i) {
    pools.of[0][i] = top[2 * i];
    pools.of[1][i] = top[2 * i + 1];
    pools.of[2][i] = bottom[2 * i];
    pools.of[3][i] = bottom[2 * i + 1];
  }
  return pools;
}

inline Floats min_of(const Pools& pools) {
  return lane_min(lane_min(pools.of[0], pools.of[1]), lane_min(pools.of[2], pools.of[3]));
}

inline Floats pooled(const Pools& pools) {
  Pools valid;
  for (int i = 0; i < 4; ++i) valid.of[i] = select(pools.of[i] > 0.0F, pools.of[i], splat(1e9F));
  const Floats limit = min_of(valid) * kMaxPoolRatio;
  Floats sum = {};
  Floats count = {};
  for (const Floats z : pools.of) {
    const Ints is_same = (z > 0.0F) & (z <= limit);
    sum += masked(is_same, z);
    count += masked(is_same, splat(1.0F));
  }
  return sum / lane_max(count, splat(1.0F));
}

void pool_min(const float* top, const float* bottom, int width, float* to) {
  int u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    store(min_of(load_pools(top + 2 * u, bottom + 2 * u)), to + u);
  }
  if (u == width) return;
  store_some(min_of(load_some_pools(top + 2 * u, bottom + 2 * u, width - u)), width - u, to + u);
}

void pool_depth(const float* top, const float* bottom, int width, float* to) {
  int u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    store(pooled(load_pools(top + 2 * u, bottom + 2 * u)), to + u);
  }
  if (u == width) return;
  store_some(pooled(load_some_pools(top + 2 * u, bottom + 2 * u, width - u)), width - u, to + u);
}

/// Red, green and blue (lowest byte first) of every second pixel.
inline Words load_colors(const std::uint8_t* first) {
  return (Words)gather_bytes(first, (Ints)lane_numbers() * 6) & 0xFFFFFFU;
}
/// Colours of the pixels after those; does not read beyond the last pixel.
inline Words load_next_colors(const std::uint8_t* first) {
  return (Words)gather_bytes(first + 2, (Ints)lane_numbers() * 6) >> 8;
}

void pool_colors(const std::uint8_t* top, const std::uint8_t* bottom, int width,
                 std::uint32_t* to) {
  int u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    const Words four[4] = {load_colors(top + 6 * u), load_next_colors(top + 6 * u),
                           load_colors(bottom + 6 * u), load_next_colors(bottom + 6 * u)};
    // Two sums of ten bits in one word, plus half a unit for rounding.
    Words red_blue = Words{} + 0x020002U;
    Words green = Words{} + 0x000200U;
    for (const Words color : four) {
      red_blue += color & 0xFF00FFU;
      green += color & 0x00FF00U;
    }
    const Words mean = ((red_blue >> 2) & 0xFF00FFU) | ((green >> 2) & 0x00FF00U);
    const Words visible = (Words)lane_max((Ints)mean, Ints{} + 1);
    __builtin_memcpy(to + u, &visible, sizeof(visible));
  }
  for (; u < width; ++u) {
    std::uint32_t mean = 0;
    for (int i = 0; i < 3; ++i) {
      const int at = 6 * u + i;
      const int sum = top[at] + top[at + 3] + bottom[at] + bottom[at + 3];
      mean |= static_cast<std::uint32_t>((sum + 2) / 4) << (8 * i);
    }
    to[u] = mean == 0U ? 1U : mean;
  }
}

}  // namespace
}  // namespace pcavr
