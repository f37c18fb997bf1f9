// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pcavr/physics/identification/path_view.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// [N] The force while the tip is far from every body: that of a sensor that was not set to zero.
/// Nothing where the tip is never far, where the force varies there, or is small. A push against a
/// large bias leaves less force than there is without contact, so that the force alone does not
/// show which of both is free motion.
[[nodiscard]] std::optional<Eigen::Vector3d> free_force(const InputSeries& series,
                                                        const PathView& tip,
                                                        const BodyPoses& poses);

}  // namespace pcavr
