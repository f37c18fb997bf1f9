// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Predictions against the plant of `simulation`: LuGre's friction on many patches and 20 kHz, so
// another model. The predictor gets its true parameters and the tip's true path, and no correction.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/simulation/plant_case.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

WorldBody body_of(const PlantBody& plant) {
  TriangleMesh mesh;
  for (const PlantCuboid& part : plant.parts) {
    test::add_box(mesh, part.centre - part.half_extents, part.centre + part.half_extents);
  }
  WorldBody body{make_cad_model(mesh, plant.name, "plant").value(), plant.T_base_object, {}};
  const PlantParameters& p = plant.parameters;
  ObjectParameters known;
  known.mass = {p.mass, {}};
  known.limiting_static_friction = {p.limiting_static_friction, {}};
  known.sliding_friction_coefficient = {p.sliding_friction_coefficient, {}};
  known.viscous_friction = {p.viscous_friction, {}};
  known.contact_stiffness = {p.contact_stiffness, {}};
  known.contact_damping = {p.contact_damping, {}};
  known.contact_exponent = {p.contact_exponent, {}};
  known.tool_friction_coefficient = {p.tool_friction_coefficient, {}};
  known.friction_radius = {friction_radius(plant.patches), {}};
  body.physics = complete_physics(known, body.model, body.T_base_object).physics;
  return body;
}

/// Errors while a body slides, over all bodies [m].
struct PathError {
  double rms = 0.0;
  double worst = 0.0;
};

PathError error_of(ToolTask task, std::uint64_t seed) {
  const PlantCase plant = make_plant_case(task, seed);
  const PlantRun run = run_plant(plant.bodies, plant.tool, plant.moves);
  WorldModel model;
  model.tool_radius = plant.tool.radius;
  for (const PlantBody& body : plant.bodies) model.bodies.push_back(body_of(body));
  PredictedWorld world = PredictedWorld::create(std::move(model)).value();
  PathError error;
  double count = 0.0;
  for (std::size_t i = 1; i < run.p_base_tip.size(); ++i) {
    world.step(run.p_base_tip[i - 1], run.p_base_tip[i], PlantRun::kStep);
    for (std::size_t body = 0; body < world.size(); ++body) {
      const PlantBodyState& truth = run.bodies[body][i];
      if (truth.twist.head<2>().norm() < 1e-3) continue;
      const double distance =
          (world.T_base_object(body).translation().head<2>() - truth.p_base).norm();
      error.rms += distance * distance;
      error.worst = std::max(error.worst, distance);
      ++count;
    }
  }
  error.rms = std::sqrt(error.rms / count);
  return error;
}

// The project's own accuracy requirement without correction: 0.5 and 2 mm.
TEST(AgainstThePlant, APushedBoxIsPredictedToHalfAMillimetre) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const PathError error = error_of(ToolTask::push, seed);
    EXPECT_LT(error.rms, 0.5e-3) << seed;
    EXPECT_LT(error.worst, 2e-3) << seed;
  }
}

// Rotation amplifies small errors: a minute with a dozen pushes, up to 40 degrees.
TEST(AgainstThePlant, ARotatedBoxIsPredictedToMillimetresThroughADozenPushes) {
  for (const std::uint64_t seed : {1, 3}) {
    const PathError error = error_of(ToolTask::turn, seed);
    EXPECT_LT(error.rms, 3e-3) << seed;
    EXPECT_LT(error.worst, 6e-3) << seed;
  }
}

// The tip is deeper in a soft box than its radius, and than it is from the side: 10 to 20 mm and 12
// to 20 degrees off where the tip presses on whichever face is closest.
TEST(AgainstThePlant, ASoftBoxIsPredictedWhereTheTipIsDeepBesideACorner) {
  for (const std::uint64_t seed : {1, 3, 4}) {
    const PathError error = error_of(ToolTask::corner, seed);
    EXPECT_LT(error.rms, 0.5e-3) << seed;
    EXPECT_LT(error.worst, 2e-3) << seed;
  }
}

}  // namespace
}  // namespace pcavr
