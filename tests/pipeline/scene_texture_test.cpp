// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/build/scene_texture.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

/// A picture of a level of detail with its texture; the nearest texel of each pixel.
GrayImage picture_of(const Scene& scene, std::size_t level, const ColorImage& atlas,
                     const CameraModel& camera, const Pose& T_base_camera) {
  const TriangleMesh& mesh = scene.levels_of_detail_base[level];
  const auto& uv = scene.texture->coordinates[level];
  const SurfaceQuery query(mesh);
  const Eigen::Array2f size(static_cast<float>(atlas.width()), static_cast<float>(atlas.height()));
  ColorImage picture(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = T_base_camera.rotation() * camera.unproject({x, y}, 1.0);
      const auto hit = query.cast(T_base_camera.translation().cast<float>(), ray.cast<float>());
      if (!hit) continue;
      const auto& [a, b, c] = mesh.triangles[hit->triangle];
      const Eigen::Vector2f at = (1.0F - hit->u - hit->v) * uv[a] + hit->u * uv[b] + hit->v * uv[c];
      const Eigen::Array2i texel = (at.array() * size).cast<int>();
      picture(x, y) = atlas(std::clamp(texel.x(), 0, atlas.width() - 1),
                            std::clamp(texel.y(), 0, atlas.height() - 1));
    }
  }
  return to_gray(picture);
}

std::size_t texels(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

TEST(SceneTexture, TheSceneAndAnyNumberOfBodiesShareOneBound) {
  for (const int bodies_edge : {0, 32, 512, 16384}) {
    for (const int atlas : {64, 1024}) {
      TextureOptions options;
      options.atlas_width = 2 * atlas;
      options.atlas_height = atlas;
      options.bodies_edge = bodies_edge;
      for (std::size_t bodies = 0; bodies < 300; ++bodies) {
        const TextureShares shares = texture_shares(bodies, options);
        EXPECT_GE(shares.scene_height, atlas / 2);
        EXPECT_EQ(shares.max_body_edge > 0, bodies > 0 && bodies_edge > 0);
        EXPECT_GE(shares.body_texels, texels(shares.max_body_edge, shares.max_body_edge));
        EXPECT_LE(shares.body_texels + texels(2 * atlas, shares.scene_height),
                  texels(2 * atlas, atlas));
      }
    }
  }
  EXPECT_EQ(texture_shares(0, {}).scene_height, 1024);
  EXPECT_EQ(texture_shares(2, {}).max_body_edge, 256);
  EXPECT_EQ(texture_shares(2, {}).scene_height, 960);
  EXPECT_EQ(texture_shares(300, {}).max_body_edge, 64);
  EXPECT_EQ(texture_shares(300, {}).scene_height, 896);
}

TEST(SceneTexture, ATagOfARecordingIsDecodedInTheCoarsestLevel) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  Recording recording = read_recording(shared_data("tabletop")).value();
  // A quarter of the frames, of all of the path.
  std::vector<FrameFiles> frames;
  for (std::size_t i = 0; i < recording.frames.size(); i += 4)
    frames.push_back(recording.frames[i]);
  recording.frames = frames;
  const Expected<Scene> scene = build_scene(recording, BuildOptions());
  ASSERT_TRUE(scene) << scene.error().to_string();
  ASSERT_TRUE(scene->texture);
  const std::size_t level = scene->levels_of_detail_base.size() - 1;
  EXPECT_LE(scene->levels_of_detail_base[level].triangles.size(), 20'000U);

  for (const SceneObject& object : scene->objects) {
    ASSERT_TRUE(object.texture) << object.model.name;
    EXPECT_GT(object.texture->seen_fraction, 0.3) << object.model.name;
    EXPECT_LE(object.texture->width, BuildOptions().texture.bodies_edge);
    EXPECT_EQ(object.texture->coordinates.size(), object.texture->mesh_object.vertices.size());
  }

  const SceneTexture& texture = *scene->texture;
  ImageDecoder decoder;
  const ColorImage atlas =
      decoder.color(texture.jpeg, {"texture", texture.width, texture.height}).value();
  const auto& markers = recording.manifest.markers;
  const auto marker = std::find_if(markers.begin(), markers.end(),
                                   [](const auto& m) { return m.role == MarkerRole::base; });
  ASSERT_NE(marker, markers.end());
  const Pose T_base_camera(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())),
                           marker->T_parent_marker.translation() + Eigen::Vector3d(0.0, 0.0, 0.4));
  TagDetector detector = TagDetector::create({marker->id.family}).value();
  const std::vector<TagDetection> found =
      detector.detect(picture_of(*scene, level, atlas, *recording.manifest.camera, T_base_camera));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().id, marker->id);
  EXPECT_EQ(found.front().hamming, 0);
}

}  // namespace
}  // namespace pcavr
