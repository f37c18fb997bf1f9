// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/trajectory.hpp"

#include "force_errors.hpp"

namespace pcavr {

/// Data by which contacts are classified.
struct ContactTaskInput {
  const Trajectory& T_base_tool;              ///< of the tip; may be empty
  const PhaseTimeline& phases;                ///< the object's; may be empty
  const Trajectory* T_base_object = nullptr;  ///< may be null, as may be
  const TriangleMesh* closed_mesh_object = nullptr;
};

/// Slotting: at the peak the tip's centre is in a hole or slot of the object, that is inside its
/// convex hull and outside of its closed mesh. Press: the tip comes within 30 degrees of straight
/// down, and the object does not slide. Push: any other. Unknown without the tool's motion.
[[nodiscard]] ContactTask task_of(const ContactPeak& contact, const ContactTaskInput& motion,
                                  const ForceErrorOptions& options = {});

}  // namespace pcavr
