// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/impact.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kTolerance =
    1e-11;                         // of a step, relative to the impact's own penetration and speed
constexpr int kMaxSteps = 200000;  // a hundred times what c = 0.01 needs

/// An impact in dimensionless units: depth over `length`, speed over the approach speed.
class Equation {
 public:
  Equation(const ContactLaw& law, double mass, double approach_speed) noexcept
      : law_(law), mass_(mass), speed_(approach_speed) {
    double stiffness = 0.0;
    double exponent = 1.0;
    if (const auto* hunt_crossley = std::get_if<HuntCrossley>(&law)) {
      stiffness = hunt_crossley->stiffness;
      exponent = hunt_crossley->exponent;
    } else if (const auto* linear = std::get_if<MassDamperSpring>(&law)) {
      stiffness = linear->stiffness;
      mass_ += linear->mass;  // moves with the tool
    } else {
      stiffness = std::get_if<KelvinVoigt>(&law)->stiffness;
    }
    length_ = std::pow(mass_ * speed_ * speed_ / stiffness, 1.0 / (exponent + 1.0));
  }

  struct State {
    double depth = 0.0;
    double speed = 1.0;
  };

  [[nodiscard]] State slope(const State& state) const noexcept {
    return {state.speed, -force(state) * length_ / (mass_ * speed_ * speed_)};
  }
  /// The force [N] without the law's own inertia.
  [[nodiscard]] double force(const State& state) const noexcept {
    return unclamped_contact_force(law_, {state.depth * length_, state.speed * speed_, 0.0});
  }
  [[nodiscard]] double length() const noexcept { return length_; }
  [[nodiscard]] double time() const noexcept { return length_ / speed_; }

 private:
  ContactLaw law_;
  double mass_;
  double speed_;
  double length_ = 0.0;
};

struct Step {
  Equation::State end;
  double error = 0.0;
};

/// One step of Dormand and Prince's pair of orders 5 and 4.
Step dormand_prince(const Equation& equation, const Equation::State& start, double h) noexcept {
  static constexpr double kWeights[6][6] = {
      {1.0 / 5},
      {3.0 / 40, 9.0 / 40},
      {44.0 / 45, -56.0 / 15, 32.0 / 9},
      {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
      {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
      {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
  static constexpr double kErrors[7] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                        -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
  Equation::State slopes[7];
  slopes[0] = equation.slope(start);
  Step step;
  for (int i = 0; i < 6; ++i) {
    step.end = start;
    for (int j = 0; j <= i; ++j) {
      step.end.depth += h * kWeights[i][j] * slopes[j].depth;
      step.end.speed += h * kWeights[i][j] * slopes[j].speed;
    }
    slopes[i + 1] = equation.slope(step.end);
  }
  Equation::State difference{0.0, 0.0};
  for (int i = 0; i < 7; ++i) {
    difference.depth += h * kErrors[i] * slopes[i].depth;
    difference.speed += h * kErrors[i] * slopes[i].speed;
  }
  step.error = std::max(std::abs(difference.depth), std::abs(difference.speed));
  return step;
}

/// Moments of the force over time, by the trapezoidal rule.
class PulseWidth {
 public:
  void add(double time, double force) noexcept {
    const double dt = time - time_;
    for (int power = 0; power < 3; ++power) {
      moments_[power] +=
          0.5 * dt * (force_ * std::pow(time_, power) + force * std::pow(time, power));
    }
    time_ = time;
    force_ = force;
  }
  [[nodiscard]] double value() const noexcept {
    if (!(moments_[0] > 0.0)) return 0.0;
    const double mean = moments_[1] / moments_[0];
    return std::sqrt(std::max(0.0, moments_[2] / moments_[0] - mean * mean));
  }

 private:
  double time_ = 0.0;
  double force_ = 0.0;
  double moments_[3] = {0.0, 0.0, 0.0};
};

}  // namespace

Impact simulate_impact(const ContactLaw& law, double mass, double approach_speed) noexcept {
  Impact impact;
  if (!is_physical(law) || !(mass > 0.0) || !(approach_speed > 0.0)) return impact;
  const Equation equation(law, mass, approach_speed);
  Equation::State state;
  double time = 0.0;
  double max_depth = 0.0;
  double h = 1e-3;
  PulseWidth width;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Step step = dormand_prince(equation, state, h);
    const double growth = 0.9 * std::pow(kTolerance / std::max(step.error, 1e-20), 0.2);
    if (!(step.error <= kTolerance)) {
      h *= std::clamp(growth, 0.1, 0.9);
      continue;
    }
    const bool is_separating = step.end.speed < 0.0 && equation.force(step.end) <= 0.0;
    if (is_separating && h > 1e-12) {
      h *= 0.5;  // bisect towards the instant of separation
      continue;
    }
    if (state.speed > 0.0 && step.end.speed <= 0.0) {
      // The top of the parabola with the speeds of both ends.
      max_depth =
          state.depth + 0.5 * h * state.speed * state.speed / (state.speed - step.end.speed);
    }
    state = step.end;
    time += h;
    width.add(time, std::max(0.0, equation.force(state)));
    if (is_separating) {
      impact.has_separated = true;
      break;
    }
    // No growth near the end: the step must not double again after the bisection.
    h = std::min(h * std::clamp(growth, 0.2, 4.0), 0.1);
  }
  impact.restitution = std::max(0.0, -state.speed);
  impact.duration = time * equation.time();
  impact.force_width = width.value() * equation.time();
  impact.max_penetration = max_depth * equation.length();
  return impact;
}

DampingScore score_damping_law(DampingLaw law, double restitution) noexcept {
  // The result does not depend on stiffness, mass and speed: ones.
  const HuntCrossley contact{1.0, hunt_crossley_damping(law, 1.0, restitution, 1.0), 1.5};
  return {law, simulate_impact(contact, 1.0, 1.0).restitution / restitution - 1.0};
}

std::array<DampingScore, kPublishedDampingLaws.size()> score_damping_laws(
    double restitution) noexcept {
  std::array<DampingScore, kPublishedDampingLaws.size()> scores;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i] = score_damping_law(kPublishedDampingLaws[i], restitution);
  }
  return scores;
}

DampingScore best_published_damping_law(double restitution) noexcept {
  const auto scores = score_damping_laws(restitution);
  return *std::min_element(scores.begin(), scores.end(),
                           [](const DampingScore& a, const DampingScore& b) {
                             return std::abs(a.relative_error) < std::abs(b.relative_error);
                           });
}

}  // namespace pcavr
