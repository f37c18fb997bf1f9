// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/impact_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// Smallest speed of an impact [m/s]: below, a tap is none, and its restitution would be noise.
constexpr double kMinApproach = 0.02;
/// Change of the tool's speed in its stds, which a spike of the force does not cause.
constexpr double kMinChangeStds = 6.0;
/// The pulse's slow ends are below its threshold: the force counts from its own duration, within
/// these limits, before it until after it.
constexpr double kMinEnd = 0.004;         // [s] two samples at 500 Hz
constexpr double kMaxEnd = 0.025;         // [s]
constexpr double kMergeGap = 0.006;       // [s] between pulses that noise has split
constexpr std::size_t kMinPoints = 8;     // of the path, on either side
constexpr int kMaxHalvings = 3;           // of the free flight, where the servo drives the tool
constexpr double kMaxFlightMisfit = 1.5;  // rms residual over the tip's noise of a free flight
/// Residual of a smooth path over that of the impact's, which distinguishes it from a spike of the
/// force.
constexpr double kMinCubicRatio = 1.4;

/// The force along a direction, from before the tool touches until after it separates.
struct PulseForce {
  std::vector<double> t, force;  ///< [s], [N]

  PulseForce(std::span<const double> all, std::span<const Eigen::Vector3d> force_base,
             const Eigen::Vector3d& direction, double from, double to) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i] < from || all[i] > to) continue;
      t.push_back(all[i]);
      force.push_back(force_base[i].dot(direction));
    }
  }
  /// [N s], by the trapezoidal rule.
  [[nodiscard]] double impulse() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < t.size(); ++i) {
      sum += 0.5 * (t[i] - t[i - 1]) * (force[i] + force[i - 1]);
    }
    return sum;
  }
};

/// Std of the force's distribution over time.
double width_of(const PulseForce& force) {
  double sum = 0.0, first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < force.t.size(); ++i) sum += force.force[i];
  for (std::size_t i = 0; i < force.t.size(); ++i) first += force.force[i] / sum * force.t[i];
  for (std::size_t i = 0; i < force.t.size(); ++i) {
    second += force.force[i] / sum * std::pow(force.t[i] - first, 2);
  }
  return std::sqrt(std::max(second, 0.0));
}

/// The tip's path along the direction before and after a pulse.
struct FlightSamples {
  std::vector<double> t, path;
  std::size_t before = 0, after = 0;
  double noise = 0.0;  ///< [m] std of one sample

  FlightSamples(const PulseForce& force, const PathView& tip, const Eigen::Vector3d& direction,
                double from, double to) {
    const auto end = std::upper_bound(tip.t().begin(), tip.t().end(), to);
    for (auto at = std::lower_bound(tip.t().begin(), end, from); at != end; ++at) {
      const bool is_before = *at < force.t.front();
      if (!is_before && *at <= force.t.back()) continue;
      (is_before ? before : after) += 1;
      t.push_back(*at);
      path.push_back(tip.at(*at).dot(direction));
    }
    noise = estimate_noise_std(std::span(path).first(before));
  }
  [[nodiscard]] bool is_enough() const { return before >= kMinPoints && after >= kMinPoints; }
};

/// Linear least squares.
template <int N>
struct LinearFit {
  Eigen::Matrix<double, N, 1> value;
  Eigen::Matrix<double, N, N> covariance;  ///< by the residual's own variance
  double residual = 0.0;                   ///< rms, per degree of freedom
  bool is_valid = false;
};

template <int N, typename Row>
LinearFit<N> fit_linear_model(const FlightSamples& samples, const Row& row_at) {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  Matrix normal = Matrix::Zero();
  Vector rhs = Vector::Zero();
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    const Vector row = row_at(samples.t[i]);
    normal += row * row.transpose();
    rhs += row * samples.path[i];
  }
  // Columns of different magnitude: scaled, or the decomposition loses digits.
  const Vector scale = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Matrix scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Matrix inverse = scaled.ldlt().solve(Matrix::Identity());
  LinearFit<N> fit;
  fit.value = scale.asDiagonal() * (inverse * (scale.asDiagonal() * rhs));
  double squares = 0.0;
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    squares += std::pow(samples.path[i] - row_at(samples.t[i]).dot(fit.value), 2);
  }
  const double variance = squares / static_cast<double>(samples.t.size() - N);
  fit.covariance = variance * (scale.asDiagonal() * inverse * scale.asDiagonal());
  fit.residual = std::sqrt(variance);
  fit.is_valid = fit.value.allFinite() && fit.covariance.allFinite();
  return fit;
}

/// Position and speed before, at the pulse's begin, then after, at its end.
using FreeFlight = LinearFit<4>;

/// Fits the longest flight in which the tool flies freely within its noise; where it never does,
/// the shortest.
FreeFlight fit_flight(const PulseForce& force, const PathView& tip,
                      const Eigen::Vector3d& direction, double free_from, double free_to,
                      double flight) {
  FreeFlight fit;
  const double begin = force.t.front(), end = force.t.back();
  for (int halvings = 0; halvings < kMaxHalvings; ++halvings, flight *= 0.5) {
    const FlightSamples samples(force, tip, direction, std::max(free_from, begin - flight),
                                std::min(free_to, end + flight));
    if (!samples.is_enough()) break;
    fit = fit_linear_model<4>(samples, [&](double t) {
      return t < begin ? Eigen::Vector4d(1.0, t - begin, 0.0, 0.0)
                       : Eigen::Vector4d(0.0, 0.0, 1.0, t - end);
    });
    // A tool that brakes smoothly while its force has a spike: a cubic fits better.
    const auto smooth_fit = fit_linear_model<4>(samples, [&](double t) {
      const double u = (t - 0.5 * (begin + end)) / flight;
      return Eigen::Vector4d(1.0, u, u * u, u * u * u);
    });
    fit.is_valid = fit.is_valid && kMinCubicRatio * fit.residual < smooth_fit.residual;
    if (fit.residual < kMaxFlightMisfit * samples.noise) break;
  }
  return fit;
}

double norm_threshold(double noise, const SegmentationOptions& options) {
  // Three axes add up: the magnitude of pure noise is rarely above sqrt(3) stds.
  return std::max(options.enter_threshold * std::sqrt(3.0) * noise, options.min_force);
}

}  // namespace

std::vector<ForcePulse> find_pulses(std::span<const double> t,
                                    std::span<const Eigen::Vector3d> force_base, double noise,
                                    const SegmentationOptions& options) {
  const double enter = norm_threshold(noise, options);
  const double leave = options.leave_share * enter;
  std::vector<ForcePulse> pulses;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (force_base[i].norm() <= enter) continue;
    ForcePulse pulse{i, i + 1};
    while (pulse.begin > 0 && force_base[pulse.begin - 1].norm() > leave) --pulse.begin;
    while (pulse.end < t.size() && force_base[pulse.end].norm() > leave) ++pulse.end;
    i = pulse.end;
    if (!pulses.empty() && t[pulse.begin] - t[pulses.back().end - 1] < kMergeGap) {
      pulses.back().end = pulse.end;
    } else {
      pulses.push_back(pulse);
    }
  }
  std::erase_if(pulses, [&](const ForcePulse& pulse) {
    return t[pulse.end - 1] - t[pulse.begin] > options.max_impact;
  });
  return pulses;
}

std::optional<FoundImpact> find_impact(const ForcePulse& pulse, std::span<const double> t,
                                       std::span<const Eigen::Vector3d> force_base,
                                       const PathView& tip, double free_from, double free_to,
                                       double noise, const SegmentationOptions& options) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = pulse.begin; i < pulse.end; ++i) sum += force_base[i];
  FoundImpact found{sum.normalized(), {}};
  const double begin = t[pulse.begin], end = t[pulse.end - 1];
  const double margin = std::clamp(end - begin, kMinEnd, kMaxEnd);
  const double from = std::max(free_from, begin - margin);
  const double to = std::min(free_to, end + margin);
  const PulseForce force(t, force_base, found.direction_base, from, to);
  const double impulse = force.impulse();
  if (force.t.size() < 3 || tip.t().empty() || !(impulse > 0.0)) return std::nullopt;
  const FreeFlight fit =
      fit_flight(force, tip, found.direction_base, free_from, free_to, options.impact_flight);
  if (!fit.is_valid) return std::nullopt;

  ImpactMotion& motion = found.motion;
  const auto parameter = [&](double value, const Eigen::Vector4d& by) {
    return IdentifiedParameter{value, std::sqrt(std::max(0.0, by.dot(fit.covariance * by))), true};
  };
  const double approach = fit.value[1], separation = -fit.value[3];
  const double change = approach + separation;
  const IdentifiedParameter braking = parameter(change, {0.0, 1.0, 0.0, -1.0});
  if (approach < kMinApproach || change < kMinChangeStds * braking.std) return std::nullopt;
  motion.approach = parameter(approach, {0.0, 1.0, 0.0, 0.0});
  motion.separation = parameter(separation, {0.0, 0.0, 0.0, -1.0});
  motion.speed_ratio = parameter(separation / approach,
                                 {0.0, -separation / (approach * approach), 0.0, -1.0 / approach});
  const double samples = static_cast<double>(force.t.size());
  const double impulse_std = noise * std::sqrt(samples) * mean_interval(t);
  motion.mass = {impulse / change,
                 impulse / change * std::hypot(impulse_std / impulse, braking.std / change), true};
  motion.impulse = impulse;
  const double width = width_of(force);
  motion.width = width;
  // A force error at u from the centre changes the variance by u^2 over the sum of the forces; over
  // a uniform interval of half length h the mean of u^4 is h^4 / 5.
  const double half = 0.5 * (force.t.back() - force.t.front());
  const double variance_std =
      noise * std::sqrt(samples / 5.0) * half * half * mean_interval(t) / impulse;
  motion.width_std = width > 0.0 ? variance_std / (2.0 * width) : 0.0;
  motion.sample_width = mean_interval(t) / std::sqrt(12.0);
  return found;
}

}  // namespace pcavr
