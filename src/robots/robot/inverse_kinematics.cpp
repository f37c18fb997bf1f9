// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/inverse_kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

/// The linearisation is good for about this much [rad], or times rotation_length [m].
constexpr double kMaxError = 0.5;
/// Iterations without progress after which a start is given up.
constexpr int kMaxStalled = 25;
/// The secondary goal is reached when no joint moves more than this in an iteration [rad] or [m].
constexpr double kCentredStep = 1e-4;

/// A direction in which the link cannot move at all: left to the secondary goal.
constexpr double kZeroSingularValue = 1e-6;
/// Seed of the random positions for restarts.
constexpr std::uint64_t kSeed = 1;

/// The limits of one coordinate.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool is_bounded() const { return std::isfinite(lower) && std::isfinite(upper); }
  [[nodiscard]] double width() const { return upper - lower; }
  [[nodiscard]] double middle() const { return 0.5 * (lower + upper); }
};

/// Joints that mimic others bound their leader.
std::vector<Range> ranges_of(const RobotModel& model) {
  std::vector<Range> ranges(model.dof);
  for (const RobotJoint& joint : model.joints) {
    Range& range = ranges[joint.coordinate];
    if (joint.multiplier == 0.0) continue;
    if (joint.limits.lower && joint.limits.upper) {
      const double a = (*joint.limits.lower - joint.offset) / joint.multiplier;
      const double b = (*joint.limits.upper - joint.offset) / joint.multiplier;
      range.lower = std::max(range.lower, std::min(a, b));
      range.upper = std::min(range.upper, std::max(a, b));
    }
    if (joint.limits.velocity) {
      range.velocity =
          std::min(range.velocity, *joint.limits.velocity / std::abs(joint.multiplier));
    }
  }
  return ranges;
}

double limited(double value, double max) { return std::min(1.0, max / std::max(value, 1e-300)); }

}  // namespace

struct InverseKinematics::Solver {
  Solver(const RobotModel& model, std::size_t the_link, const InverseKinematicsOptions& the_options)
      : options(the_options),
        link(the_link),
        dynamics(model),
        ranges(ranges_of(model)),
        is_locked(model.dof) {
    const auto dof = static_cast<Eigen::Index>(model.dof);
    jacobian.setZero(6, dof);
    for (Eigen::VectorXd* v : {&step, &centring, &best, &row}) v->setZero(dof);
    for (const Range& range : ranges) {
      if (range.is_bounded() && range.width() > 0.0) min_width = std::min(min_width, range.width());
    }
  }

  [[nodiscard]] double weighted_error() const {
    return std::hypot(result.position_error, options.rotation_length * result.rotation_error);
  }
  [[nodiscard]] bool is_within_tolerance() const {
    return result.position_error <= options.position_tolerance &&
           result.rotation_error <= options.rotation_tolerance;
  }

  void clamp(Eigen::Ref<Eigen::VectorXd> q) const {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      double& x = q[static_cast<Eigen::Index>(i)];
      if (ranges[i].lower <= ranges[i].upper) x = std::clamp(x, ranges[i].lower, ranges[i].upper);
    }
  }

  /// Error, Jacobian (rotation rows weighted) and the result's errors at q.
  void evaluate(const Pose& T_base_target, const Eigen::Ref<const Eigen::VectorXd>& q) {
    dynamics.jacobian(q, link, jacobian);
    jacobian.bottomRows<3>() *= options.rotation_length;
    const Pose T_base_link = dynamics.T_base_link(link);
    const Eigen::Vector3d p = T_base_target.translation() - T_base_link.translation();
    const Eigen::AngleAxisd turn(T_base_target.rotation() * T_base_link.rotation().conjugate());
    // An angle above pi is the other way round.
    const double angle = std::remainder(turn.angle(), 2.0 * std::numbers::pi);
    result.position_error = p.norm();
    result.rotation_error = std::abs(angle);
    const double length = options.rotation_length;
    error.head<3>() = limited(p.norm(), kMaxError * length) * p;
    error.tail<3>() = length * limited(std::abs(angle), kMaxError) * angle * turn.axis();
  }

  /// `step` from `error`: damped least squares in the singular directions, the secondary goal in
  /// the null space; joints that would leave their limits are locked, and the rest computed again.
  void compute_step(const Eigen::Ref<const Eigen::VectorXd>& q) {
    std::fill(is_locked.begin(), is_locked.end(), false);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      solve_linear(q);
      if (!lock_one(q)) break;
    }
    result.is_at_limit = std::find(is_locked.begin(), is_locked.end(), true) != is_locked.end();
  }

  void solve_linear(const Eigen::Ref<const Eigen::VectorXd>& q) {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (is_locked[i]) jacobian.col(at).setZero();
      const bool is_free = !is_locked[i] && ranges[i].is_bounded() && ranges[i].width() > 0.0;
      const double to_middle = is_free ? ranges[i].middle() - q[at] : 0.0;
      // The gradient, in units in which the joint with the narrowest range goes all the way.
      const double ratio = is_free ? min_width / ranges[i].width() : 0.0;
      centring[at] = options.centring_gain * ratio * ratio * to_middle;
    }
    const Matrix6d square = jacobian * jacobian.transpose();
    eigen.compute(square);
    step = centring;
    result.is_singular = false;
    for (int i = 0; i < 6; ++i) {
      const double sigma = std::sqrt(std::max(eigen.eigenvalues()[i], 0.0));
      const Vector6d direction = eigen.eigenvectors().col(i);
      add_direction(sigma, direction);
    }
  }

  /// Adds one singular direction: its part of the error, and nothing of the secondary goal.
  void add_direction(double sigma, const Vector6d& direction) {
    double damping = 0.0;
    if (sigma < options.singular_value) {
      const double ratio = sigma / options.singular_value;
      damping = (1.0 - ratio * ratio) * max_damping * max_damping;
      result.is_singular = true;
    }
    if (sigma < kZeroSingularValue) return;
    row.noalias() = jacobian.transpose() * direction;
    const double wanted = direction.dot(error) / (sigma * sigma + damping);
    const double unwanted = row.dot(centring) / (sigma * sigma);
    step += (wanted - unwanted) * row;
  }

  /// Locks the joint at a limit that the step pushes outwards the most; whether there is one.
  bool lock_one(const Eigen::Ref<const Eigen::VectorXd>& q) {
    double max_push = 0.0;
    std::size_t worst = ranges.size();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (is_locked[i]) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const bool is_pushed = (q[at] <= ranges[i].lower && step[at] < 0.0) ||
                             (q[at] >= ranges[i].upper && step[at] > 0.0);
      if (is_pushed && std::abs(step[at]) > max_push) {
        max_push = std::abs(step[at]);
        worst = i;
      }
    }
    if (worst == ranges.size()) return false;
    is_locked[worst] = true;
    return true;
  }

  /// Searches from q until it converges or gets stuck; the best position goes to `best`.
  bool run(const Pose& T_base_target, Eigen::Ref<Eigen::VectorXd> q) {
    double reference = std::numeric_limits<double>::infinity();
    int stalled = 0;
    for (int i = 0; i < options.max_iterations; ++i) {
      evaluate(T_base_target, q);
      // Damping is less near the solution: those close to a singularity would converge too slowly.
      const double value = weighted_error();
      max_damping = std::min(options.max_damping, value);
      compute_step(q);
      ++result.iterations;
      const bool is_within = is_within_tolerance();
      if (is_within || value < best_error) keep(q, value);
      const double largest = step.lpNorm<Eigen::Infinity>();
      if (is_within && largest < kCentredStep) break;
      if (value < 0.99 * reference) {
        reference = value;
        stalled = 0;
      } else if (!is_within && ++stalled > kMaxStalled) {
        break;
      }
      q += limited(largest, options.max_step) * step;
      clamp(q);
    }
    return best_result.position_error <= options.position_tolerance &&
           best_result.rotation_error <= options.rotation_tolerance;
  }

  void keep(const Eigen::Ref<const Eigen::VectorXd>& q, double value) {
    best = q;
    best_error = value;
    best_result = result;
  }

  void draw(Random& random, Eigen::Ref<Eigen::VectorXd> q) const {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const bool is_bounded = ranges[i].is_bounded();
      q[static_cast<Eigen::Index>(i)] =
          random.uniform(is_bounded ? ranges[i].lower : -std::numbers::pi,
                         is_bounded ? ranges[i].upper : std::numbers::pi);
    }
  }

  InverseKinematicsOptions options;
  std::size_t link;
  RobotDynamics dynamics;
  std::vector<Range> ranges;
  double min_width = std::numeric_limits<double>::infinity();  ///< of the ranges
  std::vector<bool> is_locked;
  Matrix6Xd jacobian;
  Vector6d error = Vector6d::Zero();
  Eigen::SelfAdjointEigenSolver<Matrix6d> eigen;
  Eigen::VectorXd step;
  Eigen::VectorXd centring;
  Eigen::VectorXd row;
  Eigen::VectorXd best;
  double max_damping = 0.0;
  double best_error = 0.0;
  IkResult result;
  IkResult best_result;
};

InverseKinematics::InverseKinematics(const RobotModel& model, std::size_t link,
                                     const InverseKinematicsOptions& options) {
  PCAVR_REQUIRE(link < model.links.size(), link, model.links.size());
  PCAVR_REQUIRE(model.dof > 0, model.name);
  solver_ = std::make_unique<Solver>(model, link, options);
}
InverseKinematics::InverseKinematics(InverseKinematics&&) noexcept = default;
InverseKinematics& InverseKinematics::operator=(InverseKinematics&&) noexcept = default;
InverseKinematics::~InverseKinematics() = default;

IkResult InverseKinematics::solve(const Pose& T_base_target, Eigen::Ref<Eigen::VectorXd> q) {
  Solver& s = *solver_;
  PCAVR_REQUIRE(q.size() == s.step.size(), q.size(), s.step.size());
  PCAVR_REQUIRE(q.allFinite());
  s.result = {};
  s.best_result = {};
  s.best_error = std::numeric_limits<double>::infinity();
  s.clamp(q);
  Random random(kSeed);
  bool is_reached = s.run(T_base_target, q);
  while (!is_reached && s.result.restarts < s.options.max_restarts) {
    ++s.result.restarts;
    s.draw(random, q);
    is_reached = s.run(T_base_target, q);
  }
  q = s.best;
  IkResult result = s.best_result;
  result.status = is_reached ? IkStatus::kReached : IkStatus::kNotReached;
  result.iterations = s.result.iterations;
  result.restarts = s.result.restarts;
  return result;
}

IkResult InverseKinematics::follow(const Pose& T_base_target, double dt,
                                   Eigen::Ref<Eigen::VectorXd> q) {
  Solver& s = *solver_;
  PCAVR_REQUIRE(q.size() == s.step.size(), q.size(), s.step.size());
  PCAVR_REQUIRE(q.allFinite());
  PCAVR_REQUIRE(dt > 0.0, dt);
  s.result = {};
  s.clamp(q);
  s.evaluate(T_base_target, q);
  s.max_damping = s.options.max_damping;
  s.compute_step(q);
  const bool is_singular = s.result.is_singular;
  double scale = limited(s.step.lpNorm<Eigen::Infinity>(), s.options.max_step);
  for (std::size_t i = 0; i < s.ranges.size(); ++i) {
    const double speed = std::abs(s.step[static_cast<Eigen::Index>(i)]) / dt;
    scale = std::min(scale, limited(speed, s.ranges[i].velocity));
  }
  q += scale * s.step;
  s.clamp(q);
  s.evaluate(T_base_target, q);
  s.result.is_singular = is_singular;
  s.result.iterations = 1;
  s.result.status = s.is_within_tolerance() ? IkStatus::kReached : IkStatus::kNotReached;
  return s.result;
}

double InverseKinematics::distance_to_middle(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  PCAVR_REQUIRE(q.size() == solver_->step.size(), q.size(), solver_->step.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < solver_->ranges.size(); ++i) {
    const Range& range = solver_->ranges[i];
    if (!range.is_bounded() || range.width() <= 0.0) continue;
    const double offset = (q[static_cast<Eigen::Index>(i)] - range.middle()) / range.width();
    sum += offset * offset;
  }
  return sum;
}

}  // namespace pcavr
