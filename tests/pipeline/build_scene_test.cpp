// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/build_scene.hpp"

#include <gtest/gtest.h>

#include "pcavr/core/output.hpp"
#include "pcavr/scene/scene_bundle.hpp"

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
