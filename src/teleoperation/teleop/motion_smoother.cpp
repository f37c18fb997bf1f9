// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/motion_smoother.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// A sensor without noise, as a simulated one, needs some all the same: that of a good encoder [m].
constexpr double kMinNoise = 1e-7;
/// Random walk of the velocity that the search begins with [m^2/s^3]: white noise of the
/// acceleration of 0.3 m/s^2 at 500 Hz, as an arm that starts and stops.
constexpr double kFirstDensity = 1.8e-4;
/// More hardly changes the path (10 and 100 were tried).
constexpr int kIterations = 20;
// Samples to either side, whose mean is the strength at one: fewer are noise, more blur a corner.
constexpr std::size_t kNeighbours = 4;
/// Longest time over which noise is averaged [s]: a held tip creeps by more than noise later on.
constexpr double kMaxMemory = 0.16;
/// [m/s] std of the velocity before the first sample.
constexpr double kFirstSpeed = 0.1;

struct Gaussian {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();  ///< position, velocity
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

Eigen::Matrix2d transition(double dt) {
  Eigen::Matrix2d moved;
  moved << 1.0, dt, 0.0, 1.0;
  return moved;
}

class Smoother {
 public:
  Smoother(std::span<const double> t, std::span<const double> position, double noise)
      : t_(t),
        position_(position),
        variance_(noise * noise),
        density_(t.size(), kFirstDensity),
        filtered_(t.size()),
        predicted_(t.size()) {
    // The smoother's time constant for white noise of density r and a random walk of density q is
    // (r / q)^(1/4).
    const double interval = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
    min_density_ = variance_ * interval / std::pow(kMaxMemory, 4);
  }

  /// Expectation: the motion under the densities. Fills `walk` with the expected squares of the
  /// velocity's steps over their times: entry k is of the step to sample k.
  std::vector<Gaussian> expect(std::vector<double>& walk) {
    filter();
    std::vector<Gaussian> motion = filtered_;
    for (std::size_t k = t_.size() - 1; k-- > 0;) {
      const double dt = t_[k + 1] - t_[k];
      const Gaussian& next = predicted_[k + 1];
      const Eigen::Matrix2d gain =
          filtered_[k].covariance * transition(dt).transpose() * next.covariance.inverse();
      motion[k].mean += gain * (motion[k + 1].mean - next.mean);
      motion[k].covariance +=
          gain * (motion[k + 1].covariance - next.covariance) * gain.transpose();
      const Eigen::Matrix2d both = gain * motion[k + 1].covariance;
      const double step = motion[k + 1].mean.y() - motion[k].mean.y();
      const double step_variance =
          motion[k + 1].covariance(1, 1) + motion[k].covariance(1, 1) - 2.0 * both(1, 1);
      walk[k + 1] = (step * step + std::max(0.0, step_variance)) / dt;
    }
    walk.front() = walk[1];
    return motion;
  }

  /// Maximisation: each density is the mean of its neighbours' steps.
  void maximise(const std::vector<double>& walk) {
    double sum = 0.0;
    std::size_t begin = 0, end = 0;
    for (std::size_t k = 0; k < walk.size(); ++k) {
      for (; end < std::min(k + kNeighbours + 1, walk.size()); ++end) sum += walk[end];
      for (; begin + kNeighbours < k; ++begin) sum -= walk[begin];
      density_[k] = std::max(min_density_, sum / static_cast<double>(end - begin));
    }
  }

 private:
  void filter() {
    Gaussian state;
    state.mean.x() = position_.front();
    state.covariance.diagonal() << variance_, kFirstSpeed * kFirstSpeed;
    for (std::size_t k = 0; k < t_.size(); ++k) {
      if (k > 0) {
        const double dt = t_[k] - t_[k - 1];
        const Eigen::Matrix2d moved = transition(dt);
        state.mean = moved * state.mean;
        Eigen::Matrix2d walk;
        walk << dt * dt / 3.0, dt / 2.0, dt / 2.0, 1.0;
        state.covariance = moved * state.covariance * moved.transpose() + density_[k] * dt * walk;
        predicted_[k] = state;
      }
      const Eigen::Vector2d gain = state.covariance.col(0) / (state.covariance(0, 0) + variance_);
      state.mean += gain * (position_[k] - state.mean.x());
      state.covariance -= gain * state.covariance.row(0).eval();
      filtered_[k] = state;
    }
  }

  std::span<const double> t_;
  std::span<const double> position_;
  double variance_;
  double min_density_ = 0.0;     ///< [m^2/s^3]
  std::vector<double> density_;  ///< of the velocity's random walk up to a sample
  std::vector<Gaussian> filtered_;
  std::vector<Gaussian> predicted_;
};

}  // namespace

std::vector<MotionSample> smooth_motion(std::span<const double> t, std::span<const double> position,
                                        double noise) {
  PCAVR_REQUIRE(t.size() == position.size() && t.size() >= 2, t.size(), position.size());
  Smoother smoother(t, position, std::max(noise, kMinNoise));
  std::vector<double> walk(t.size());
  std::vector<Gaussian> motion = smoother.expect(walk);
  for (int i = 1; i < kIterations; ++i) {
    smoother.maximise(walk);
    motion = smoother.expect(walk);
  }
  std::vector<MotionSample> samples;
  samples.reserve(motion.size());
  for (const Gaussian& state : motion) samples.push_back({state.mean.x(), state.mean.y()});
  return samples;
}

}  // namespace pcavr
