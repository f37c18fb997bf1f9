// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/physics/inputs/input_monitor.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {

/// A sound recording of a probe with a tilted tool, whose axes differ from those of base and
/// object: presses and slow pushes.
inline IdentificationInput simulated_input(double duration) {
  IdentificationInput input = identified_case(ToolTask::probe, 2, duration).input;
  const Eigen::Quaterniond tilt(
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  for (Eigen::Quaterniond& q : input.q_base_tool) q = tilt * q;
  return input;
}

/// A view; `input` must outlive it.
inline InputSeries series_view(const IdentificationInput& input) {
  InputSeries series{.tool_radius = input.tool_radius,
                     .t_tool = input.t_tool,
                     .p_base_tip = input.p_base_tip,
                     .q_base_tool = input.q_base_tool,
                     .t_force = input.t_force,
                     .force_base = input.force_base};
  for (const IdentifiableObject& object : input.objects) {
    series.bodies.push_back(
        {object.name, &object.model, object.T_base_object, object.mass, object.tracked});
  }
  return series;
}

/// The same recording as input of a replay.
inline TeleopInput teleop_input_of(const IdentificationInput& input) {
  TeleopInput result;
  for (const IdentifiableObject& object : input.objects) {
    TeleopObject& added = result.objects.emplace_back(
        TeleopObject{object.name, object.model, object.T_base_object, {}, object.tracked});
    if (object.mass) added.parameters.mass = ParameterValue{*object.mass, {}};
  }
  result.tool_radius = input.tool_radius;
  result.t_tool = input.t_tool;
  result.p_base_tip = input.p_base_tip;
  result.q_base_tool = input.q_base_tool;
  result.t_force = input.t_force;
  result.force_base = input.force_base;
  return result;
}

}  // namespace pcavr
