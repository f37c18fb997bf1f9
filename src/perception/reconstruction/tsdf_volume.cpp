// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/perception/reconstruction/tsdf_part.hpp"

#include "perception/reconstruction/block_map.hpp"
#include "perception/reconstruction/block_selection.hpp"
#include "perception/reconstruction/frame_surface.hpp"
#include "perception/reconstruction/kernels.hpp"
#include "perception/reconstruction/past_views.hpp"
#include "perception/reconstruction/surface_extraction.hpp"
#include "perception/reconstruction/undistortion.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kGrainBlocks = 32;  // amortises the scheduling of a task

BlockView view_of(const FrameSurface& frame, const Pose& T_camera_base, double voxel_size,
                  std::uint32_t frame_number) {
  const CameraModel& camera = frame.camera;
  BlockView view{};
  view.pixels = frame.pixels.data();
  view.width = camera.width;
  view.height = camera.height;
  view.fx = static_cast<float>(camera.fx);
  view.fy = static_cast<float>(camera.fy);
  view.cx = static_cast<float>(camera.cx);
  view.cy = static_cast<float>(camera.cy);
  const Eigen::Matrix3d R = T_camera_base.rotation_matrix() * voxel_size;
  for (int i = 0; i < 3; ++i) {
    view.step_x[i] = static_cast<float>(R(i, 0));
    view.step_y[i] = static_cast<float>(R(i, 1));
    view.step_z[i] = static_cast<float>(R(i, 2));
  }
  view.steps_per_metre = static_cast<float>(kDistanceSteps / voxel_size);
  view.voxel_size = static_cast<float>(voxel_size);
  view.dither = frame_number * 0x632BE5ABU;
  return view;
}

const TsdfOptions& checked(const TsdfOptions& options) {
  PCAVR_REQUIRE(options.voxel_size > 0.0, options.voxel_size);
  PCAVR_REQUIRE(options.truncation_voxels >= 2.0, options.truncation_voxels);
  PCAVR_REQUIRE(options.truncation_std >= 0.0, options.truncation_std);
  PCAVR_REQUIRE(
      options.frames_to_clear >= 1 && options.frames_to_clear <= static_cast<int>(kMaxCount),
      options.frames_to_clear);
  return options;
}

}  // namespace

/// The blocks of a volume, or of a part of it.
struct TsdfBlocks {
  explicit TsdfBlocks(const TsdfOptions& chosen, const std::optional<BlockBox>& chosen_part = {})
      : options(checked(chosen)),
        part(chosen_part),
        tables(chosen.depth_noise, chosen.truncation_voxels * chosen.voxel_size,
               chosen.truncation_std) {}

  TsdfOptions options;
  std::optional<BlockBox> part;
  NoiseTables tables;
  BlockMap map;
  PastViews past_views;
  Undistortion undistortion;
  FrameSurface frame;  ///< reused to avoid allocations
  std::uint32_t frames = 0;

  IntegrationReport integrate(const DepthImage& depth, const ColorImage& color,
                              const MaskImage& is_dynamic, const CameraModel& camera,
                              const Pose& T_base_camera, Parallelism parallelism);
  /// Allocates the missing blocks; returns their number.
  std::uint32_t add_blocks(const std::vector<BlockCoordinates>& coordinates,
                           Parallelism parallelism);
  /// `next`: the block that is fused after it, or null; prefetched.
  void fuse(const VisibleBlock& visible, const VisibleBlock* next, BlockView view,
            const Pose& T_camera_base);
  [[nodiscard]] ExtractionParameters extraction(const SurfaceEvidence& evidence) const {
    return {.voxel_size = options.voxel_size,
            .min_weight = evidence.min_weight,
            .frames_to_clear = options.frames_to_clear,
            .min_uncontradicted_weight = evidence.min_uncontradicted_weight};
  }
};

std::uint32_t TsdfBlocks::add_blocks(const std::vector<BlockCoordinates>& coordinates,
                                     Parallelism parallelism) {
  const auto first = static_cast<std::uint32_t>(map.size());
  // Marching cubes and normals reach into the blocks next to the part.
  const BlockBox kept = part ? part->expanded(1) : BlockBox();
  for (const BlockCoordinates& block : coordinates) {
    if (part && !kept.contains({block.x, block.y, block.z})) continue;
    if (map.find(block) == BlockHashTable::kNone) map.add(block);
  }
  parallel_for(parallelism, map.size() - first, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t number = first + static_cast<std::uint32_t>(i);
      past_views.count_free_views(map.coordinates(number), options.voxel_size, map.block(number));
    }
  });
  return static_cast<std::uint32_t>(map.size()) - first;
}

void TsdfBlocks::fuse(const VisibleBlock& visible, const VisibleBlock* next, BlockView view,
                      const Pose& T_camera_base) {
  if (visible.is_entirely_free) {
    std::uint8_t& count = map.block_free_count(visible.number);
    if (count < kMaxCount) ++count;
    return;
  }
  const BlockCoordinates& coordinates = map.coordinates(visible.number);
  const Eigen::Vector3d p_base = Eigen::Vector3d(coordinates.x, coordinates.y, coordinates.z) *
                                 (kBlockSide * options.voxel_size);
  const Eigen::Vector3d p_camera = T_camera_base * p_base;
  for (int i = 0; i < 3; ++i) view.origin[i] = static_cast<float>(p_camera[i]);
  view.min_band_depth = visible.min_band_depth;
  view.max_band_depth = visible.max_band_depth;
  view.max_free_depth = visible.max_free_depth;
  view.max_free_count = kMaxCount;
  const VoxelBlock* next_block =
      next != nullptr && !next->is_entirely_free ? &map.block(next->number) : nullptr;
  kernels().fuse_block(view, map.block(visible.number), next_block);
}

IntegrationReport TsdfBlocks::integrate(const DepthImage& depth, const ColorImage& color,
                                        const MaskImage& is_dynamic, const CameraModel& camera,
                                        const Pose& T_base_camera, Parallelism parallelism) {
  PCAVR_REQUIRE(depth.width() == camera.width && depth.height() == camera.height, depth.width(),
                depth.height(), camera.width, camera.height);
  PCAVR_REQUIRE(color.empty() || color.pixels().size() == depth.pixels().size(), color.width());
  PCAVR_REQUIRE(is_dynamic.empty() || is_dynamic.pixels().size() == depth.pixels().size(),
                is_dynamic.width());
  if (camera.has_distortion()) {
    undistortion.prepare(camera);
    const Undistortion& undistort = undistortion;
    return integrate(undistort(depth), undistort(color), undistort(is_dynamic),
                     undistort.undistorted_camera(), T_base_camera, parallelism);
  }
  const double voxel_size = options.voxel_size;
  prepare_frame(depth, color, is_dynamic, camera, tables, parallelism, frame);
  IntegrationReport report;
  report.pixels_used = frame.pixels_used;
  report.blocks_added = add_blocks(
      blocks_near_surface(frame, T_base_camera, tables, voxel_size, parallelism), parallelism);
  const std::vector<VisibleBlock> visible =
      visible_blocks(map, frame, T_base_camera, tables, voxel_size);
  report.blocks_visible = visible.size();
  const Pose T_camera_base = T_base_camera.inverse();
  const BlockView view = view_of(frame, T_camera_base, voxel_size, frames);
  parallel_for(parallelism, visible.size(), kGrainBlocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const VisibleBlock* next = i + 1 < end ? &visible[i + 1] : nullptr;
      fuse(visible[i], next, view, T_camera_base);
    }
  });
  past_views.add(frame, T_base_camera);
  ++frames;
  return report;
}

struct TsdfVolume::Blocks : TsdfBlocks {
  using TsdfBlocks::TsdfBlocks;
};
struct TsdfPart::Blocks : TsdfBlocks {
  using TsdfBlocks::TsdfBlocks;
};

TsdfVolume::TsdfVolume(const TsdfOptions& options) : blocks_(std::make_unique<Blocks>(options)) {}
TsdfVolume::~TsdfVolume() = default;
TsdfVolume::TsdfVolume(TsdfVolume&&) noexcept = default;

IntegrationReport TsdfVolume::integrate(const DepthImage& depth, const ColorImage& color,
                                        const MaskImage& is_dynamic, const CameraModel& camera,
                                        const Pose& T_base_camera, Parallelism parallelism) {
  return blocks_->integrate(depth, color, is_dynamic, camera, T_base_camera, parallelism);
}

TriangleMesh TsdfVolume::extract_mesh(double min_weight, Parallelism parallelism) const {
  return extract_mesh(SurfaceEvidence{min_weight, min_weight}, parallelism);
}

TriangleMesh TsdfVolume::extract_mesh(const SurfaceEvidence& evidence,
                                      Parallelism parallelism) const {
  return extract_surface(blocks_->map, blocks_->extraction(evidence), parallelism);
}

std::size_t TsdfVolume::block_count() const { return blocks_->map.size(); }
std::size_t TsdfVolume::memory_bytes() const {
  return blocks_->map.memory_bytes() + blocks_->past_views.memory_bytes() +
         blocks_->frame.memory_bytes();
}
const TsdfOptions& TsdfVolume::options() const { return blocks_->options; }

TsdfPart::TsdfPart(const TsdfOptions& options, const std::optional<BlockBox>& part)
    : blocks_(std::make_unique<Blocks>(options, part)) {}
TsdfPart::~TsdfPart() = default;
TsdfPart::TsdfPart(TsdfPart&&) noexcept = default;

IntegrationReport TsdfPart::integrate(const DepthImage& depth, const ColorImage& color,
                                      const MaskImage& is_dynamic, const CameraModel& camera,
                                      const Pose& T_base_camera, Parallelism parallelism) {
  return blocks_->integrate(depth, color, is_dynamic, camera, T_base_camera, parallelism);
}

void TsdfPart::integrate_unseen() {
  blocks_->past_views.add_unseen();
  ++blocks_->frames;
}

SurfaceTile TsdfPart::extract_tile(const SurfaceEvidence& evidence, Parallelism parallelism) const {
  return pcavr::extract_tile(blocks_->map, blocks_->extraction(evidence), blocks_->part,
                             parallelism);
}

std::size_t TsdfPart::block_count() const { return blocks_->map.size(); }

}  // namespace pcavr
