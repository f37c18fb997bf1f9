// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/build_scene.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(BuildScene, WantsFrames) {
  Recording recording;
  recording.folder = "somewhere";
  const Expected<Scene> scene = build_scene(recording, {});
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().file, "somewhere");
  EXPECT_FALSE(scene.error().mend.empty());
}

TEST(BuildScene, WantsACadBodyForEveryMovableObject) {
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
