// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "scene/scene_builder.hpp"

namespace pcavr {

inline constexpr int kSmallFrames = 5;

/// The frames of a_box_on_a_table(), gray, with a wall a metre away; optionally without images.
inline void write_small_recording(const std::filesystem::path& folder, bool has_images = true) {
  std::filesystem::create_directories(folder);
  Manifest manifest;
  if (has_images) manifest.camera = a_small_camera();
  if (has_images) manifest.depth_scale = 1000.0;
  manifest.objects = {{.name = "box",
                       .mesh = "objects/box.obj",
                       .mass = {},
                       .is_movable = true,
                       .T_base_object = Pose::from_translation({0.5, 0.1, 0.04})}};
  RecordingWriter writer(folder, manifest);
  ASSERT_TRUE(writer.write_object_mesh("objects/box.obj", a_box({0.1F, 0.2F, 0.08F})));
  for (int i = 0; has_images && i < kSmallFrames; ++i) {
    const Stamp stamp{i * 50'000'000LL};
    ASSERT_TRUE(writer.add_frame(stamp, ColorImage(160, 120, {90, 90, 90}), stamp,
                                 DepthImage(160, 120, 1.0F)));
  }
  ASSERT_TRUE(writer.finish());
}

/// The box's pose at each frame, in a run's format.
inline void write_small_tracking(const std::filesystem::path& folder) {
  Trajectory tracked;
  for (int i = 0; i < kSmallFrames; ++i) {
    tracked.append({i * 50'000'000LL}, Pose::from_translation({0.5 + 0.01 * i, 0.0, 0.04}));
  }
  std::filesystem::create_directories(folder / "objects/box");
  ASSERT_TRUE(write_file(folder / "objects/box/tracked.txt", format_trajectory(tracked)));
}

/// A recording, the scene that was built from it, and its tracking, in three folders.
inline void write_small_replay(const std::filesystem::path& folder) {
  write_small_recording(folder / "recording");
  std::filesystem::create_directories(folder / "scene");
  ASSERT_TRUE(write_scene(a_box_on_a_table(), folder / "scene", {1}));
  write_small_tracking(folder / "tracked");
}

}  // namespace pcavr
