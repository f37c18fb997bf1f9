// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// An object with a CAD body as the recording declares it.
struct DeclaredBody {
  ObjectEntry entry;
  CadModel model;
  std::vector<TagPlacement> tags;
};

/// The bodies that carry one of these tags, by index.
[[nodiscard]] std::vector<std::size_t> bodies_with_tags(const std::vector<DeclaredBody>& bodies,
                                                        const std::set<MarkerId>& ids);

/// Reads the CAD body of every movable object. One without a mesh is an Error: the mesh
/// replaces the object's points.
[[nodiscard]] Expected<std::vector<DeclaredBody>> load_movable_bodies(const Recording& recording,
                                                                      const CadOptions& options);

/// Reads the CAD body of every immovable object whose pose the manifest states. One without a mesh
/// or a pose is part of the scan.
[[nodiscard]] Expected<std::vector<DeclaredBody>> load_immovable_bodies(const Recording& recording,
                                                                        const CadOptions& options);

/// Warns where a body's mesh is a simplification of a finer one, with its error bound.
void report_simplified(const CadModel& model, const Observer& observer);

/// The tags that a scene keeps: those of base and of the movable objects.
[[nodiscard]] std::vector<MarkerEntry> scene_tags(const Manifest& manifest);

}  // namespace pcavr
