// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/exciting_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "robots/robot_identification/base_parameters.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kMotionSeed = 1;
constexpr double kOutputInterval = 0.01;  // [s]
constexpr double kCheckInterval = 0.02;   // [s] of the limits' check
constexpr double kSampleInterval = 0.1;   // [s] of the information: a fraction of any harmonic
/// [s] in which residuals count as one: new postures and speeds show errors of the model, which
/// change with the motion, not with the rows.
constexpr double kMinCorrelation = 0.08;
constexpr double kFadeShare = 0.1;    // of the duration, at either end: from rest to rest
constexpr double kRandomShare = 0.3;  // of the candidates; the others vary the best one
constexpr double kFirstVariation = 0.5, kLastVariation = 0.05;  // of the coefficients
constexpr Eigen::Index kFrictionColumns = 3;                    // offset, viscous, Coulomb

/// Coefficients of sine and cosine of each harmonic, a row for each joint.
struct Fourier {
  Eigen::MatrixXd sine, cosine;
};

struct JointState {
  Eigen::VectorXd q, dq, ddq;
};

/// A factor that is 0 at both ends and 1 between, twice continuously differentiable.
double fade(double share) {
  const double x = std::clamp(std::min(share, 1.0 - share) / kFadeShare, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

class MotionSearch {
 public:
  MotionSearch(const JointSignals& signals, const RobotModel& model, const RobotFit& fit,
               const ExcitingMotionOptions& options)
      : fit_(fit),
        options_(options),
        model_(model),
        dynamics_(model),
        dof_(static_cast<Eigen::Index>(model.dof)) {
    set_bounds(signals);
    // Rows of the fit that one sample of the information stands for, less their correlation and
    // those that are held out.
    const double train_share = static_cast<double>(fit.train_rows) /
                               static_cast<double>(std::max<std::size_t>(signals.t.size(), 1));
    weights_.resize(dof_);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointFit& joint = joint_fit(j);
      const double correlation =
          std::max(signals.interval * joint.correlated_rows, kMinCorrelation);
      weights_[j] =
          std::sqrt(train_share * kSampleInterval / correlation) / std::max(joint.noise_std, 1e-9);
    }
  }

  /// Scaled so that the limits hold.
  [[nodiscard]] Fourier best() {
    Random random(kMotionSeed);
    Fourier best = scaled(drawn(random));
    double highest = log_determinant(best);
    const int random_ones = static_cast<int>(kRandomShare * options_.candidates);
    for (int i = 1; i < options_.candidates; ++i) {
      Fourier candidate = i < random_ones ? drawn(random) : varied(best, i, random);
      candidate = scaled(candidate);
      const double value = log_determinant(candidate);
      if (value <= highest) continue;
      highest = value;
      best = candidate;
    }
    return best;
  }

  [[nodiscard]] Eigen::VectorXd position_at(const Fourier& fourier, double t) const {
    Eigen::VectorXd q = centre_;
    const double share = fade(t / options_.duration);
    for (int k = 0; k < options_.harmonics; ++k) {
      const double phase = 2.0 * std::numbers::pi * options_.frequency * (k + 1) * t;
      q +=
          share * (fourier.sine.col(k) * std::sin(phase) + fourier.cosine.col(k) * std::cos(phase));
    }
    return q;
  }

  /// Information on all inertial parameters, then on offset, viscous and Coulomb friction of each
  /// joint.
  [[nodiscard]] Eigen::MatrixXd information(const Fourier& fourier) {
    const Eigen::Index columns = (10 + kFrictionColumns) * dof_;
    const auto samples = static_cast<Eigen::Index>(options_.duration / kSampleInterval);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(samples * dof_, columns);
    Eigen::MatrixXd regressor(dof_, 10 * dof_);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const JointState state = state_at(fourier, kSampleInterval * static_cast<double>(i));
      dynamics_.regressor(state.q, state.dq, state.ddq, regressor);
      for (Eigen::Index j = 0; j < dof_; ++j) {
        auto row = rows.row(i * dof_ + j);
        row.head(10 * dof_) = regressor.row(j);
        row.segment<kFrictionColumns>(friction_column(j)) << 1.0, state.dq[j],
            std::tanh(state.dq[j] / joint_fit(j).sign.smoothing_speed);
        row *= weights_[j];
      }
    }
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(columns, columns);
    result.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    result.diagonal().head(10 * dof_) += fit_.prior_std.cwiseAbs2().cwiseInverse();
    // Friction that a motion without speed would leave unknown.
    result.diagonal().tail(kFrictionColumns * dof_).array() += 1e-9;
    return result.selfadjointView<Eigen::Lower>();
  }

  [[nodiscard]] Eigen::Index friction_column(Eigen::Index joint) const {
    return 10 * dof_ + kFrictionColumns * joint;
  }

 private:
  [[nodiscard]] const JointFit& joint_fit(Eigen::Index joint) const {
    return fit_.joints[static_cast<std::size_t>(joint)];
  }

  void set_bounds(const JointSignals& signals) {
    centre_.resize(dof_);
    reach_.resize(dof_);
    max_speed_.resize(dof_);
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const JointLimits& limits = model_.joints[static_cast<std::size_t>(j)].limits;
      const double margin = options_.limit_margin;
      double low = signals.position.col(j).minCoeff() - options_.extra_range;
      double high = signals.position.col(j).maxCoeff() + options_.extra_range;
      if (limits.lower) low = std::max(low, *limits.lower + margin);
      if (limits.upper) high = std::min(high, *limits.upper - margin);
      centre_[j] = 0.5 * (low + high);
      reach_[j] = std::max(0.5 * (high - low), 0.0);
      max_speed_[j] =
          limits.velocity ? options_.speed_share * *limits.velocity : options_.max_speed;
    }
  }

  [[nodiscard]] Fourier drawn(Random& random) const {
    Fourier fourier{Eigen::MatrixXd(dof_, options_.harmonics),
                    Eigen::MatrixXd(dof_, options_.harmonics)};
    for (Eigen::Index j = 0; j < dof_; ++j) {
      for (int k = 0; k < options_.harmonics; ++k) {
        // Speeds of all harmonics alike.
        fourier.sine(j, k) = random.normal() / (k + 1);
        fourier.cosine(j, k) = random.normal() / (k + 1);
      }
    }
    return fourier;
  }

  /// Varies one joint's coefficients, by less and less.
  [[nodiscard]] Fourier varied(Fourier fourier, int candidate, Random& random) const {
    const double progress = static_cast<double>(candidate) / options_.candidates;
    const double size = kFirstVariation * std::pow(kLastVariation / kFirstVariation, progress);
    const auto j = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(dof_)));
    const double amplitude = std::max(fourier.sine.row(j).cwiseAbs().maxCoeff(),
                                      fourier.cosine.row(j).cwiseAbs().maxCoeff());
    for (int k = 0; k < options_.harmonics; ++k) {
      fourier.sine(j, k) += size * amplitude * random.normal();
      fourier.cosine(j, k) += size * amplitude * random.normal();
    }
    return fourier;
  }

  /// Scales each joint's amplitudes to be as large as its bounds allow.
  [[nodiscard]] Fourier scaled(Fourier fourier) const {
    Eigen::VectorXd reach = Eigen::VectorXd::Zero(dof_), speed = reach, acceleration = reach;
    for (double t = 0.0; t <= options_.duration; t += kCheckInterval) {
      const JointState state = state_at(fourier, t);
      reach = reach.cwiseMax((state.q - centre_).cwiseAbs());
      speed = speed.cwiseMax(state.dq.cwiseAbs());
      acceleration = acceleration.cwiseMax(state.ddq.cwiseAbs());
    }
    for (Eigen::Index j = 0; j < dof_; ++j) {
      const double factor =
          std::min({reach_[j] / std::max(reach[j], 1e-9), max_speed_[j] / std::max(speed[j], 1e-9),
                    options_.max_acceleration / std::max(acceleration[j], 1e-9)});
      fourier.sine.row(j) *= factor;
      fourier.cosine.row(j) *= factor;
    }
    return fourier;
  }

  /// Derivatives by central differences: the motion is smooth over far longer times.
  [[nodiscard]] JointState state_at(const Fourier& fourier, double t) const {
    constexpr double kStep = 1e-3;
    const Eigen::VectorXd before = position_at(fourier, t - kStep);
    const Eigen::VectorXd after = position_at(fourier, t + kStep);
    JointState state{position_at(fourier, t), (after - before) / (2.0 * kStep), {}};
    state.ddq = (after - 2.0 * state.q + before) / (kStep * kStep);
    return state;
  }

  [[nodiscard]] double log_determinant(const Fourier& fourier) {
    const Eigen::LLT<Eigen::MatrixXd> factor(information(fourier));
    if (factor.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
    const Eigen::MatrixXd lower = factor.matrixL();
    return 2.0 * lower.diagonal().array().log().sum();
  }

  const RobotFit& fit_;
  const ExcitingMotionOptions& options_;
  const RobotModel& model_;
  RobotDynamics dynamics_;
  Eigen::Index dof_;
  Eigen::VectorXd centre_, reach_, max_speed_, weights_;
};

}  // namespace

ExcitingMotion plan_exciting_motion(const JointSignals& signals, const RobotModel& model,
                                    const RobotFit& fit, const ExcitingMotionOptions& options) {
  MotionSearch search(signals, model, fit, options);
  const Fourier fourier = search.best();
  ExcitingMotion motion;
  const auto rows = static_cast<Eigen::Index>(options.duration / kOutputInterval) + 1;
  const auto dof = static_cast<Eigen::Index>(model.dof);
  motion.position.resize(rows, dof);
  for (Eigen::Index i = 0; i < rows; ++i) {
    motion.t.push_back(kOutputInterval * static_cast<double>(i));
    motion.position.row(i) = search.position_at(fourier, motion.t.back()).transpose();
  }
  const Eigen::MatrixXd information = search.information(fourier);
  const Eigen::MatrixXd covariance =
      information.llt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  for (Eigen::Index j = 0; j < dof; ++j) {
    const Eigen::Index column = search.friction_column(j);
    motion.viscous_std.push_back(std::sqrt(covariance(column + 1, column + 1)));
    motion.coulomb_std.push_back(std::sqrt(covariance(column + 2, column + 2)));
  }
  motion.base_parameters = base_parameters(
      model, fit.inertial_parameters, covariance.topLeftCorner(10 * dof, 10 * dof), fit.prior_std);
  return motion;
}

std::string format_motion(const ExcitingMotion& motion, const RobotModel& model) {
  std::string text = "t";
  for (const RobotJoint& joint : model.joints) text += ",q_" + joint.name;
  text += '\n';
  for (std::size_t i = 0; i < motion.t.size(); ++i) {
    text += fmt::format("{:.2f}", motion.t[i]);
    for (Eigen::Index j = 0; j < motion.position.cols(); ++j) {
      text += fmt::format(",{:.6f}", motion.position(static_cast<Eigen::Index>(i), j));
    }
    text += '\n';
  }
  return text;
}

}  // namespace pcavr
