// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {

inline Stamp shifted(Stamp stamp, Stamp by) { return {stamp.nanoseconds + by.nanoseconds}; }

/// A recording without images of the first `duration` seconds of a task, and its tracking in
/// `tracked`, written into `folder`; the task begins at `start`.
inline Recording recorded_case(const std::filesystem::path& folder, ToolTask task,
                               std::uint64_t seed, double duration, Stamp start) {
  const PlantCase plant = make_plant_case(task, seed);
  PlantOptions options;
  options.max_duration = duration;
  const PlantRun run = run_plant(plant.bodies, plant.tool, plant.moves, options);
  Manifest manifest;
  manifest.tool_radius = plant.tool.radius;
  for (const PlantBody& body : plant.bodies) {
    manifest.objects.push_back({.name = body.name,
                                .mesh = "objects/" + body.name + ".obj",
                                .mass = body.parameters.mass,
                                .is_movable = true,
                                .T_base_object = body.T_base_object});
  }
  std::filesystem::create_directories(folder);
  RecordingWriter writer(folder, manifest);
  Trajectory tool;
  const Trajectory measured = measured_tool(run, seed);
  for (const TimedPose& timed : measured.poses()) {
    tool.append(shifted(timed.stamp, start), timed.pose);
  }
  std::vector<WrenchSample> wrench = measured_wrench(run, seed);
  for (WrenchSample& sample : wrench) sample.stamp = shifted(sample.stamp, start);
  EXPECT_TRUE(writer.write_tool(tool).has_value());
  EXPECT_TRUE(writer.write_wrench(wrench).has_value());
  for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
    const PlantBody& body = plant.bodies[i];
    EXPECT_TRUE(
        writer.write_object_mesh("objects/" + body.name + ".obj", model_of(body).mesh_object)
            .has_value());
    Trajectory tracked;
    for (const SimulatedMeasurement& seen : simulated_tracking(run, body, i, seed)) {
      if (seen.is_seen) tracked.append(shifted(seen.stamp, start), seen.T_base_object);
    }
    const std::filesystem::path tracked_folder = folder / "tracked/objects" / body.name;
    std::filesystem::create_directories(tracked_folder);
    EXPECT_TRUE(write_file(tracked_folder / "tracked.txt", format_trajectory(tracked)).has_value());
  }
  EXPECT_TRUE(writer.finish().has_value());
  Expected<Recording> recording = read_recording(folder);
  EXPECT_TRUE(recording.has_value()) << recording.error().to_string();
  return *recording;
}

}  // namespace pcavr
