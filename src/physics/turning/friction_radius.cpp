// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/turning/friction_radius.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"
#include "pcavr/physics/identification/jackknife.hpp"

namespace pcavr {
namespace {

constexpr double kTurnLever = 0.05;  // [m] by which rotations are weighted
/// Minimum weighted rotation, as a share of the translation, of a twist that determines the radius.
constexpr double kMinRotationShare = 0.2;
constexpr double kUnpredicted = 0.5 * std::numbers::pi;  // [rad] where too few pushes are left
constexpr int kRadiusRounds = 3;        // of the radius by which viscous friction resists
constexpr std::size_t kMinTurning = 3;  // samples of such twists
/// Std of the radius, as a share, by the pressure's distribution, which no push shows in full:
/// where it differs by 60 % between patches a quarter of the support wide, radii are found so far
/// off.
constexpr double kPressureShare = 0.02;

/// Friction of a turning object by one model.
struct Turned {
  double radius = 0.0;  ///< [m]
  /// [rad] Angle between the twists of a sample, by the model and measured.
  std::function<double(const PushSample&)> angle;
};
/// A model of the friction in samples, beside a viscous friction [N s/m].
using FrictionModel =
    std::function<std::optional<Turned>(const std::vector<PushSample>&, double viscous)>;

double angle_by(const LimitSurface& surface, const PushSample& sample, double length) {
  return twist_angle(sliding_direction(surface, sample.wrench), sample.twist, length);
}

/// The CAD body's support; its size is free.
std::optional<Turned> turned_by_support(const Support& support, const LimitSurface& shape,
                                        const std::vector<PushSample>& samples, double viscous) {
  const std::optional<Support> found = scaled_to_pushes(support, samples, viscous);
  if (!found) return std::nullopt;
  LimitSurface surface = shape;
  surface.length *= found->radius() / support.radius();
  const double length = support.radius();
  return Turned{found->radius(), [found, surface, length, viscous](PushSample sample) {
                  LimitSurface moved = surface;
                  moved.length *= moved_radius_share(*found, sample.centre_of_pressure);
                  sample.wrench -= viscous_load(*found, sample, viscous);
                  return angle_by(moved, sample, length);
                }};
}

/// Maximum friction moment over maximum friction force [m].
double radius_of(const LimitSurface& surface) {
  const double force = 0.5 * (sliding_load(surface, {1.0, 0.0, 0.0}).x() +
                              sliding_load(surface, {0.0, 1.0, 0.0}).y());
  return sliding_load(surface, {0.0, 0.0, 1.0}).z() / force;
}

std::optional<LimitSurface> surface_of(const std::vector<PushSample>& samples,
                                       const LimitSurfaceFitOptions& options) {
  LimitSurfaceFit fit = fit_limit_surface(samples, options);
  if (fit.status == LimitSurfaceFitStatus::too_few_pushes) {
    LimitSurfaceFitOptions few = options;
    few.shape = SurfaceShape::ellipsoid;
    fit = fit_limit_surface(samples, few);
  }
  return fit.status == LimitSurfaceFitStatus::fitted ? std::optional(fit.surface) : std::nullopt;
}

/// The viscous friction is that of the support, scaled to the surface's radius.
std::optional<Turned> turned_by_surface(const LimitSurfaceFitOptions& options,
                                        const Support& support,
                                        const std::vector<PushSample>& samples, double viscous) {
  std::optional<LimitSurface> surface = surface_of(samples, options);
  Support found = support;
  for (int round = 0; viscous != 0.0 && surface && round < kRadiusRounds; ++round) {
    found = support.scaled(radius_of(*surface) / support.radius());
    surface = surface_of(without_viscous_load(samples, found, viscous), options);
  }
  if (!surface) return std::nullopt;
  const double length = support.radius();
  return Turned{radius_of(*surface), [surface, found, length, viscous](PushSample sample) {
                  sample.wrench -= viscous_load(found, sample, viscous);
                  return angle_by(*surface, sample, length);
                }};
}

/// A model without each group of pushes: those of one push share its contact point.
struct LeftOut {
  std::vector<double> radii;  ///< [m]
  double angles = 0.0;        ///< [rad] sum over all samples, by the model without them
};

std::optional<LeftOut> leave_out(const SamplesOfPushes& pushes, const FrictionModel& model,
                                 double viscous) {
  LeftOut result;
  const std::size_t groups = jackknife_groups(pushes.size());
  for (std::size_t group = 0; group < groups; ++group) {
    std::vector<PushSample> with, without;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      std::vector<PushSample>& into = jackknife_group(i, pushes.size()) == group ? with : without;
      into.insert(into.end(), pushes[i].begin(), pushes[i].end());
    }
    const std::optional<Turned> turned = model(without, viscous);
    if (turned) result.radii.push_back(turned->radius);
    for (const PushSample& sample : with) {
      result.angles += turned ? turned->angle(sample) : kUnpredicted;
    }
  }
  return result.radii.size() >= 2 ? std::optional(result) : std::nullopt;
}

/// [m] Change of the radius by one std of the viscous friction.
double viscous_std(const std::vector<PushSample>& samples, const FrictionModel& model,
                   double radius, const ParameterValue& viscous) {
  if (!(viscous.std.value_or(0.0) > 0.0)) return 0.0;
  const std::optional<Turned> changed = model(samples, viscous.value + *viscous.std);
  return changed ? std::abs(changed->radius - radius) : 0.0;
}

/// A model's radius, and how well the model without some pushes predicts those.
struct JudgedRadius {
  double radius = 0.0, std = 0.0;  ///< [m]
  double angles = 0.0;             ///< [rad] LeftOut
};

/// The radius of the model that predicts better. Its std contains the other model's radius, by the
/// share of the weights 1 / angles^2: where both predict about as well, either may be right.
std::optional<ParameterValue> best_of(const std::vector<JudgedRadius>& judged) {
  if (judged.empty()) return std::nullopt;
  const JudgedRadius& best = *std::min_element(
      judged.begin(), judged.end(),
      [](const JudgedRadius& a, const JudgedRadius& b) { return a.angles < b.angles; });
  double variance = best.std * best.std;
  for (const JudgedRadius& one : judged) {
    const double worse = best.angles > 0.0 ? one.angles / best.angles : 1.0;
    const double weight = 1.0 / (1.0 + worse * worse);
    variance += weight * std::pow(one.radius - best.radius, 2);
  }
  return ParameterValue{best.radius, std::sqrt(variance)};
}

/// Whether some samples turn the object clearly.
bool is_turned(const std::vector<PushSample>& samples) {
  std::size_t count = 0;
  for (const PushSample& sample : samples) {
    const double turn = kTurnLever * std::abs(sample.twist.z());
    count += turn >= kMinRotationShare * sample.twist.head<2>().norm();
  }
  return count >= kMinTurning;
}

}  // namespace

std::optional<ParameterValue> friction_radius_of(const SamplesOfPushes& pushes,
                                                 const Support& support, const LimitSurface& shape,
                                                 const ParameterValue& viscous,
                                                 const LimitSurfaceFitOptions& options) {
  const std::vector<PushSample> samples = joined(pushes);
  if (!is_turned(samples)) return std::nullopt;
  const FrictionModel models[] = {[&](const std::vector<PushSample>& some, double b) {
                                    return turned_by_support(support, shape, some, b);
                                  },
                                  [&](const std::vector<PushSample>& some, double b) {
                                    return turned_by_surface(options, support, some, b);
                                  }};
  std::vector<JudgedRadius> judged;
  for (const FrictionModel& model : models) {
    const std::optional<Turned> turned = model(samples, viscous.value);
    if (!turned) continue;
    const std::optional<LeftOut> left_out = leave_out(pushes, model, viscous.value);
    if (!left_out) continue;
    judged.push_back({turned->radius,
                      std::hypot(jackknife_std(left_out->radii), kPressureShare * turned->radius,
                                 viscous_std(samples, model, turned->radius, viscous)),
                      left_out->angles});
  }
  return best_of(judged);
}

double moved_radius_share(const Support& support, const Eigen::Vector2d& centre) {
  const std::vector<double> shares = support.pressure(centre);
  double radius = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    radius += shares[i] * (support.points()[i] - centre).norm();
  }
  return radius / support.radius();
}

}  // namespace pcavr
