// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "pcavr/pipeline/identify.hpp"
#include "pcavr/pipeline/plan_motion.hpp"

#include "plan_path.hpp"

namespace pcavr {

/// Knowledge of one object: everything a plan is made from.
struct PlannedObject {
  const IdentifiableObject& object;
  const ObjectIdentification& found;
  std::vector<const Contact*> contacts;
};

/// Time [s] in which a planned push is loaded until breakaway: quasi-static.
inline constexpr double kLoadingTime = 1.0;

/// Extents of the object in base.
[[nodiscard]] Eigen::AlignedBox3d extents_of(const CadModel& model, const Pose& T_base_object);

/// The plan's presses: on top, an immovable object's where it was pressed. Notes where there is no
/// surface, and plans none then.
void append_presses(const PlannedObject& known, const Pose& T_base_object, ObjectPlan& plan,
                    PlanPath& path);

/// The plan's pushes from one side, and its slides from both in turn, so that the object stays
/// about where it is.
void append_pushes(const PlannedObject& known, const Pose& T_base_object, double tool_radius,
                   double arm_stiffness, ObjectPlan& plan, PlanPath& path);

}  // namespace pcavr
