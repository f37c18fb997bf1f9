// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/impact_moves.hpp"

#include <cmath>
#include <numbers>

#include "simulation/tool_program.hpp"

namespace pcavr::simulation {
namespace {

/// A light arm follows its command within this [Hz].
constexpr double kStrikerBandwidth = 15.0;
constexpr double kPressForce = 30.0;  // [N] at which the slow presses stop
constexpr double kSwing = 0.04;       // [m] of the tip above the surface before it swings
constexpr double kReleaseAt = 0.028;  // [m] of the swing: the tip lags behind its command by 4 mm
constexpr double kFlight = 0.09;      // [s] of free flight after the separation

struct Bounce {
  double duration = 0.0;  ///< of the unit impact: mass, stiffness and approach speed are 1
  double restitution = 0.0;
};

/// A unit mass on a contact of unit stiffness, by the plant's symplectic Euler steps.
Bounce unit_bounce(double exponent, double damping) {
  constexpr double kStep = 5e-4;
  constexpr int kMaxSteps = 2'000'000;
  double depth = 0.0, speed = 1.0;
  for (int i = 1; i < kMaxSteps; ++i) {
    const double force = std::pow(std::max(depth, 0.0), exponent) * (1.0 + damping * speed);
    speed -= kStep * std::max(force, 0.0);
    depth += kStep * speed;
    if (depth <= 0.0) return {i * kStep, -speed};
  }
  return {kMaxSteps * kStep, 0.0};
}

/// Damping of the unit impact with this restitution, which falls with the damping.
double unit_damping(double exponent, double restitution) {
  double low = 0.0, high = 1.0;
  while (unit_bounce(exponent, high).restitution > restitution) high *= 2.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (unit_bounce(exponent, middle).restitution > restitution ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void press_slowly(Program& program, std::size_t body, const Eigen::Vector3d& top, double speed) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  program.add({.body = body, .target = top + 0.006 * up, .speed = 0.1});
  program.wait(0.4);
  program.add({.body = body,
               .target = top - 0.006 * up,
               .speed = speed,
               .acceleration = 2.0,
               .until_force = kPressForce,
               .dwell = 0.25});
  program.add({.body = body, .target = top + 0.006 * up, .speed = 0.03});
}

void strike(Program& program, std::size_t body, const Eigen::Vector3d& top, double speed) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  program.add({.body = body, .target = top + kSwing * up, .speed = 0.2});
  program.wait(0.4);
  program.add({.body = body,
               .target = top - kSwing * up,
               .speed = speed,
               .acceleration = 5.0,
               .until_travelled = kReleaseAt,
               .blends_into_next = true});
  program.add({.release = kFlight});
}

}  // namespace

PlantTool striking_tool(const PlantTool& tool) {
  PlantTool striker = tool;
  const double rate = 2.0 * std::numbers::pi * kStrikerBandwidth;
  striker.bandwidth = kStrikerBandwidth;
  striker.stiffness = kStrikerMass * rate * rate;
  return striker;
}

void set_impact(double speed, double mass, double duration, double restitution,
                PlantParameters& parameters) {
  const double n = parameters.contact_exponent;
  const double unit = unit_damping(n, restitution);
  // The impact is computed in units of the length L = (m v^2 / k)^(1/(n+1)) and the time L / v.
  const double length = speed * duration / unit_bounce(n, unit).duration;
  parameters.contact_stiffness = mass * speed * speed / std::pow(length, n + 1.0);
  parameters.contact_damping = unit * parameters.contact_stiffness / speed;
}

void add_impact_moves(Program& program, double tip_radius) {
  for (std::size_t body = 0; body < 2; ++body) {
    const Eigen::Vector3d top(0.0, 0.0, half_extents_of(program.body(body)).z() + tip_radius);
    program.travel(body, top + 0.01 * Eigen::Vector3d::UnitZ());
    for (const double speed : {0.005, 0.015}) press_slowly(program, body, top, speed);
    for (const double share : {1.0, 0.7, 1.4, 0.85, 1.2}) {
      strike(program, body, top, share * kImpactSpeed);
    }
    program.lift();
  }
}

}  // namespace pcavr::simulation
