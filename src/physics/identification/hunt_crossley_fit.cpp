// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "physics/identification/contact_samples.hpp"

namespace pcavr {
namespace {

constexpr double kMinExponent = 1.0;   // a flat face; contacts do not soften with depth
constexpr double kStartMargin = 0.02;  // of the depth: force is detected after the touch
/// Error of the force by the damping's std at the presses' speed, as a share, up to which the
/// damping is excited.
constexpr double kMaxDampingShare = 0.02;
constexpr int kIterations = 60;     // bounds the time where it does not converge
constexpr double kMinNoise = 1e-6;  // of the largest force: below any sensor's resolution

/// F = force (d / depth)^n (1 + c d'), with d = x - surface: these parameters are nearly
/// uncorrelated, k, lambda and n are not.
class Problem {
 public:
  Problem(const std::vector<PressSamples>& presses, const ContactFitOptions& options)
      : presses_(presses),
        is_surface_shared_(options.is_surface_shared),
        exponent_(options.exponent),
        prior_exponent_(options.prior_exponent),
        prior_exponent_std_(options.prior_exponent_std),
        max_exponent_(std::max(options.max_exponent, options.exponent.value_or(kMinExponent))) {
    double peak = 0.0;
    for (const PressSamples& press : presses) {
      for (const ContactSample& sample : press.raw) {
        depth_ = std::max(depth_, sample.position - press.onset);
        ++count_;
      }
      position_variance_ = std::max(position_variance_, std::pow(press.position_noise, 2));
      force_variance_ = std::max(force_variance_, std::pow(press.force_noise, 2));
      for (const ContactSample& sample : press.raw) peak = std::max(peak, sample.force);
    }
    // A simulated force may have no noise: distances need a unit all the same.
    force_variance_ = std::max(force_variance_, std::pow(kMinNoise * peak, 2));
  }

  /// force, c, n, then the surfaces.
  [[nodiscard]] Eigen::VectorXd start() const {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(unknowns()));
    double force = 0.0;
    for (std::size_t p = 0; p < presses_.size(); ++p) {
      theta[surface_column(p)] = presses_[p].onset - kStartMargin * depth_;
      for (const ContactSample& sample : presses_[p].raw) force = std::max(force, sample.force);
    }
    theta.head<3>() << force, 0.0, exponent_.value_or(std::min(prior_exponent_, max_exponent_));
    return theta;
  }

  /// Sum of squared distances in units of the noise; also fills `normal` and `rhs`, the normal
  /// equations of the linearised problem.
  double evaluate(const Eigen::VectorXd& theta, Eigen::MatrixXd& normal,
                  Eigen::VectorXd& rhs) const {
    normal.setZero(theta.size(), theta.size());
    rhs.setZero(theta.size());
    double sum = 0.0;
    for (std::size_t p = 0; p < presses_.size(); ++p) {
      const Eigen::Index column = surface_column(p);
      for (const ContactSample& sample : presses_[p].raw) {
        const Row row = row_of(theta, theta[column], sample);
        sum += row.error * row.error;
        const Eigen::Vector3d shared = row.by.head<3>();
        normal.topLeftCorner<3, 3>() += shared * shared.transpose();
        normal.col(column).head<3>() += shared * row.by[3];
        normal.row(column).head<3>() += shared.transpose() * row.by[3];
        normal(column, column) += row.by[3] * row.by[3];
        rhs.head<3>() += shared * row.error;
        rhs[column] += row.by[3] * row.error;
      }
    }
    if (!exponent_) sum += add_exponent_prior(theta[2], normal, rhs);
    if (exponent_) fix_exponent(normal, rhs);
    return sum;
  }

  /// The factor by which the errors' correlation in time widens a covariance of white errors: 1 + 2
  /// sum of the autocorrelations, with Bartlett's weights [Newey & West 1987, eq. 5]. The tip is
  /// interpolated between samples that neighbours share, and a law that does not fit exactly errs
  /// for a while.
  [[nodiscard]] double correlation_factor(const Eigen::VectorXd& theta) const {
    const double mean_count = static_cast<double>(count_) / static_cast<double>(presses_.size());
    const auto lags = static_cast<std::size_t>(4.0 * std::pow(mean_count / 100.0, 2.0 / 9.0)) + 1;
    double squares = 0.0, sum = 0.0;
    for (std::size_t p = 0; p < presses_.size(); ++p) {
      std::vector<double> errors;
      for (const ContactSample& sample : presses_[p].raw) {
        errors.push_back(row_of(theta, theta[surface_column(p)], sample).error);
      }
      for (std::size_t i = 0; i < errors.size(); ++i) {
        squares += errors[i] * errors[i];
        for (std::size_t lag = 1; lag <= lags && lag <= i; ++lag) {
          const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
          sum += 2.0 * weight * errors[i] * errors[i - lag];
        }
      }
    }
    return squares > 0.0 ? std::max(1.0, 1.0 + sum / squares) : 1.0;
  }

  /// Covariance of the parameters, where the errors' variance is `variance` times the noise's. The
  /// prior is not part of them: a bad fit widens what the samples say, not what was known before.
  [[nodiscard]] Eigen::MatrixXd covariance_of(Eigen::MatrixXd normal, double variance) const {
    if (!exponent_) normal(2, 2) += (variance - 1.0) * prior_information();
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(normal.rows(), normal.cols());
    Eigen::MatrixXd covariance = variance * normal.ldlt().solve(identity);
    if (exponent_) covariance(2, 2) = 0.0;
    return covariance;
  }

  /// A given exponent is counted, too: one degree of freedom of thousands.
  [[nodiscard]] std::size_t unknowns() const {
    return 3 + (is_surface_shared_ ? 1 : presses_.size());
  }
  [[nodiscard]] Eigen::Index surface_column(std::size_t press) const {
    return 3 + (is_surface_shared_ ? 0 : static_cast<Eigen::Index>(press));
  }
  [[nodiscard]] double depth() const { return depth_; }
  [[nodiscard]] double max_exponent() const { return max_exponent_; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  [[nodiscard]] double prior_information() const {
    return 1.0 / (prior_exponent_std_ * prior_exponent_std_);
  }

  /// Adds the exponent's prior, which decides only where noise hides the exponent.
  double add_exponent_prior(double exponent, Eigen::MatrixXd& normal, Eigen::VectorXd& rhs) const {
    const double weight = prior_information();
    const double off = prior_exponent_ - exponent;
    normal(2, 2) += weight;
    rhs[2] += weight * off;
    return weight * off * off;
  }

  /// Fixes the exponent: its row and column are decoupled, so that its step is zero and it does not
  /// affect the others.
  static void fix_exponent(Eigen::MatrixXd& normal, Eigen::VectorXd& rhs) {
    normal.row(2).setZero();
    normal.col(2).setZero();
    normal(2, 2) = 1.0;
    rhs[2] = 0.0;
  }

  struct Row {
    double error = 0.0;
    Eigen::Vector4d by = Eigen::Vector4d::Zero();  ///< model's change by force, c, n, surface
  };

  /// One sample's distance from the curve in units of its noise, at the nearest point of the curve
  /// (errors in variables) [York 1966; Britt & Luecke 1973].
  [[nodiscard]] Row row_of(const Eigen::VectorXd& theta, double surface,
                           const ContactSample& sample) const {
    constexpr int kSteps = 3;  // towards the nearest point; the curve is nearly straight there
    const double drag = 1.0 + theta[1] * sample.speed;
    double position = sample.position;
    double u = 0.0, power = 0.0, slope = 0.0, scale = 0.0;
    Row row;
    for (int step = 0; step < kSteps; ++step) {
      u = (position - surface) / depth_;
      power = penetration_power(u, theta[2]);
      slope = u > 0.0 ? theta[0] * theta[2] * power / u * drag / depth_ : 0.0;
      const double residual =
          sample.force - theta[0] * power * drag - slope * (sample.position - position);
      const double variance = force_variance_ + slope * slope * position_variance_;
      scale = 1.0 / std::sqrt(variance);
      row.error = scale * residual;
      position = sample.position + position_variance_ * slope * residual / variance;
    }
    if (u > 0.0) {
      row.by << power * drag, theta[0] * power * sample.speed,
          theta[0] * power * std::log(u) * drag, -slope;
      row.by *= scale;
    }
    return row;
  }

  const std::vector<PressSamples>& presses_;
  bool is_surface_shared_;
  std::optional<double> exponent_;
  double prior_exponent_, prior_exponent_std_;
  double max_exponent_;
  double depth_ = 0.0;
  double position_variance_ = 0.0;
  double force_variance_ = 0.0;
  std::size_t count_ = 0;
};

/// Levenberg-Marquardt; returns the final sum of squares, and its normal equations.
double minimise(const Problem& problem, Eigen::VectorXd& theta, Eigen::MatrixXd& normal) {
  Eigen::MatrixXd candidate_normal;
  Eigen::VectorXd rhs, candidate_rhs;
  double damping = 1e-3;
  double sum = problem.evaluate(theta, normal, rhs);
  for (int iteration = 0; iteration < kIterations && damping < 1e9; ++iteration) {
    Eigen::MatrixXd damped = normal;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    Eigen::VectorXd candidate = theta + damped.ldlt().solve(rhs);
    candidate[2] = std::clamp(candidate[2], kMinExponent, problem.max_exponent());
    const double candidate_sum = problem.evaluate(candidate, candidate_normal, candidate_rhs);
    if (!(candidate_sum < sum)) {
      damping *= 10.0;
      continue;
    }
    const bool is_done = sum - candidate_sum < 1e-10 * sum;
    theta.swap(candidate);
    normal.swap(candidate_normal);
    rhs.swap(candidate_rhs);
    sum = candidate_sum;
    damping *= 0.1;
    if (is_done) break;
  }
  return sum;
}

/// k and lambda from the problem's own parameters, with their stds by the chain rule (propagation
/// of uncertainty).
void set_parameters(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance, double depth,
                    ContactFit& fit) {
  const double log_depth = std::log(depth);
  const double k = theta[0] * std::exp(-theta[2] * log_depth);
  const Eigen::Vector3d k_by(k / theta[0], 0.0, -k * log_depth);
  const Eigen::Vector3d lambda_by = theta[1] * k_by + Eigen::Vector3d(0.0, k, 0.0);
  const Eigen::Matrix3d shared = covariance.topLeftCorner<3, 3>();
  const auto parameter = [](double value, double variance) {
    const double value_std = std::sqrt(std::max(variance, 0.0));
    return IdentifiedParameter{value, value_std, 2.0 * value_std < std::abs(value)};
  };
  Eigen::Matrix3d by;
  by << k_by.transpose(), lambda_by.transpose(), Eigen::RowVector3d::UnitZ();
  fit.covariance = by * shared * by.transpose();
  fit.stiffness = parameter(k, fit.covariance(0, 0));
  fit.damping = parameter(k * theta[1], fit.covariance(1, 1));
  fit.exponent = parameter(theta[2], fit.covariance(2, 2));
}

/// Relative, of d = depth (F / force)^(1/n), at its largest from `kMinForceShare` of `force` on.
double penetration_std(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance) {
  constexpr double kMinForceShare = 0.25;
  const auto at = [&](double force_share) {
    const Eigen::Vector3d by(-1.0 / (theta[2] * theta[0]), 0.0,
                             -std::log(force_share) / (theta[2] * theta[2]));
    return std::sqrt(std::max(by.dot(covariance.topLeftCorner<3, 3>() * by), 0.0));
  };
  return std::max(at(kMinForceShare), at(1.0));
}

/// Largest speed of the tip in contact [m/s].
double max_speed(const std::vector<PressSamples>& presses) {
  double speed = 0.0;
  for (const PressSamples& press : presses) {
    for (const ContactSample& sample : press.samples) {
      speed = std::max(speed, std::abs(sample.speed));
    }
  }
  return speed;
}

/// Sets the residual of the smoothed force, for comparison with the linear law.
void set_residual(const std::vector<PressSamples>& presses, ContactFit& fit) {
  double errors = 0.0, energy = 0.0, count = 0.0;
  for (std::size_t p = 0; p < presses.size(); ++p) {
    for (const ContactSample& sample : presses[p].samples) {
      const double depth = std::max(0.0, sample.position - fit.surface[p]);
      const double estimated = penetration_power(depth, fit.exponent.value) *
                               (fit.stiffness.value + fit.damping.value * sample.speed);
      errors += std::pow(sample.force - estimated, 2);
      energy += sample.force * sample.force;
      count += 1.0;
    }
  }
  fit.residual = std::sqrt(errors / std::max(count, 1.0));
  fit.relative_error = energy > 0.0 ? std::sqrt(errors / energy) : 0.0;
}

}  // namespace

double normalised_misfit(const std::vector<PressSamples>& presses, const ContactFit& fit) {
  double sum = 0.0, count = 0.0;
  const double n = fit.exponent.value;
  const bool is_curved = fit.regressor == ContactRegressor::hunt_crossley;
  for (std::size_t p = 0; p < presses.size(); ++p) {
    const PressSamples& press = presses[p];
    for (const ContactSample& sample : press.raw) {
      const double depth = std::max(0.0, sample.position - fit.surface[p]);
      const double power = penetration_power(depth, n);
      const double drag = fit.damping.value * sample.speed;
      const double slope =
          depth > 0.0 ? n * power / depth * (fit.stiffness.value + (is_curved ? drag : 0.0)) : 0.0;
      double estimated = power * (fit.stiffness.value + (is_curved ? drag : 0.0));
      if (!is_curved && depth > 0.0) estimated += drag + fit.mass.value * sample.acceleration;
      const double variance = std::pow(press.force_noise, 2) +
                              std::pow(slope * press.position_noise, 2) +
                              std::pow(fit.mass.value * press.acceleration_noise, 2);
      sum += std::pow(sample.force - estimated, 2) / std::max(variance, 1e-300);
      count += 1.0;
    }
  }
  return sum / std::max(count, 1.0);
}

ContactFit fit_hunt_crossley(const std::vector<PressSamples>& presses,
                             const ContactFitOptions& options) {
  ContactFit fit;
  fit.regressor = ContactRegressor::hunt_crossley;
  const Problem problem(presses, options);
  fit.samples = problem.count();
  const std::size_t unknowns = problem.unknowns();
  if (problem.count() < 4 * unknowns || problem.depth() <= 0.0) return fit;
  Eigen::VectorXd theta = problem.start();
  Eigen::MatrixXd normal;
  const double sum = minimise(problem, theta, normal);
  // Reduced chi squared: above 1 where the law does not fit the surface exactly.
  const double variance =
      sum / static_cast<double>(problem.count() - unknowns) * problem.correlation_factor(theta);
  Eigen::MatrixXd covariance = problem.covariance_of(normal, variance);
  set_parameters(theta, covariance, problem.depth(), fit);
  fit.penetration_std = penetration_std(theta, covariance);
  // A small damping is as well known as a large one: it is excited where its error hardly changes
  // the force at the speeds of the presses.
  if (fit.damping.std * max_speed(presses) < kMaxDampingShare * fit.stiffness.value) {
    fit.damping.is_excited = true;
  }
  for (std::size_t p = 0; p < presses.size(); ++p) {
    fit.surface.push_back(theta[problem.surface_column(p)]);
  }
  set_residual(presses, fit);
  fit.is_valid = fit.stiffness.value > 0.0 && std::isfinite(fit.stiffness.std);
  return fit;
}

}  // namespace pcavr
