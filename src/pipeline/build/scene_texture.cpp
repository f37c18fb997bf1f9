// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_texture.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/texture/mesh_texture.hpp"
#include "pcavr/perception/texture/unseen_support.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// Decodes the images that the selection has not kept. A frame that cannot be decoded any more is
/// left out: it was decoded before.
std::vector<TextureView> decode_views(const Recording& recording,
                                      std::vector<ViewCandidate> candidates,
                                      Parallelism parallelism) {
  std::vector<std::optional<TextureView>> decoded(candidates.size());
  parallel_for(parallelism, candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ViewCandidate& candidate = candidates[i];
      if (candidate.color.empty()) {
        Expected<RgbdFrame> frame = decode_frame(recording, candidate.frame);
        if (!frame) continue;
        candidate.color = std::move(frame->color);
        candidate.depth = std::move(frame->depth);
      }
      decoded[i] = TextureView{.color = std::move(candidate.color),
                               .depth = std::move(candidate.depth),
                               .is_dynamic = std::move(candidate.is_dynamic),
                               .T_base_camera = candidate.T_base_camera,
                               .sharpness = candidate.sharpness};
    }
  });
  std::vector<TextureView> views;
  for (std::optional<TextureView>& view : decoded) {
    if (view) views.push_back(std::move(*view));
  }
  return views;
}

std::optional<SceneTexture> texture_of(const std::vector<TextureView>& views,
                                       const CameraModel& camera, const BuildOptions& options,
                                       std::vector<TriangleMesh>& levels_base) {
  MeshTexture texture = paint_texture(levels_base, views, camera, options.perception.depth_noise,
                                      options.texture, options.parallelism);
  if (texture.empty()) return std::nullopt;
  Expected<std::string> jpeg = encode_color(texture.image, options.texture.jpeg_quality);
  if (!jpeg) return std::nullopt;
  return SceneTexture{.jpeg = std::move(*jpeg),
                      .coordinates = std::move(texture.coordinates),
                      .width = texture.image.width(),
                      .height = texture.image.height(),
                      .texel = texture.texel,
                      .views = texture.views,
                      .seen_fraction = texture.seen_fraction,
                      .color_camera = texture.registration.camera,
                      .T_color_depth = texture.registration.T_color_depth,
                      .vignetting = texture.registration.vignetting};
}

}  // namespace

void paint_scene(const Recording& recording, ViewSelection selection, const BuildOptions& options,
                 Scene& scene) {
  if (!options.texture.enabled) return;
  const CameraModel& camera = *recording.manifest.camera;
  const auto pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  // Colour; depth and the minimum around each pixel; the same of the surface, half as fine; mask
  // and distance from it.
  const std::size_t bytes_per_pixel = sizeof(Rgb8) + 2 * sizeof(float) + 2 * sizeof(float) / 4 + 2;
  const std::vector<TextureView> views =
      decode_views(recording, selection.take_chosen(pixels * bytes_per_pixel), options.parallelism);
  if (options.texture.fill_support) {
    std::vector<SupportArea> areas;
    for (const SupportPlane& plane : scene.support_planes) {
      areas.push_back({plane.plane_base, plane.outline_base});
    }
    scene.unseen_support_base = find_unseen_support(areas, scene.levels_of_detail_base.front(),
                                                    views, camera, options.fusion.voxel_size);
  }
  scene.texture = texture_of(views, camera, options, scene.levels_of_detail_base);
}

}  // namespace pcavr
