// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

/// A model that the identification does NOT fit: LuGre friction with Stribeck effect [Canudas de
/// Wit et al. 1995] under a box that a tool touches through a Hunt-Crossley contact; 20 kHz.
struct Plant {
  double mass = 3.0;              ///< [kg]
  double coulomb = 8.4;           ///< [N]
  double breakaway = 9.57;        ///< [N] Stribeck peak
  double stribeck_speed = 0.002;  ///< [m/s]
  double viscous = 10.0;          ///< [N s/m]
  double bristle = 3e5;           ///< sigma0 [N/m]
  double stiffness = 20600.0;     ///< [N/m^n]
  double damping = 82400.0;       ///< [N s/m^(n+1)]
  double exponent = 1.5;
  bool is_fixed = false;  ///< pressed against the support: the box can't move
};

struct Sensors {
  double rate = 500.0;       ///< [1/s]
  double force_noise = 0.2;  ///< [N]
  double tool_noise = 2e-5;  ///< [m]
  double spike_share = 0.0;  ///< of samples
  double drift = 0.0;        ///< [N] amplitude, over 7 s
};

struct Trial {
  std::vector<double> t, tool, force;      ///< measured
  std::vector<double> true_force, object;  ///< noise-free, at the same instants
  double peak_before_slide = 0.0;          ///< [N] true force where it first stops rising
  double friction_peak = 0.0;              ///< [N] largest friction until then
  [[nodiscard]] ForceMotion series() const { return {t, tool, force}; }
};

/// `tool_path` gives the tip's coordinate [m] over time; the box's face is at 0.
inline Trial run(const Plant& plant, const Sensors& sensors, double duration, std::uint64_t seed,
                 const std::function<double(double)>& tool_path) {
  constexpr double kStep = 5e-5;
  Random random(seed);
  Trial trial;
  double x = 0.0, v = 0.0, z = 0.0, before = tool_path(0.0);
  bool has_slid = false;
  const double every = 1.0 / (sensors.rate * kStep);
  double next = 0.0;
  for (std::size_t i = 0; static_cast<double>(i) * kStep <= duration; ++i) {
    const double t = static_cast<double>(i) * kStep;
    const double tool = tool_path(t);
    const double depth = tool - x;
    const double rate = (tool - before) / kStep - v;
    before = tool;
    double contact = 0.0;
    if (depth > 0.0) {
      const double power = std::pow(depth, plant.exponent);
      contact = std::max(0.0, plant.stiffness * power + plant.damping * power * rate);
    }
    if (!plant.is_fixed) {
      const double ratio = v / plant.stribeck_speed;
      const double level =
          plant.coulomb + (plant.breakaway - plant.coulomb) * std::exp(-ratio * ratio);
      const double dz = v - plant.bristle * std::abs(v) / level * z;
      const double bristle_damping = 2.0 * std::sqrt(plant.bristle * plant.mass) * 0.5;
      const double fade =
          std::exp(-std::pow(v / 0.005, 2));  // else it would add to viscous friction
      const double friction = plant.bristle * z + bristle_damping * fade * dz + plant.viscous * v;
      if (x < 0.002) trial.friction_peak = std::max(trial.friction_peak, friction);
      v += kStep * (contact - friction) / plant.mass;
      x += kStep * v;
      z += kStep * dz;
    }
    // The box breaks loose when it first moves ahead of the tool; later peaks of stick-slip differ.
    has_slid = has_slid || (contact > 0.5 * plant.breakaway &&
                            contact < (1.0 - 1e-4) * trial.peak_before_slide);
    if (!has_slid) trial.peak_before_slide = std::max(trial.peak_before_slide, contact);
    if (static_cast<double>(i) < next) continue;
    next += every;
    double measured = contact + sensors.force_noise * random.normal();
    measured += sensors.drift * std::sin(2.0 * 3.14159265358979 * t / 7.0);
    if (random.uniform() < sensors.spike_share) measured += random.uniform(-1.0, 1.0) * 30.0;
    trial.t.push_back(t);
    trial.tool.push_back(tool + sensors.tool_noise * random.normal());
    trial.force.push_back(measured);
    trial.true_force.push_back(contact);
    trial.object.push_back(x);
  }
  return trial;
}

}  // namespace pcavr
