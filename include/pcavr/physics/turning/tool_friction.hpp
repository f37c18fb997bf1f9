// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/input_series.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/turning/body_motion.hpp"

namespace pcavr {

/// Friction coefficients between tip and object over parts of a contact in which the tip slid along
/// one flat face, as in a slot, an oblique hole or a push beside the centre, at any speed: the
/// force along the slip over that along the face's normal. Needs tracking.
[[nodiscard]] std::vector<double> tool_friction_samples(const Contact& contact,
                                                        const BodyMotion& body,
                                                        const BodySurface& surface,
                                                        const PathView& tip, double tool_radius);

struct ToolFriction {
  ParameterValue coefficient;
  int contacts = 0;  ///< in which the tip slid along a face
};
/// The friction coefficient from the samples, given by contact; empty: too few samples, or the
/// force does not oppose the slip.
[[nodiscard]] std::optional<ToolFriction> tool_friction_of(
    std::span<const std::vector<double>> contacts, std::span<const TrackedPose> tracked);

}  // namespace pcavr
