// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/teleop_input.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "pcavr/pipeline/scanned_surface.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "assemble_input.hpp"
#include "pipeline/build/scene_bodies.hpp"
#include "track_bodies.hpp"

namespace pcavr {
namespace {

/// Tracking in seconds from the recording's start. A double resolves seconds since 1970 to 0.2 us:
/// rounding to microseconds, the resolution of written stamps, restores the exact values.
std::vector<TrackedPose> tracked_from_start(std::vector<TrackedPose> tracked, Stamp start) {
  constexpr double kMicroseconds = 1e6;  // per second
  for (TrackedPose& pose : tracked) {
    pose.t = std::round((pose.t - start.seconds()) * kMicroseconds) / kMicroseconds;
  }
  return tracked;
}

/// Objects and static surface of a scene, without any series.
Expected<TeleopInput> world_of(const SceneManifest& scene, const std::vector<DeclaredBody>& bodies,
                               const ParameterTable& known) {
  TeleopInput input;
  for (const DeclaredBody& body : bodies) {
    input.objects.push_back({body.entry.name,
                             body.model,
                             *body.entry.T_base_object,
                             known.at(body.entry.name),
                             {},
                             body.entry.is_movable});
  }
  if (!scene.is_scanned()) return input;
  Expected<TriangleMesh> mesh = read_mesh(scene.folder / "mesh.ply");
  if (!mesh) return mesh.error();
  input.static_mesh_base = std::move(*mesh);
  for (const DeclaredBody& body : bodies) {
    if (body.entry.is_movable) continue;
    remove_surface_of(transformed(*body.entry.T_base_object, body.model.mesh_object),
                      input.static_mesh_base);
  }
  return input;
}

void add_wrench(const Recording& recording, TeleopInput& input) {
  const Stamp start = start_of(recording);
  input.t_force.reserve(recording.wrench.size());
  input.force_base.reserve(recording.wrench.size());
  for (const WrenchSample& sample : recording.wrench) {
    input.t_force.push_back(to_seconds(sample.stamp - start));
    input.force_base.push_back(sample.force);
  }
}

}  // namespace

void add_tool_motion(const Recording& recording, TeleopInput& input) {
  const Stamp start = start_of(recording);
  input.tool_radius = recording.manifest.tool_radius.value_or(input.tool_radius);
  input.t_tool.reserve(recording.tool.size());
  input.p_base_tip.reserve(recording.tool.size());
  input.q_base_tool.reserve(recording.tool.size());
  for (const TimedPose& tool : recording.tool.poses()) {
    input.t_tool.push_back(to_seconds(tool.stamp - start));
    input.p_base_tip.push_back(tool.pose.translation());
    input.q_base_tool.push_back(tool.pose.rotation());
  }
}

Expected<TeleopInput> assemble_teleop_input(const Recording& recording, const SceneManifest& scene,
                                            SceneBodies&& bodies, const Replay& replay) {
  const ParameterTable parameters = bodies.parameters;
  const std::vector<DeclaredBody> all = all_of(std::move(bodies));
  Expected<TeleopInput> input = world_of(scene, all, parameters);
  if (!input) return input.error();
  for (std::size_t i = 0; i < all.size(); ++i) {
    input->objects[i].tracked = tracked_from_start(replay.objects[i].tracked, start_of(recording));
  }
  add_tool_motion(recording, *input);
  add_wrench(recording, *input);
  return input;
}

Expected<TeleopInput> read_teleop_input(const Recording& recording, const SceneManifest& scene,
                                        const ReplayOptions& options, const Observer& observer) {
  Expected<SceneBodies> bodies = read_scene_bodies(recording, scene, options, observer);
  if (!bodies) return bodies.error();
  Expected<Replay> replay = track_bodies(recording, scene, bodies->movable, options, observer);
  if (!replay) return replay.error();
  add_immovable(bodies->immovable, *replay);
  return assemble_teleop_input(recording, scene, std::move(*bodies), *replay);
}

Expected<TeleopInput> read_teleop_world(const SceneManifest& scene, const ReplayOptions& options,
                                        const Observer& observer) {
  Expected<SceneBodies> bodies = read_scene_bodies(Recording(), scene, options, observer);
  if (!bodies) return bodies.error();
  const ParameterTable parameters = bodies->parameters;
  return world_of(scene, all_of(std::move(*bodies)), parameters);
}

}  // namespace pcavr
