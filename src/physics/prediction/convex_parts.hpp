// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::detail {

/// Approximate convex decomposition of a body, in the frame T leads to: one hull where it is
/// convex; else cuts along planes of the mesh's axes, at its own vertices, until no surface lies
/// deeper under its hull than `tolerance` times the body's diagonal, or there are `max_parts`.
/// Concavities that no such plane opens stay filled. Empty where the mesh spans no volume.
[[nodiscard]] std::vector<std::unique_ptr<btConvexHullShape>> convex_parts(const TriangleMesh& mesh,
                                                                           const Pose& T_frame_mesh,
                                                                           double tolerance,
                                                                           std::size_t max_parts);

}  // namespace pcavr::detail
