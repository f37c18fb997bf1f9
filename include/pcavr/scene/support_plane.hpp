// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/geometry/mesh.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

/// A body that may rest on a support plane: its surface and its pose in base.
struct SupportedBody {
  std::string name;
  const TriangleMesh* mesh_object = nullptr;
  Pose T_base_object;
};

/// The support planes of the bodies: near-horizontal planes of the static mesh close to the lower
/// side of each body (RANSAC by PCL, then least squares on the inliers); bodies may share one.
/// Without bodies: the largest near-horizontal plane.
[[nodiscard]] std::vector<SupportPlane> find_support_planes(
    const TriangleMesh& mesh_base, const std::vector<SupportedBody>& bodies);

}  // namespace pcavr
