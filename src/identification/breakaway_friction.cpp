// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "pcavr/core/check.hpp"
#include "pcavr/identification/breakaway.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

constexpr double kMaxPushStep = 5e-4;  // [s] of the simulated push
constexpr int kPushIterations = 30;
constexpr std::size_t kMinPushSamples = 20;
// Elastic displacement of the support at the limit of friction [Dahl 1968]: some micrometres for
// dry solids, with the std of its logarithm.
constexpr double kDisplacement = 5e-6;  // [m]
constexpr double kDisplacementFactor = 0.7;
constexpr double kUnknownStep = 0.02;  // of a unit unknown, for derivatives

/// PushUnknowns of one push, each in units of its prior's std about the prior's mean; the limit in
/// shares of the peak, the surface in noises of the tip.
enum PushUnknown { kLimit, kSurface, kStiffness, kDrop, kDropSpeed, kPresliding, kPushUnknowns };
using PushUnknowns = Eigen::Matrix<double, kPushUnknowns, 1>;
using PushNormal = Eigen::Matrix<double, kPushUnknowns, kPushUnknowns>;

/// What the unknowns stand for.
struct PushTrial {
  double limit = 0.0;       ///< [N]
  double surface = 0.0;     ///< [m]
  double stiffness = 1.0;   ///< factor of the contact law's
  double drop = 0.0;        ///< share of the limit that sliding lacks
  double speed = 0.0;       ///< [m/s] over which it drops
  double presliding = 0.0;  ///< [m] elastic displacement at the limit
};

/// A push from the touch to shortly after its peak.
struct PushWindow {
  std::vector<double> t, force, tool, tool_speed;
  double force_variance = 0.0;  ///< [N^2] of one sample
  double tool_variance = 0.0;   ///< [m^2] of one sample, before it was smoothed
};

PushWindow window_of(const ForceMotion& push, const Breakaway& breakaway,
                     const OnsetOptions& options) {
  PushWindow window;
  const double from = std::max(breakaway.t_contact, breakaway.t - options.loading_time);
  const double until = breakaway.t + options.sliding_time;
  const std::vector<double> force = remove_spikes(push.force).values;
  const double half_width = std::max(options.half_width, 3.0 * mean_interval(push.t));
  const std::vector<SmoothedSample> tool = smooth(push.t, push.tool, push.t, half_width);
  for (std::size_t i = 0; i < push.t.size(); ++i) {
    if (push.t[i] < from || push.t[i] > until || !tool[i].is_valid) continue;
    window.t.push_back(push.t[i]);
    window.force.push_back(force[i]);
    window.tool.push_back(tool[i].value);
    window.tool_speed.push_back(tool[i].rate);
  }
  const double noise = push.tool_noise ? *push.tool_noise : estimate_noise_std(push.tool);
  window.tool_variance = noise * noise;
  window.force_variance = std::pow(std::max(estimate_noise_std(force), 1e-4 * breakaway.force), 2);
  return window;
}

class PushProblem {
 public:
  PushProblem(const PushWindow& window, const Breakaway& breakaway, const HuntCrossley& contact_law,
              double mass, const OnsetOptions& options)
      : window_(window), peak_(breakaway.force), law_(contact_law), mass_(mass), options_(options) {
    const double depth = static_penetration(law_, window.force.front());
    surface_ = window.tool.front() - depth;
    depth_ = static_penetration(law_, peak_);
  }

  [[nodiscard]] PushTrial trial_of(const PushUnknowns& unknowns) const {
    return {peak_ * std::exp(options_.limit_share * unknowns[kLimit]),
            surface_ + 0.1 * depth_ * unknowns[kSurface],
            std::exp(options_.stiffness_share * unknowns[kStiffness]),
            options_.drop * std::exp(options_.drop_factor * unknowns[kDrop]),
            options_.drop_speed * std::exp(options_.drop_speed_factor * unknowns[kDropSpeed]),
            kDisplacement * std::exp(kDisplacementFactor * unknowns[kPresliding])};
  }

  /// Residuals over their stds: of the samples, then of the unknowns about their priors.
  [[nodiscard]] Eigen::VectorXd residuals(const PushUnknowns& unknowns) const {
    const PushTrial trial = trial_of(unknowns);
    HuntCrossley law = law_;
    law.stiffness *= trial.stiffness;
    law.damping *= trial.stiffness;
    const auto count = static_cast<Eigen::Index>(window_.t.size());
    Eigen::VectorXd result(count + kPushUnknowns);
    Body body;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (i > 0) advance(law, trial, i, body);
      const ContactForce force = contact_force(law, window_.tool[i] - trial.surface - body.position,
                                               window_.tool_speed[i] - body.speed);
      const double variance =
          window_.force_variance + std::pow(force.stiffness, 2) * window_.tool_variance;
      result[k] = (window_.force[i] - force.force) / std::sqrt(variance);
    }
    result.tail<kPushUnknowns>() = unknowns;
    return result;
  }

  [[nodiscard]] std::size_t samples() const { return window_.t.size(); }

 private:
  struct Body {
    double position = 0.0, speed = 0.0;  ///< [m], [m/s]
    double friction = 0.0;               ///< [N]
  };

  /// The object from sample i - 1 to i, by steps that are implicit in all stiffnesses. It moves
  /// forwards only: until shortly after the peak, the tip does, too.
  void advance(const HuntCrossley& law, const PushTrial& trial, std::size_t i, Body& body) const {
    const double interval = window_.t[i] - window_.t[i - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(interval / kMaxPushStep)));
    const double dt = interval / steps;
    const double elasticity = trial.limit / trial.presliding;
    for (int step = 0; step < steps; ++step) {
      const double share = (step + 0.5) / steps;
      const double tool = window_.tool[i - 1] + share * (window_.tool[i] - window_.tool[i - 1]);
      const double rate =
          window_.tool_speed[i - 1] + share * (window_.tool_speed[i] - window_.tool_speed[i - 1]);
      const ContactForce force =
          contact_force(law, tool - trial.surface - body.position, rate - body.speed);
      const double ratio = body.speed / trial.speed;
      const double slipping = trial.limit * (1.0 - trial.drop * (1.0 - std::exp(-ratio * ratio)));
      const double support = elasticity * std::max(0.0, 1.0 - body.friction / slipping);
      const double inertia = mass_ + dt * force.damping + dt * dt * (force.stiffness + support);
      body.speed = std::max(0.0, body.speed + dt * (force.force - body.friction) / inertia);
      body.position += dt * body.speed;
      const double moved = dt * body.speed * elasticity;
      body.friction = (body.friction + moved) / (1.0 + moved / slipping);
    }
  }

  const PushWindow& window_;
  double peak_;
  HuntCrossley law_;
  double mass_;
  const OnsetOptions& options_;
  double surface_ = 0.0;  ///< [m] by the first sample
  double depth_ = 0.0;    ///< [m] of the penetration at the peak
};

/// The normal equations by central differences; returns the sum of squares.
double linearise(const PushProblem& problem, const PushUnknowns& at, PushNormal& normal,
                 PushUnknowns& rhs) {
  const Eigen::VectorXd residuals = problem.residuals(at);
  Eigen::Matrix<double, Eigen::Dynamic, kPushUnknowns> by(residuals.size(), int{kPushUnknowns});
  for (int k = 0; k < kPushUnknowns; ++k) {
    const PushUnknowns step = kUnknownStep * PushUnknowns::Unit(k);
    by.col(k) =
        (problem.residuals(at + step) - problem.residuals(at - step)) / (2.0 * kUnknownStep);
  }
  normal = by.transpose() * by;
  rhs = -by.transpose() * residuals;
  return residuals.squaredNorm();
}

}  // namespace

IdentifiedParameter friction_at_breakaway(const ForceMotion& push, const Breakaway& breakaway,
                                          const HuntCrossley& contact_law, double mass,
                                          const OnsetOptions& options) {
  PCAVR_REQUIRE(mass > 0.0, mass);
  PCAVR_REQUIRE(options.half_width > 0.0 && options.loading_time > 0.0);
  IdentifiedParameter friction;
  if (!breakaway.is_found) return friction;
  const PushWindow window = window_of(push, breakaway, options);
  if (window.t.size() < kMinPushSamples) return friction;
  const PushProblem problem(window, breakaway, contact_law, mass, options);
  PushUnknowns unknowns = PushUnknowns::Zero(), rhs;
  PushNormal normal;
  double damping = 1e-2;
  double sum = linearise(problem, unknowns, normal, rhs);
  for (int i = 0; i < kPushIterations && damping < 1e6; ++i) {
    PushNormal damped = normal;
    damped.diagonal() *= 1.0 + damping;
    const PushUnknowns candidate = unknowns + damped.ldlt().solve(rhs);
    const double candidate_sum = problem.residuals(candidate).squaredNorm();
    if (!(candidate_sum < sum)) {
      damping *= 5.0;
      continue;
    }
    const bool is_done = sum - candidate_sum < 1e-4;
    unknowns = candidate;
    sum = linearise(problem, unknowns, normal, rhs);
    damping *= 0.2;
    if (is_done) break;
  }
  const double misfit = sum / static_cast<double>(problem.samples());
  if (!(misfit < options.max_misfit)) return friction;
  const PushNormal covariance = normal.ldlt().solve(PushNormal::Identity());
  friction.value = problem.trial_of(unknowns).limit;
  const double share = options.limit_share *
                       std::sqrt(std::max(covariance(kLimit, kLimit), 0.0) * std::max(misfit, 1.0));
  friction.std =
      std::hypot(friction.value * share, options.creep_share * (breakaway.force - friction.value));
  friction.is_excited = share < options.limit_share;
  return friction;
}

IdentifiedParameter limit_of_push(const ForceMotion& push, const Breakaway& breakaway,
                                  const HuntCrossley& contact_law, double mass,
                                  const OnsetOptions& options) {
  PCAVR_REQUIRE(mass > 0.0, mass);
  if (!breakaway.is_found) return {};
  const IdentifiedParameter limit =
      friction_at_breakaway(push, breakaway, contact_law, mass, options);
  if (limit.is_excited) return limit;
  const double excess = breakaway.stiffness > 0.0 ? std::max(0.0, breakaway.loading_rate) *
                                                        std::sqrt(mass / breakaway.stiffness)
                                                  : 0.0;
  return {breakaway.force - 0.5 * excess, std::hypot(breakaway.std, excess / std::sqrt(12.0)),
          true};
}

}  // namespace pcavr
