// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/geometry/mesh.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

/// A body that may stand on something: its surface and its pose in base.
struct StandingBody {
  std::string name;
  const TriangleMesh* mesh_object = nullptr;
  Pose T_base_object;
};

/// The planes that the bodies stand on: near-horizontal planes of the static mesh close to the
/// lower side of each body (RANSAC by PCL, then least squares on the inliers), merged where they
/// are one. Without bodies: the largest near-horizontal plane.
[[nodiscard]] std::vector<SupportPlane> find_support_planes(
    const TriangleMesh& mesh_base, const std::vector<StandingBody>& bodies);

}  // namespace pcavr
