// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/pipeline/identify.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"

namespace pcavr {

/// A plant's run and its simulated sensor data, without any file.
struct IdentifiedCase {
  PlantCase plant;
  IdentificationInput input;
  std::vector<PlantImpact> impacts = {};  ///< the truth
};

/// Adds a hexahedron; `corner_at` takes which side of x, y and z.
template <typename CornerAt>
void add_hexahedron(const CornerAt& corner_at, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p = corner_at(corner & 1U, corner >> 1U & 1U, corner >> 2U & 1U);
    mesh.vertices.push_back(p.cast<float>());
  }
  constexpr std::uint32_t kFaces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                           {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                           {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const auto& [a, b, c] : kFaces) mesh.triangles.push_back({first + a, first + b, first + c});
}

inline CadModel model_of(const PlantBody& body) {
  TriangleMesh mesh;
  for (const PlantCuboid& part : body.parts) {
    add_hexahedron(
        [&](unsigned x, unsigned y, unsigned z) -> Eigen::Vector3d {
          const Eigen::Vector3d side = 2.0 * Eigen::Vector3d(x, y, z) - Eigen::Vector3d::Ones();
          return part.centre + side.cwiseProduct(part.half_extents);
        },
        mesh);
  }
  for (const PlantPrism& prism : body.prisms) {  // four corners, from the lower left one
    add_hexahedron(
        [&](unsigned x, unsigned y, unsigned z) -> Eigen::Vector3d {
          const Eigen::Vector2d& xz = prism.outline_xz[z == 0 ? x : 3 - x];
          return {xz.x(), y == 0 ? prism.begin_y : prism.end_y, xz.y()};
        },
        mesh);
  }
  return make_cad_model(mesh, body.name, "test").value();
}

/// The first `duration` seconds of a task, with the marker tracking of a recording without images.
/// `noise_seed`: of the sensors; that of the plant by default.
inline IdentifiedCase identified_case(ToolTask task, std::uint64_t seed, double duration,
                                      const SensorFaults& faults = {},
                                      std::optional<std::uint64_t> noise_seed = {}) {
  IdentifiedCase made{make_plant_case(task, seed), {}, {}};
  const std::uint64_t sensors = noise_seed.value_or(seed);
  PlantOptions options{.substeps = made.plant.substeps};
  options.max_duration = duration;
  const PlantRun run = run_plant(made.plant.bodies, made.plant.tool, made.plant.moves, options);
  made.impacts = run.impacts;
  IdentificationInput& input = made.input;
  const Trajectory tool = measured_tool(run, sensors);
  for (const auto& [stamp, pose] : tool.poses()) {
    input.t_tool.push_back(stamp.seconds());
    input.p_base_tip.push_back(pose.translation());
    input.q_base_tool.push_back(pose.rotation());
  }
  for (const WrenchSample& sample : measured_wrench(run, sensors, faults)) {
    input.t_force.push_back(sample.stamp.seconds());
    input.force_base.push_back(sample.force);
  }
  input.tool_radius = made.plant.tool.radius;
  for (std::size_t i = 0; i < made.plant.bodies.size(); ++i) {
    const PlantBody& body = made.plant.bodies[i];
    IdentifiableObject object{
        body.name, model_of(body), body.T_base_object, body.parameters.mass, {}};
    for (const SimulatedMeasurement& seen : simulated_tracking(run, body, i, sensors, faults)) {
      if (!seen.is_seen) continue;
      object.tracked.push_back(
          {seen.stamp.seconds(), seen.T_base_object, seen.position_std, seen.rotation_std});
    }
    input.objects.push_back(std::move(object));
  }
  return made;
}

}  // namespace pcavr
