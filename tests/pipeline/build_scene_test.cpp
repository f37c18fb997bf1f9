// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/build_scene.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

TEST(BuildScene, NeedsFrames) {
  Recording recording;
  recording.folder = "somewhere";
  const Expected<Scene> scene = build_scene(recording, {});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().file, "somewhere");
  EXPECT_FALSE(scene.error().hint.empty());
}

/// A recording without images that states the pose of a cube of 0.1 m.
Recording recording_without_images(const TemporaryFolder& folder) {
  constexpr const char* kCube =
      "v -0.05 -0.05 -0.05\nv 0.05 -0.05 -0.05\nv 0.05 0.05 -0.05\nv -0.05 0.05 -0.05\n"
      "v -0.05 -0.05 0.05\nv 0.05 -0.05 0.05\nv 0.05 0.05 0.05\nv -0.05 0.05 0.05\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_TRUE(write_file(folder.path() / "cube.obj", kCube));
  Recording recording;
  recording.folder = folder.path();
  recording.manifest.objects = {{.name = "cube",
                                 .mesh = "cube.obj",
                                 .mass = 2.0,
                                 .T_base_object = Pose::from_translation({0.4, 0.1, 0.15})},
                                {.name = "stand",
                                 .mesh = "cube.obj",
                                 .is_movable = false,
                                 .T_base_object = Pose::from_translation({0.4, 0.4, 0.05})}};
  recording.tool.append({0}, Pose::from_translation({0.9, 0.1, 0.2}));
  return recording;
}

TEST(BuildScene, WithoutImagesHoldsWhatTheManifestStates) {
  const TemporaryFolder folder;
  Observer observer;
  std::string warning;
  observer.warn = [&](std::string_view line) { warning = line; };
  const Expected<Scene> scene = build_scene(recording_without_images(folder), {}, observer);
  ASSERT_TRUE(scene) << scene.error().to_string();
  EXPECT_NE(warning.find("no images"), std::string::npos);
  ASSERT_EQ(scene->objects.size(), 2U);
  EXPECT_EQ(scene->objects[0].evidence, kByManifest);
  EXPECT_EQ(scene->objects[0].mass, 2.0);
  EXPECT_TRUE(scene->objects[0].is_movable);
  EXPECT_FALSE(scene->objects[1].is_movable);
  EXPECT_EQ(scene->objects[1].model.mesh_object.triangles.size(), 12U);
  EXPECT_TRUE(scene->mesh_base.triangles.empty()) << "nothing was scanned";
  ASSERT_EQ(scene->support_planes.size(), 1U);
  EXPECT_NEAR(scene->support_planes[0].plane_base.offset, 0.10, 1e-6);
  EXPECT_EQ(scene->support_planes[0].objects, std::vector<std::string>{"cube"});
  EXPECT_NEAR(scene->support_planes[0].outline_base[1].x(), 1.0, 1e-6);  // beyond the tool's path
}

TEST(BuildScene, WithoutImagesCanBeWrittenAndIsSound) {
  const TemporaryFolder folder;
  const Expected<Scene> scene = build_scene(recording_without_images(folder), {});
  ASSERT_TRUE(scene);
  const std::filesystem::path scene_folder = folder.path() / "scene";
  std::filesystem::create_directory(scene_folder);
  ASSERT_TRUE(write_scene(*scene, scene_folder, {1}));
  const auto checks = inspect_scene(scene_folder);
  ASSERT_TRUE(checks) << checks.error().to_string();
  for (const SceneCheck& check : *checks) EXPECT_TRUE(check.is_sound) << check.what << check.figure;
}

// ---- short recordings

TEST(SurfaceEvidence, NeedsFewerFramesInAShortRecording) {
  const BuildOptions options;
  EXPECT_EQ(surface_evidence(options, 5).min_uncontradicted_weight, 1.0);
  EXPECT_EQ(surface_evidence(options, 30).min_uncontradicted_weight, 1.0);
  EXPECT_EQ(surface_evidence(options, 31).min_uncontradicted_weight, 2.0);
  EXPECT_EQ(surface_evidence(options, 5000).min_uncontradicted_weight, 2.0);
  EXPECT_EQ(surface_evidence(options, 5).min_weight, 2.0) << "where a frame contradicts";
}

/// Two views of a wall at 1 m, 0.8 m wide each, the second one 0.4 m to the right.
Recording two_views_of_a_wall(const std::filesystem::path& folder) {
  Manifest manifest;
  manifest.camera =
      CameraModel{.width = 160, .height = 120, .fx = 200.0, .fy = 200.0, .cx = 79.5, .cy = 59.5};
  manifest.depth_scale = 1000.0;
  RecordingWriter writer(folder, manifest);
  Trajectory camera;
  for (int i = 0; i < 2; ++i) {
    const Stamp stamp{i * 50'000'000LL};
    EXPECT_TRUE(writer.add_frame(stamp, ColorImage(160, 120, {90, 90, 90}), stamp,
                                 DepthImage(160, 120, 1.0F)));
    camera.append(stamp, Pose::from_translation({0.4 * i, 0.0, 0.0}));
  }
  EXPECT_TRUE(writer.write_groundtruth(camera));
  EXPECT_TRUE(writer.finish());
  return read_recording(folder).value();
}

TEST(BuildScene, KeepsWhatOneViewOfFewSawUnlessNoViewsAgree) {
  const TemporaryFolder folder;
  const Recording recording = two_views_of_a_wall(folder.path());
  BuildOptions options(0.01);
  options.trust_poses = true;
  options.texture.enabled = false;
  const auto width = [&] {
    const Expected<Scene> scene = build_scene(recording, options);
    EXPECT_TRUE(scene) << scene.error().to_string();
    float min_x = 9.0F;
    float max_x = -9.0F;
    for (const Eigen::Vector3f& p : scene->mesh_base.vertices) {
      min_x = std::min(min_x, p.x());
      max_x = std::max(max_x, p.x());
    }
    return max_x - min_x;
  };
  EXPECT_NEAR(width(), 1.2F, 0.05F);
  options.frames_per_weight = 1.0;
  EXPECT_NEAR(width(), 0.4F, 0.05F);
  options.min_weight = 3.0;
  EXPECT_FALSE(build_scene(recording, options)) << "no three views agree";
}

TEST(BuildScene, WithoutImagesNeedsThePoseOfEveryMovableObject) {
  const TemporaryFolder folder;
  Recording recording = recording_without_images(folder);
  recording.manifest.objects[0].T_base_object.reset();
  const Expected<Scene> scene = build_scene(recording, {});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("cube"), std::string::npos);
}

TEST(BuildScene, NeedsACadBodyForEveryMovableObject) {
  Recording recording;
  recording.manifest.camera = CameraModel{.width = 8, .height = 8, .fx = 8.0, .fy = 8.0};
  recording.frames.resize(1);
  recording.manifest.objects = {{.name = "ghost", .mesh = {}}};
  const Expected<Scene> scene = build_scene(recording, {});
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().place.find("ghost"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
