// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_texture.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/object_colors.hpp"
#include "pcavr/perception/texture/mesh_texture.hpp"
#include "pcavr/perception/texture/unseen_support.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace {

/// A share of the texels below which a body is drawn without texture: a few pixels at an edge.
constexpr double kMinSeenFraction = 0.02;

/// The views that could be decoded, and their stamps.
struct SceneViews {
  std::vector<TextureView> views;
  std::vector<Stamp> stamps;
};

/// Decodes the images that the selection has not kept. A frame that cannot be decoded any more is
/// left out: it was decoded before.
SceneViews decode_views(const Recording& recording, std::vector<ViewCandidate> candidates,
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
  SceneViews result;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    if (!decoded[i]) continue;
    result.views.push_back(std::move(*decoded[i]));
    result.stamps.push_back(candidates[i].stamp);
  }
  return result;
}

std::optional<SceneTexture> scene_texture_of(MeshTexture& texture, const BuildOptions& options) {
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

/// The object's pose at the stamp of a frame; nullopt where it was not seen in it. An object
/// without track stands still.
std::optional<Pose> pose_at(Stamp stamp, const SceneObject& object, const ObjectTrack* track) {
  if (track == nullptr) return object.T_base_object;
  const auto found =
      std::lower_bound(track->begin(), track->end(), stamp,
                       [](const ObjectObservation& seen, Stamp at) { return seen.stamp < at; });
  if (found == track->end() || found->stamp != stamp || found->evidence == ObjectEvidence::none)
    return std::nullopt;
  return found->T_base_object;
}

/// `color` is that of what no view sees, unless the CAD file has colours.
std::optional<BodyTexture> body_texture_of(const SceneObject& object, const ObjectTrack* track,
                                           const Rgb8& color, const SceneViews& views,
                                           const MeshTexture& scene, int max_edge,
                                           const BuildOptions& options) {
  std::vector<BodyView> seen_in;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const std::optional<Pose> T_base_object = pose_at(views.stamps[i], object, track);
    if (!T_base_object) continue;
    seen_in.push_back({i, T_base_object->inverse() * views.views[i].T_base_camera});
  }
  TriangleMesh mesh = with_sharp_edges(object.model.mesh_object);
  if (mesh.colors.empty()) mesh.colors.assign(mesh.vertices.size(), color);
  MeshTexture texture =
      paint_body(mesh, views.views, seen_in, scene, max_edge, options.perception.depth_noise,
                 options.texture, options.parallelism);
  if (texture.empty() || texture.seen_fraction < kMinSeenFraction) return std::nullopt;
  Expected<std::string> jpeg = encode_color(texture.image, options.texture.jpeg_quality);
  if (!jpeg) return std::nullopt;
  return BodyTexture{.jpeg = std::move(*jpeg),
                     .mesh_object = std::move(mesh),
                     .coordinates = std::move(texture.coordinates.front()),
                     .width = texture.image.width(),
                     .height = texture.image.height(),
                     .texel = texture.texel,
                     .views = texture.views,
                     .seen_fraction = texture.seen_fraction};
}

void paint_bodies(const SceneViews& views, const MeshTexture& texture,
                  const std::vector<ObjectTrack>& tracks, const TextureShares& shares,
                  const BuildOptions& options, Scene& scene) {
  if (shares.max_body_edge == 0 || views.views.empty()) return;
  const std::vector<Rgb8> colors = object_colors(scene);
  std::size_t left = shares.body_texels;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto edge = static_cast<std::size_t>(shares.max_body_edge);
    if (left < edge * edge) return;
    SceneObject& object = scene.objects[i];
    if (object.evidence == kNotSeen) continue;
    object.texture = body_texture_of(object, i < tracks.size() ? &tracks[i] : nullptr, colors[i],
                                     views, texture, shares.max_body_edge, options);
    if (!object.texture) continue;
    left -= static_cast<std::size_t>(object.texture->width) *
            static_cast<std::size_t>(object.texture->height);
  }
}

}  // namespace

TextureShares texture_shares(std::size_t bodies, const TextureOptions& options) {
  constexpr int kMinEdge = 64;   // [px] less shows nothing
  constexpr int kSizeStep = 16;  // [px] of textures
  TextureShares shares{.scene_height = options.atlas_height};
  const int max_edge =
      std::min({options.bodies_edge, options.atlas_width, options.atlas_height / 2});
  if (bodies == 0 || max_edge == 0) return shares;
  int side = 1;
  while (static_cast<std::size_t>(side) * static_cast<std::size_t>(side) < bodies) side *= 2;
  const int edge = std::max(std::min(kMinEdge, max_edge), max_edge / side);
  const auto texels = [](int width) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(width);
  };
  shares.body_texels = std::min(bodies * texels(edge), texels(max_edge));
  shares.max_body_edge = edge;
  const auto width = static_cast<std::size_t>(options.atlas_width);
  const auto rows = static_cast<int>((shares.body_texels + width - 1) / width);
  shares.scene_height -= (rows + kSizeStep - 1) / kSizeStep * kSizeStep;
  return shares;
}

void paint_scene(const Recording& recording, ViewSelection selection,
                 const std::vector<ObjectTrack>& tracks, const BuildOptions& options,
                 Scene& scene) {
  if (!options.texture.enabled) return;
  const CameraModel& camera = *recording.manifest.camera;
  const auto pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  // Colour; depth and the minimum around each pixel; the same of the surface, half as fine; mask
  // and distance from it.
  const std::size_t bytes_per_pixel = sizeof(Rgb8) + 2 * sizeof(float) + 2 * sizeof(float) / 4 + 2;
  const SceneViews views =
      decode_views(recording, selection.take_chosen(pixels * bytes_per_pixel), options.parallelism);
  if (options.texture.fill_support) {
    std::vector<SupportArea> areas;
    for (const SupportPlane& plane : scene.support_planes) {
      areas.push_back({plane.plane_base, plane.outline_base});
    }
    scene.unseen_support_base = find_unseen_support(areas, scene.levels_of_detail_base.front(),
                                                    views.views, camera, options.fusion.voxel_size);
  }
  const auto seen = std::count_if(scene.objects.begin(), scene.objects.end(),
                                  [](const SceneObject& one) { return one.evidence != kNotSeen; });
  const TextureShares shares = texture_shares(static_cast<std::size_t>(seen), options.texture);
  TextureOptions scene_options = options.texture;
  scene_options.atlas_height = shares.scene_height;
  MeshTexture texture =
      paint_texture(scene.levels_of_detail_base, views.views, camera,
                    options.perception.depth_noise, scene_options, options.parallelism);
  paint_bodies(views, texture, tracks, shares, options, scene);
  scene.texture = scene_texture_of(texture, options);
}

}  // namespace pcavr
