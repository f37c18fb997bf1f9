// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/trajectory.hpp"

namespace pcavr {

enum class SideKind {
  truth,
  scene,
  run,
  tracking,    ///< a run's own, for its own prediction
  parameters,  ///< a parameter file
};

/// "truth", "scene", "run", "tracking" or "parameter file".
[[nodiscard]] std::string name_of(SideKind kind);

/// An object's poses in a scene at the start and at the end of its recording.
struct Placement {
  Pose T_base_object_start;
  std::optional<Pose> T_base_object_end;  ///< unknown where the manifest places the object
};

/// One side of a comparison; parts that its folder does not have are empty.
struct ComparisonSide {
  SideKind kind = SideKind::truth;
  std::filesystem::path folder;
  std::filesystem::path recording;              ///< its recording's folder; empty where not found
  Trajectory camera;                            ///< T_base_camera
  std::map<std::string, Trajectory> tracked;    ///< T_base_object: tracked, or true
  std::map<std::string, Trajectory> predicted;  ///< T_base_object that the operator saw
  std::map<std::string, Placement> placed;
  std::map<std::string, std::filesystem::path> object_meshes;  ///< in the folder itself
  std::optional<TriangleMesh> surface_base;                    ///< static
};

/// Reads a recording's truth folder, a scene or a run, as identified by scene.yaml, run.yaml, or a
/// truth folder's files. A file that exists but can't be read is an Error.
[[nodiscard]] Expected<ComparisonSide> read_side(const std::filesystem::path& folder);

/// The reference for a run's prediction without truth: its marker tracking, which is moved out of
/// the run. An Error where the run has no object both tracked and predicted.
[[nodiscard]] Expected<ComparisonSide> extract_tracking(ComparisonSide& run);

}  // namespace pcavr
