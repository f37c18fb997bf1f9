// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/mujoco_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcavr::detail {
namespace {

constexpr double kMinDepth = 0.25, kMaxDepth = 1.5;  // of the fit, over the working depth
constexpr int kDepths = 11;

/// d(r) [MuJoCo's documentation, "Solver parameters"].
double impedance(const std::array<double, 5>& solimp, double depth) {
  const auto [min, max, width, midpoint, power] = solimp;
  const double x = std::min(depth / width, 1.0);
  double y = x;
  if (power > 1.0) {
    y = x <= midpoint ? std::pow(x, power) / std::pow(midpoint, power - 1.0)
                      : 1.0 - std::pow(1.0 - x, power) / std::pow(1.0 - midpoint, power - 1.0);
  }
  return min + y * (max - min);
}

/// The scales of solref that are exact at the depth.
void match_at(const HuntCrossley& law, double depth, double weight, MujocoContact& contact) {
  contact.solref = {-1.0, -1.0};
  contact.solref[0] = -elastic_force(law, depth) / mujoco_force(contact, depth, weight);
  const double d = impedance(contact.solimp, depth);
  contact.solref[1] = -contact_damping(law, depth) * contact.solimp[1] * (1.0 - d) * weight / d;
}

}  // namespace

double mujoco_force(const MujocoContact& contact, double depth, double weight) {
  const double d = impedance(contact.solimp, depth);
  const double max = contact.solimp[1];
  return -contact.solref[0] * d * d / (max * max * (1.0 - d) * weight) * depth;
}

MujocoContact linear_contact(double stiffness, double damping, double weight, double impedance) {
  const double scale = (1.0 - impedance) * weight;
  return {.solref = {-stiffness * scale, -damping * scale},
          .solimp = {impedance, impedance, 0.001, 0.5, 2.0}};
}

double error_of(const MujocoContact& contact, const HuntCrossley& law, double working_force,
                double weight) {
  const double depth = static_penetration(law, working_force);
  double error = 0.0;
  for (int i = 0; i < kDepths; ++i) {
    const double r = depth * (kMinDepth + (kMaxDepth - kMinDepth) * i / (kDepths - 1));
    const double relative = mujoco_force(contact, r, weight) / elastic_force(law, r) - 1.0;
    error = std::max(error, std::abs(relative));
  }
  return error;
}

MujocoContact fit_mujoco_contact(const HuntCrossley& law, double working_force, double weight) {
  if (law.exponent == 1.0) {
    return linear_contact(law.stiffness, law.damping, weight, kContactImpedance);
  }
  const double depth = static_penetration(law, working_force);
  MujocoContact best;
  double min_error = std::numeric_limits<double>::infinity();
  // A grid, because the error has several minima; its cells change the force by about 1 %.
  for (const double max : {0.5 * kContactImpedance, kContactImpedance}) {
    for (int i = 1; i <= 16; ++i) {
      for (const double power : {1.0, 1.5, 2.0, 3.0, 4.0}) {
        for (const double midpoint : {0.02, 0.05, 0.1, 0.2, 0.4, 0.6}) {
          for (const double width : {1.5, 2.0, 4.0}) {
            MujocoContact contact{.solref = {},
                                  .solimp = {max * i / 17.0, max, width * depth, midpoint, power}};
            match_at(law, depth, weight, contact);
            const double error = error_of(contact, law, working_force, weight);
            if (error >= min_error) continue;
            min_error = error;
            best = contact;
          }
        }
      }
    }
  }
  return best;
}

}  // namespace pcavr::detail
