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

/// A part of a contact in which the tip slid along one flat face, as in a slot, an oblique hole or
/// a push beside the centre, at any speed.
struct RubbedPart {
  double coefficient = 0.0;   ///< force along the slip over that along the face's normal
  double slip_about_z = 0.0;  ///< [m] along the face, > 0: counter-clockwise about the object
  double rise = 0.0;          ///< [m] by which the tip came off the face as it is in the model
};
/// The parts of one contact of a tracked body; empty where the tip stuck or rolled. Threads: a pure
/// function.
[[nodiscard]] std::vector<RubbedPart> rubbed_parts(const Contact& contact, const BodyMotion& body,
                                                   const BodySurface& surface, const PathView& tip,
                                                   double tool_radius);

/// A tip that slides along a face keeps its distance. Where it comes off or goes into all faces of
/// a model in proportion to the slip, the tracked frame is turned against the model's about z, and
/// the force's parts along and across the faces are wrong by as much.
struct FaceTurn {
  double turn = 0.0;  ///< [rad]
  double std = 0.0;   ///< [rad]; 0: not known

  /// [rad] The std to be added to that of a face's direction: the turn where it is no chance.
  [[nodiscard]] double doubt() const;
};

/// The friction coefficient between tip and object, with its std.
struct ToolFriction {
  ParameterValue coefficient;
  int contacts = 0;  ///< in which the tip slid along a face
  FaceTurn turn = {};
};
/// The friction coefficient from the parts, given by contact; empty: too few, or the force does not
/// oppose the slip.
[[nodiscard]] std::optional<ToolFriction> tool_friction_of(
    std::span<const std::vector<RubbedPart>> contacts, std::span<const TrackedPose> tracked);

}  // namespace pcavr
