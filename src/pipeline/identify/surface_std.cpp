// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "surface_std.hpp"

#include <cmath>
#include <vector>

#include "pcavr/physics/identification/jackknife.hpp"
#include "pcavr/physics/turning/support.hpp"
#include "pcavr/physics/turning/turning.hpp"

namespace pcavr {
namespace {

using Coefficients = std::array<double, 15>;

/// The coefficients of the same surface in other scales of force and length.
Coefficients in_scales_of(const LimitSurface& scales, const LimitSurface& surface) {
  const double force = std::pow(scales.force / surface.force, 4);
  Coefficients coefficients = surface.coefficients;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const int of_moment = kQuarticExponents[i][2];
    coefficients[i] *= force * std::pow(scales.length / surface.length, of_moment);
  }
  return coefficients;
}

}  // namespace

std::optional<Coefficients> surface_std_of(const ObjectIdentification& found, const CadModel& model,
                                           const Pose& T_base_object,
                                           const LimitSurfaceFitOptions& options) {
  if (found.surface.status != LimitSurfaceFitStatus::fitted) return std::nullopt;
  std::vector<PushSample> samples = found.turning;
  std::optional<LimitSurface> prior;
  const Support even(model, T_base_object);
  if (found.friction_radius && even.radius() > 0.0) {
    const double radius = found.friction_radius->value;
    samples = of_even_pressure(std::move(samples), even.scaled(radius / even.radius()));
    prior = surface_of_support(model, T_base_object, radius);
  }
  std::array<std::vector<double>, 15> without;
  const std::size_t pushes = samples.empty() ? 0 : samples.back().push + 1;
  for (std::size_t group = 0; group < jackknife_groups(pushes); ++group) {
    std::vector<PushSample> others;
    for (const PushSample& sample : samples) {
      if (jackknife_group(sample.push, pushes) != group) others.push_back(sample);
    }
    const LimitSurfaceFit fit = fit_limit_surface(others, options, prior);
    // The surface rests on this group alone: how well is not shown.
    if (fit.status != LimitSurfaceFitStatus::fitted) return std::nullopt;
    const Coefficients coefficients = in_scales_of(found.surface.surface, fit.surface);
    for (std::size_t i = 0; i < without.size(); ++i) without[i].push_back(coefficients[i]);
  }
  if (without[0].size() < 2) return std::nullopt;
  Coefficients stds{};
  for (std::size_t i = 0; i < stds.size(); ++i) stds[i] = jackknife_std(without[i]);
  return stds;
}

}  // namespace pcavr
