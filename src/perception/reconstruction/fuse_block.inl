// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Fuses one frame into one block (weighted TSDF update), one or two rows of eight voxels at a time.
#include "perception/reconstruction/kernels.hpp"
#include "perception/reconstruction/simd_records.hpp"

namespace pcavr {
namespace {

// The weight falls linearly to zero over this last part of the truncation band behind the surface,
// where another surface may begin.
constexpr float kRampFraction = 0.4F;
// Colour is updated within this distance of the surface [voxels]: the ends of a crossed edge are
// within one voxel, plus a margin for noise.
constexpr float kColorBand = 1.25F;

// Member indices of PixelSurface.
enum Member { kNormalX, kNormalY, kNormalZ, kOffset, kWeight, kTruncation, kFreeDepth, kColor };

/// Rows of voxels processed together; they have the same z.
constexpr int kRows = kLanes / kBlockSide;

struct Rows {
  Floats x, y, z;  ///< voxels in camera axes [m]
  Ints pixel;      ///< pixel index; outside the image that of the pixel without a surface
};

inline Rows project_rows(const BlockView& view, int row) {
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

/// Blends one colour channel towards the measured one; `noise` in [0, 1) dithers the rounding, so
/// that small updates are not lost.
inline Ints blend_channel(Words old, Words measured, int shift, Floats fraction, Floats noise) {
  const Floats from = to_floats((Ints)((old >> shift) & 255U));
  const Floats to = to_floats((Ints)((measured >> shift) & 255U));
  return to_ints(from + (to - from) * fraction + noise) << shift;
}

inline Floats dither_noise(const BlockView& view, int row) {
  Words hash = (lane_numbers() + view.dither + static_cast<std::uint32_t>(row) * 8U) * 0x9E3779B1U;
  hash ^= hash >> 15;
  hash *= 0x85EBCA6BU;
  // 16 bits: added to 255 the maximum is still below 256, after rounding.
  return to_floats((Ints)(hash >> 16)) * (1.0F / 65536.0F);
}

inline Words blend_color(const BlockView& view, int row, Words old, Words measured,
                         Floats fraction) {
  const Words old_color = old & 0xFFFFFFU;
  const Floats first = select((Ints)(old_color == 0U), splat(1.0F), fraction);
  const Floats noise = dither_noise(view, row);
  const Ints mixed = blend_channel(old_color, measured, 0, first, noise) |
                     blend_channel(old_color, measured, 8, first, noise) |
                     blend_channel(old_color, measured, 16, first, noise);
  return (old & 0xFF000000U) | (Words)mixed;
}

/// Increments a 4-bit field where `mask` is set, saturating.
inline Words increment(Words counts, Ints mask, std::uint32_t one) {
  const std::uint32_t field = one * 15U;
  const Ints is_below_max = (Ints)((counts & field) != field);
  return counts + ((Words)(mask & is_below_max) & one);
}

/// `active`: the lanes that this frame may update.
__attribute__((always_inline)) inline void fuse_rows(const BlockView& view, int row, Ints active,
                                                     VoxelBlock& block) {
  const Rows at = project_rows(view, row);
  const RecordLanes pixel = load_records(&view.pixels->normal[0], at.pixel);
  const Floats truncation = pixel.of[kTruncation];
  const Floats distance =
      pixel.of[kOffset] -
      (pixel.of[kNormalX] * at.x + pixel.of[kNormalY] * at.y + pixel.of[kNormalZ] * at.z);
  const Ints in_band = active & (distance <= truncation) & (distance >= -truncation);
  const Ints is_free = active & (at.z < pixel.of[kFreeDepth]);
  Words* counts = reinterpret_cast<Words*>(&block.color_counts) + row / kRows;
  const Ints counted = is_free & (Ints)((*counts >> 28) < view.max_free_count);
  Words new_counts = *counts + (Words)(counted & (1 << 28));
  if (!any(in_band)) {
    // Unchanged rows are not written back.
    if (any(counted)) *counts = new_counts;
    return;
  }

  Words* lanes = reinterpret_cast<Words*>(&block.distance_weight) + row / kRows;
  const Ints stored = (Ints)*lanes;
  const Floats old_distance = to_floats((stored << 16) >> 16);
  const Floats old_weight = to_floats((Ints)((Words)stored >> 16));
  const Floats ramp = (distance + truncation) / (truncation * kRampFraction);
  const Floats weight = lane_max(pixel.of[kWeight] * lane_min(ramp, splat(1.0F)), splat(1.0F));
  const Floats fraction = weight / (old_weight + weight);
  const Floats measured = distance * view.steps_per_metre;
  const Ints mean = rounded(old_distance + (measured - old_distance) * fraction);
  const Ints clamped = lane_max(lane_min(mean, Ints{} + 32767), Ints{} - 32767);
  const Ints sum =
      lane_min(rounded(old_weight + weight), Ints{} + static_cast<std::int32_t>(kMaxWeight));
  *lanes = (Words)select(in_band, (clamped & 0xFFFF) | (sum << 16), stored);

  new_counts = increment(new_counts, in_band, 1U << 24);
  const Floats color_reach = splat(kColorBand * view.voxel_size);
  const Ints near = in_band & (distance <= color_reach) & (distance >= -color_reach);
  if (any(near)) {
    const Words colored = blend_color(view, row, new_counts, (Words)pixel.of[kColor], fraction);
    new_counts = (Words)select(near, (Ints)colored, (Ints)new_counts);
  }
  *counts = new_counts;
}

/// Whether the free counts of a whole row are at their maximum.
inline bool is_free_row(const BlockView& view, int row, const VoxelBlock& block) {
  const auto* counts = reinterpret_cast<const std::uint32_t*>(&block.color_counts);
  for (int i = row * kBlockSide; i < (row + 1) * kBlockSide; ++i) {
    if ((counts[i] >> 28) < view.max_free_count) return false;
  }
  return true;
}

/// Whether the frame affects the row.
inline bool is_affected(const BlockView& view, int row, const VoxelBlock& block) {
  const float z = view.origin[2] + static_cast<float>(row % kBlockSide) * view.step_y[2] +
                  static_cast<float>(row / kBlockSide) * view.step_z[2];
  const float z_end = z + (kBlockSide - 1) * view.step_x[2];
  const float min_depth = z < z_end ? z : z_end;
  const float max_depth = z < z_end ? z_end : z;
  const bool meets_band = max_depth >= view.min_band_depth && min_depth <= view.max_band_depth;
  return meets_band || (min_depth < view.max_free_depth && !is_free_row(view, row, block));
}

/// Each voxel is accessed once per frame, so that most blocks miss the cache: the next block is
/// prefetched while the current one is processed.
inline void prefetch_rows(const VoxelBlock* block, int row) {
  __builtin_prefetch(reinterpret_cast<const Words*>(&block->distance_weight) + row / kRows, 1);
  __builtin_prefetch(reinterpret_cast<const Words*>(&block->color_counts) + row / kRows, 1);
}

void fuse_block(const BlockView& view, VoxelBlock& block, const VoxelBlock* next) {
  const Ints is_second = (Ints)(lane_numbers() >= static_cast<std::uint32_t>(kBlockSide));
  for (int row = 0; row < kBlockSide * kBlockSide; row += kRows) {
    if (next != nullptr) prefetch_rows(next, row);
    const int first = is_affected(view, row, block) ? -1 : 0;
    const int second = kRows > 1 && is_affected(view, row + kRows - 1, block) ? -1 : 0;
    if ((first | second) == 0) continue;
    fuse_rows(view, row, select(is_second, Ints{} + second, Ints{} + first), block);
  }
}

}  // namespace
}  // namespace pcavr
