// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "survey.hpp"

namespace pcavr {

/// A scene with a recording's tags and nothing else, for bodies without reconstructed surfaces.
[[nodiscard]] Scene empty_scene(const Recording& recording, double voxel_size,
                                const OccupancyOptions& occupancy);

/// A body as an object of the scene, at the pose that its manifest states.
[[nodiscard]] SceneObject scene_object_at_stated_pose(const DeclaredBody& body);

/// Adds a body at its stated pose to a scene without surfaces; where an immovable one is, the
/// occupancy map is occupied.
void add_at_stated_pose(const Manifest& manifest, const DeclaredBody& body, Scene& scene);

/// A body as an object of the scene, as it was tracked; at its stated pose, if any, where it was
/// not seen.
[[nodiscard]] SceneObject scene_object_of_track(const DeclaredBody& body,
                                                const std::vector<ObjectObservation>& track);

/// Sets the reason why the object was not seen, and warns.
void report_not_found(const Recording& recording, const Survey& survey, const DeclaredBody& body,
                      const BodyPoseOptions& options, const Observer& observer,
                      SceneObject& object);

/// Horizontal planes under the movable objects, which cover the tool's path.
[[nodiscard]] std::vector<SupportPlane> horizontal_planes(const std::vector<SceneObject>& objects,
                                                          const Trajectory& tool);

/// The scene of a recording without images, from its manifest alone: bodies at their stated poses,
/// with horizontal support planes under the movable ones. Fails where the manifest does not state a
/// movable object's pose, or a mesh can't be in metres.
[[nodiscard]] Expected<Scene> scene_from_manifest(const Recording& recording, double voxel_size,
                                                  const OccupancyOptions& occupancy,
                                                  const PerceptionOptions& perception);

}  // namespace pcavr
