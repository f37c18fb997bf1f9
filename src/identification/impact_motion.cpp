// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identification/impact_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "pcavr/identification/signals.hpp"

namespace pcavr {
namespace {

/// Below, a tap is no impact: the restitution would be noise [m/s].
constexpr double kMinApproach = 0.02;
/// Change of the tool's speed in its stds, which a spike of the force does not cause.
constexpr double kMinChangeStds = 6.0;
/// The pulse's slow ends are below its threshold: the force counts from these shares of the pulse's
/// duration before it until after it.
constexpr double kEndShare = 0.5;
constexpr double kMinEnd = 0.004;     // [s] two samples at 500 Hz
constexpr double kMergeGap = 0.006;   // [s] between pulses that noise has split
constexpr std::size_t kMinPoints = 8;  // of the path, on either side
constexpr int kMaxHalvings = 3;        // of the free flight, where the servo drives the tool
constexpr double kMaxFlightMisfit = 1.5;     // rms residual over the tip's noise of a free flight
/// Residual of a smooth path over that of the impact's, which tells it from a spike of the force.
constexpr double kMinCubicRatio = 1.4;

/// The force along a direction, with its integrals by the trapezoidal rule.
struct Integrals {
  std::vector<double> t, force, impulse, path;  ///< [s], [N], [N s], [N s^2]

  /// At any time, linear between samples; beyond the end the impulse is constant.
  [[nodiscard]] double path_at(double at) const {
    if (at <= t.front()) return 0.0;
    if (at >= t.back()) return path.back() + impulse.back() * (at - t.back());
    const auto after = std::upper_bound(t.begin(), t.end(), at);
    const auto i = static_cast<std::size_t>(after - t.begin()) - 1;
    const double dt = at - t[i];
    const double share = dt / (t[i + 1] - t[i]);
    const double force_at = force[i] + share * (force[i + 1] - force[i]);
    return path[i] + dt * impulse[i] + dt * dt * (2.0 * force[i] + force_at) / 6.0;
  }
};

Integrals integrate(std::span<const double> t, std::span<const Eigen::Vector3d> force_base,
                    const Eigen::Vector3d& direction, double from, double to) {
  Integrals all;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < from || t[i] > to) continue;
    const double force = force_base[i].dot(direction);
    if (all.t.empty()) {
      all.impulse.push_back(0.0);
      all.path.push_back(0.0);
    } else {
      const double dt = t[i] - all.t.back();
      const double before = all.force.back();
      all.path.push_back(all.path.back() + dt * all.impulse.back() +
                         dt * dt * (2.0 * before + force) / 6.0);
      all.impulse.push_back(all.impulse.back() + 0.5 * dt * (before + force));
    }
    all.t.push_back(t[i]);
    all.force.push_back(force);
  }
  return all;
}

/// Mean time and std of the force's distribution over time.
std::pair<double, double> moments_of(const Integrals& force) {
  double sum = 0.0, first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < force.t.size(); ++i) sum += force.force[i];
  for (std::size_t i = 0; i < force.t.size(); ++i) first += force.force[i] / sum * force.t[i];
  for (std::size_t i = 0; i < force.t.size(); ++i) {
    second += force.force[i] / sum * std::pow(force.t[i] - first, 2);
  }
  return {first, std::sqrt(std::max(second, 0.0))};
}

/// The tip's path along the direction around a pulse.
struct FlightSamples {
  std::vector<double> t, path;
  std::size_t before = 0, after = 0;  ///< outside of the force's interval
  double noise = 0.0;                 ///< [m] std of one sample

  FlightSamples(const Integrals& force, const PathView& tip, const Eigen::Vector3d& direction,
                double from, double to) {
    const auto end = std::upper_bound(tip.t().begin(), tip.t().end(), to);
    for (auto at = std::lower_bound(tip.t().begin(), end, from); at != end; ++at) {
      before += *at < force.t.front() ? 1 : 0;
      after += *at > force.t.back() ? 1 : 0;
      t.push_back(*at);
      path.push_back(tip.at(*at).dot(direction));
    }
    noise = estimate_noise_std(path);
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

/// p0, v0 and 1/m.
using FreeFlight = LinearFit<3>;

/// Over the longest flight in which the tool flies freely within its noise; where it never does,
/// over the shortest.
FreeFlight fit_flight(const Integrals& force, const PathView& tip, const Eigen::Vector3d& direction,
                      double free_from, double free_to, double centre, double flight) {
  FreeFlight fit;
  for (int halvings = 0; halvings < kMaxHalvings; ++halvings, flight *= 0.5) {
    const FlightSamples samples(force, tip, direction,
                                std::max(free_from, force.t.front() - flight),
                                std::min(free_to, force.t.back() + flight));
    if (!samples.is_enough()) break;
    fit = fit_linear_model<3>(samples, [&](double t) {
      return Eigen::Vector3d(1.0, t - centre, -force.path_at(t));
    });
    // A tool that brakes smoothly while its force has a spike: a cubic fits better.
    const auto smooth_fit = fit_linear_model<4>(samples, [&](double t) {
      const double u = (t - centre) / flight;
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
  const double margin = std::max(kMinEnd, kEndShare * (end - begin));
  const double from = std::max(free_from, begin - margin);
  const double to = std::min(free_to, end + margin);
  const Integrals force = integrate(t, force_base, found.direction_base, from, to);
  if (force.t.size() < 3 || tip.t().empty()) return std::nullopt;
  const auto [centre, width] = moments_of(force);
  const FreeFlight fit = fit_flight(force, tip, found.direction_base, free_from, free_to, centre,
                                    options.impact_flight);
  if (!fit.is_valid) return std::nullopt;

  ImpactMotion& motion = found.motion;
  const double impulse = force.impulse.back();
  const double change = impulse * fit.value[2];
  const double change_std = std::abs(impulse) * std::sqrt(fit.covariance(2, 2));
  const double approach = fit.value[1];
  if (approach < kMinApproach || change < kMinChangeStds * change_std) return std::nullopt;
  const auto parameter = [&](double value, const Eigen::Vector3d& by) {
    return IdentifiedParameter{value, std::sqrt(std::max(0.0, by.dot(fit.covariance * by))), true};
  };
  const double separation = change - approach;
  motion.approach = parameter(approach, {0.0, 1.0, 0.0});
  motion.separation = parameter(separation, {0.0, -1.0, impulse});
  motion.speed_ratio =
      parameter(separation / approach, {0.0, -change / (approach * approach), impulse / approach});
  motion.mass = parameter(1.0 / fit.value[2], {0.0, 0.0, 1.0 / (fit.value[2] * fit.value[2])});
  motion.impulse = impulse;
  motion.width = width;
  // A force error at u from the centre changes the variance by u^2 over the sum of the forces; over
  // a uniform interval of half length h the mean of u^4 is h^4 / 5.
  const double half = 0.5 * (force.t.back() - force.t.front());
  const double samples = static_cast<double>(force.t.size());
  const double variance_std = noise * std::sqrt(samples / 5.0) * half * half * mean_interval(t) /
                              std::abs(impulse);
  motion.width_std = width > 0.0 ? variance_std / (2.0 * width) : 0.0;
  motion.sample_width = mean_interval(t) / std::sqrt(12.0);
  return found;
}

}  // namespace pcavr
