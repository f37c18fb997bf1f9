// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// A simulated push as input of the two sites, with the plant's ground truth.
struct PlantInput {
  PlantCase plant;
  PlantRun run;
  TeleopInput input;
};

inline CadModel box_model(const std::string& name, const Eigen::Vector3d& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(Eigen::Vector3d((i & 1) != 0 ? half.x() : -half.x(),
                                            (i & 2) != 0 ? half.y() : -half.y(),
                                            (i & 4) != 0 ? half.z() : -half.z())
                                .cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return make_cad_model(mesh, name, name).value();
}

inline ObjectParameters true_parameters(const PlantParameters& plant) {
  ObjectParameters known;
  known.mass = ParameterValue{plant.mass};
  known.limiting_static_friction = ParameterValue{plant.limiting_static_friction};
  known.sliding_friction_coefficient = ParameterValue{plant.sliding_friction_coefficient};
  known.viscous_friction = ParameterValue{plant.viscous_friction};
  known.contact_stiffness = ParameterValue{plant.contact_stiffness};
  known.contact_damping = ParameterValue{plant.contact_damping};
  known.contact_exponent = ParameterValue{plant.contact_exponent};
  return known;
}

/// Both boxes of a push, or of another task; `known`: the sites have the plant's parameters, else
/// the mass only.
inline PlantInput plant_input(std::uint64_t seed, bool known, const SensorFaults& faults = {},
                              ToolTask task = ToolTask::push) {
  PlantInput made{make_plant_case(task, seed), {}, {}};
  made.run = run_plant(made.plant.bodies, made.plant.tool, made.plant.moves);
  for (std::size_t i = 0; i < made.plant.bodies.size(); ++i) {
    const PlantBody& body = made.plant.bodies[i];
    TeleopObject object{body.name,
                        box_model(body.name, body.parts.front().half_extents),
                        body.T_base_object,
                        {},
                        {}};
    if (known) object.parameters = true_parameters(body.parameters);
    object.parameters.mass = ParameterValue{body.parameters.mass};
    for (const SimulatedMeasurement& seen :
         simulated_tracking(made.run, body, i, seed + 10 + i, faults)) {
      if (!seen.is_seen) continue;
      object.tracked.push_back(
          {seen.stamp.seconds(), seen.T_base_object, seen.position_std, seen.rotation_std});
    }
    made.input.objects.push_back(std::move(object));
  }
  made.input.tool_radius = made.plant.tool.radius;
  const Trajectory tool_poses = measured_tool(made.run, seed + 1);
  for (const TimedPose& tool : tool_poses.poses()) {
    made.input.t_tool.push_back(tool.stamp.seconds());
    made.input.p_base_tip.push_back(tool.pose.translation());
  }
  for (const WrenchSample& sample : measured_wrench(made.run, seed + 2, faults)) {
    made.input.t_force.push_back(sample.stamp.seconds());
    made.input.force_base.push_back(sample.force);
  }
  return made;
}

/// [m] Errors of the shown poses while the plant's body was touched or moved, sorted.
inline std::vector<double> position_errors(const PlantInput& made, const TeleopRun& run,
                                           std::size_t object, double from = 0.0) {
  std::vector<double> errors;
  std::size_t next = 0;
  PlantPhase phase = PlantPhase::free;
  for (const ShownPose& shown : run.shown[object]) {
    for (; next < made.run.phases.size() && made.run.phases[next].t <= shown.t; ++next) {
      if (made.run.phases[next].body == object) phase = made.run.phases[next].phase;
    }
    if (phase == PlantPhase::free || shown.t < from) continue;
    const Pose truth = T_base_object_at(made.run, made.plant.bodies[object], object, shown.t);
    errors.push_back(translation_distance(truth, shown.T_base_object));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

inline bool has_note(const TeleopRun& run, const std::string& part) {
  return std::any_of(run.notes.begin(), run.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace pcavr
