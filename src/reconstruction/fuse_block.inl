// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// The fusion of one frame into one block, one or two rows of eight voxels at a time.
#include "reconstruction/kernels.hpp"
#include "reconstruction/simd_records.hpp"

namespace pcavr {
namespace {

// Weight falls from full to nothing over the last part of the band behind the surface, where
// another surface may begin.
constexpr float kRampShare = 0.4F;
// Colour is kept this near to the surface, in voxels: the ends of a crossed edge are within one,
// and noise may move them by a little more.
constexpr float kColorBand = 1.25F;

// The members of PixelSurface, by their place in it.
enum Member { kNormalX, kNormalY, kNormalZ, kOffset, kWeight, kTruncation, kFreeDepth, kColor };

/// Rows of voxels handled together; they share their place along z.
constexpr int kRows = kLanes / kBlockSide;

struct Rows {
  Floats x, y, z;  ///< voxels in camera axes [m]
  Ints pixel;      ///< number of the pixel; that without a surface where outside the image
};

inline Rows place_rows(const BlockView& view, int row) {
  const Words lane = lane_numbers();
  const Floats ix = to_floats((Ints)(lane % kBlockSide));
  const Floats iy = to_floats((Ints)(lane / kBlockSide)) + static_cast<float>(row % kBlockSide);
  const auto iz = static_cast<float>(row / kBlockSide);
  Floats p[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = view.origin[i] + iy * view.step_y[i] + iz * view.step_z[i] + ix * view.step_x[i];
  }
  const Floats inverse = 1.0F / p[2];
  const Floats u = p[0] * inverse * view.fx + (view.cx + 0.5F);
  const Floats v = p[1] * inverse * view.fy + (view.cy + 0.5F);
  const Ints inside = (p[2] > 0.0F) & (u >= 0.0F) & (v >= 0.0F) &
                      (u < static_cast<float>(view.width)) & (v < static_cast<float>(view.height));
  const Ints column = to_ints(select(inside, u, Floats{}));
  const Ints line = to_ints(select(inside, v, Floats{}));
  return {p[0], p[1], p[2],
          select(inside, line * view.width + column, Ints{} + view.width * view.height)};
}

/// One channel of the colour moved toward the measured one; `noise` in [0, 1) makes the rounding
/// right on average, so that small steps are not lost.
inline Ints blend_channel(Words old, Words seen, int shift, Floats share, Floats noise) {
  const Floats from = to_floats((Ints)((old >> shift) & 255U));
  const Floats to = to_floats((Ints)((seen >> shift) & 255U));
  return to_ints(from + (to - from) * share + noise) << shift;
}

inline Floats dither_noise(const BlockView& view, int row) {
  Words hash = (lane_numbers() + view.dither + static_cast<std::uint32_t>(row) * 8U) * 0x9E3779B1U;
  hash ^= hash >> 15;
  hash *= 0x85EBCA6BU;
  // 23 bits, so that the largest stays below one.
  return to_floats((Ints)(hash >> 9)) * (1.0F / 8388608.0F);
}

inline Words blend_color(const BlockView& view, int row, Words old, Words seen, Floats share) {
  const Words old_color = old & 0xFFFFFFU;
  const Floats first = select((Ints)(old_color == 0U), splat(1.0F), share);
  const Floats noise = dither_noise(view, row);
  const Ints mixed = blend_channel(old_color, seen, 0, first, noise) |
                     blend_channel(old_color, seen, 8, first, noise) |
                     blend_channel(old_color, seen, 16, first, noise);
  return (old & 0xFF000000U) | (Words)mixed;
}

/// Counts up a 4-bit field where `mask`, stopping at its largest value.
inline Words count_up(Words counts, Ints mask, std::uint32_t one) {
  const std::uint32_t field = one * 15U;
  const Ints room = (Ints)((counts & field) != field);
  return counts + ((Words)(mask & room) & one);
}

/// `wanted`: the lanes that this frame may change.
__attribute__((always_inline)) inline void fuse_rows(const BlockView& view, int row, Ints wanted,
                                                     VoxelBlock& block) {
  const Rows at = place_rows(view, row);
  const EightMembers pixel = load_records(&view.pixels->normal[0], at.pixel);
  const Floats truncation = pixel.of[kTruncation];
  const Floats distance =
      pixel.of[kOffset] -
      (pixel.of[kNormalX] * at.x + pixel.of[kNormalY] * at.y + pixel.of[kNormalZ] * at.z);
  const Ints in_band = wanted & (distance <= truncation) & (distance >= -truncation);
  const Ints through = wanted & (at.z < pixel.of[kFreeDepth]);
  Words* counts = reinterpret_cast<Words*>(&block.color_counts) + row / kRows;
  const Ints counted = through & (Ints)((*counts >> 28) < view.through_enough);
  Words new_counts = *counts + (Words)(counted & (1 << 28));
  if (!any(in_band)) {
    // Rows that stay as they are need not go back to memory.
    if (any(counted)) *counts = new_counts;
    return;
  }

  Words* lanes = reinterpret_cast<Words*>(&block.distance_weight) + row / kRows;
  const Ints stored = (Ints)*lanes;
  const Floats old_distance = to_floats((stored << 16) >> 16);
  const Floats old_weight = to_floats((Ints)((Words)stored >> 16));
  const Floats ramp = (distance + truncation) / (truncation * kRampShare);
  const Floats weight = larger(pixel.of[kWeight] * smaller(ramp, splat(1.0F)), splat(1.0F));
  const Floats share = weight / (old_weight + weight);
  const Floats measured = distance * view.steps_per_metre;
  const Ints mean = rounded(old_distance + (measured - old_distance) * share);
  const Ints clamped = larger(smaller(mean, Ints{} + 32767), Ints{} - 32767);
  const Ints sum =
      smaller(rounded(old_weight + weight), Ints{} + static_cast<std::int32_t>(kLargestWeight));
  *lanes = (Words)select(in_band, (clamped & 0xFFFF) | (sum << 16), stored);

  new_counts = count_up(new_counts, in_band, 1U << 24);
  const Floats color_reach = splat(kColorBand * view.voxel_size);
  const Ints near = in_band & (distance <= color_reach) & (distance >= -color_reach);
  if (any(near)) {
    const Words colored = blend_color(view, row, new_counts, (Words)pixel.of[kColor], share);
    new_counts = (Words)select(near, (Ints)colored, (Ints)new_counts);
  }
  *counts = new_counts;
}

/// Whether a whole row has been seen through often enough.
inline bool is_clear(const BlockView& view, int row, const VoxelBlock& block) {
  const auto* counts = reinterpret_cast<const std::uint32_t*>(&block.color_counts);
  for (int i = row * kBlockSide; i < (row + 1) * kBlockSide; ++i) {
    if ((counts[i] >> 28) < view.through_enough) return false;
  }
  return true;
}

/// Whether the frame has anything to say about the row.
inline bool is_wanted(const BlockView& view, int row, const VoxelBlock& block) {
  const float z = view.origin[2] + static_cast<float>(row % kBlockSide) * view.step_y[2] +
                  static_cast<float>(row / kBlockSide) * view.step_z[2];
  const float z_end = z + (kBlockSide - 1) * view.step_x[2];
  const float nearest = z < z_end ? z : z_end;
  const float farthest = z < z_end ? z_end : z;
  const bool meets_band = farthest >= view.band_nearest && nearest <= view.band_farthest;
  return meets_band || (nearest < view.free_farthest && !is_clear(view, row, block));
}

/// A voxel is touched once a frame, so that nearly every block comes from memory: it is fetched
/// while the one before is worked on.
inline void fetch_rows(const VoxelBlock* block, int row) {
  __builtin_prefetch(reinterpret_cast<const Words*>(&block->distance_weight) + row / kRows, 1);
  __builtin_prefetch(reinterpret_cast<const Words*>(&block->color_counts) + row / kRows, 1);
}

void fuse_block(const BlockView& view, VoxelBlock& block, const VoxelBlock* next) {
  const Ints is_second = (Ints)(lane_numbers() >= static_cast<std::uint32_t>(kBlockSide));
  for (int row = 0; row < kBlockSide * kBlockSide; row += kRows) {
    if (next != nullptr) fetch_rows(next, row);
    const int first = is_wanted(view, row, block) ? -1 : 0;
    const int second = kRows > 1 && is_wanted(view, row + kRows - 1, block) ? -1 : 0;
    if ((first | second) == 0) continue;
    fuse_rows(view, row, select(is_second, Ints{} + second, Ints{} + first), block);
  }
}

}  // namespace
}  // namespace pcavr
