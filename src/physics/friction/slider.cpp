// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/slider.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

/// Breaking loose, a stop, a reversal, and the same once more: a linear load causes no more in a
/// step.
constexpr int kMaxEvents = 8;

/// The integrals of exp(-z) that solve v' + v z / t = const. and its integral, exact as z nears 0:
/// one = (1 - exp(-z)) / z, two = (1 - one) / z, three = (1/2 - two) / z.
struct Exponentials {
  double one, two, three;

  explicit Exponentials(double z) noexcept {
    if (z < 0.5) {
      double term = 1.0 / 6.0;
      three = 0.0;
      for (int j = 4; j < 20; ++j) {  // the 16th term is under 1e-20
        three += term;
        term *= -z / j;
      }
      two = 0.5 - z * three;
      one = 1.0 - z * two;
    } else {
      one = -std::expm1(-z) / z;
      two = (1.0 - one) / z;
      three = (0.5 - two) / z;
    }
  }
};

/// M v' = f + r t - B v, from v at t = 0.
struct Slide {
  double velocity;      // at the begin
  double rate;          // B / M [1/s]
  double acceleration;  // f / M, friction's Coulomb part included
  double jerk;          // r / M

  [[nodiscard]] double velocity_at(double t) const noexcept {
    const Exponentials e(rate * t);
    return velocity * std::exp(-rate * t) + acceleration * t * e.one + jerk * t * t * e.two;
  }
  [[nodiscard]] double displacement_at(double t) const noexcept {
    const Exponentials e(rate * t);
    return t * (velocity * e.one + t * (acceleration * e.two + jerk * t * e.three));
  }
  /// The time at which the velocity's slope vanishes, or `limit` where it does not before.
  [[nodiscard]] double extremum_before(double limit) const noexcept {
    // v' = (a - rate v) exp(-rate t) + jerk t one(rate t), monotone in t: bisection.
    const auto slope = [this](double t) {
      return (acceleration - rate * velocity) * std::exp(-rate * t) +
             jerk * t * Exponentials(rate * t).one;
    };
    if ((slope(0.0) > 0.0) == (slope(limit) > 0.0)) return limit;
    return bisect(limit, [&](double t) { return (slope(t) > 0.0) == (slope(0.0) > 0.0); });
  }
  /// The last instant in [0, limit] up to which `condition` is true, where it changes once.
  template <typename Condition>
  [[nodiscard]] static double bisect(double limit, const Condition& condition) noexcept {
    double low = 0.0;
    double high = limit;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (condition(middle) ? low : high) = middle;
    }
    return low;
  }
  /// The first instant in (0, limit] at which the velocity is no longer along `sign`; `limit` + 1
  /// where there is none. The velocity is convex or concave in t, so that one extremum decides.
  [[nodiscard]] double stop_before(double limit, double sign) const noexcept {
    const auto is_moving = [&](double t) { return velocity_at(t) * sign > 0.0; };
    double latest = limit;
    if (is_moving(limit)) {
      if (velocity == 0.0) return limit + 1.0;  // from rest: one extremum, so no second root
      latest = extremum_before(limit);
      if (is_moving(latest)) return limit + 1.0;
    }
    return bisect(latest, is_moving);
  }
};

double clamped_to(double limit, double value) noexcept { return std::clamp(value, -limit, limit); }

/// One step, event by event (event-driven integration).
class Stepper {
 public:
  Stepper(const FrictionParameters& parameters, const SliderState& state, const SliderLoad& load,
          double dt) noexcept
      : parameters_(parameters),
        load_(load),
        slope_(dt > 0.0 ? (load.force_at_end - load.force_at_begin) / dt : 0.0),
        dt_(dt) {
    step_.state = state;
  }

  SliderStep run() noexcept {
    for (int event = 0; event < kMaxEvents && time_ < dt_; ++event) {
      if (step_.state.velocity == 0.0) {
        stick();
      } else {
        slide(std::copysign(1.0, step_.state.velocity));
      }
    }
    conclude();
    return step_;
  }

 private:
  [[nodiscard]] double force_at(double time) const noexcept {
    return load_.force_at_begin + slope_ * time;
  }

  /// Keeps the body at rest until the load exceeds static friction; then it slides along the load.
  void stick() noexcept {
    const double limit = static_friction_limit(parameters_);
    const double force = force_at(time_);
    if (std::abs(force) <= limit) {
      if (std::abs(load_.force_at_end) <= limit) {
        time_ = dt_;
        return;
      }
      const double target = std::copysign(limit, slope_);
      time_ = std::min(dt_, time_ + std::max(0.0, (target - force) / slope_));
    }
    slide(std::copysign(1.0, std::abs(force) > limit ? force : slope_));
  }

  void slide(double sign) noexcept {
    const double left = dt_ - time_;
    if (!(left > 0.0)) return;
    const double mass = parameters_.mass;
    const Slide motion{step_.state.velocity, parameters_.viscous / mass, net_force(sign) / mass,
                       slope_ / mass};
    const double stop = motion.stop_before(left, sign);
    const double duration = std::min(stop, left);
    const double displacement = motion.displacement_at(duration);
    const double velocity = stop <= left ? 0.0 : motion.velocity_at(duration);
    step_.dissipated += work_of_load(motion, duration) -
                        0.5 * mass * (velocity * velocity - motion.velocity * motion.velocity);
    step_.state.position += displacement;
    step_.state.velocity = velocity;
    step_.moving_time += duration;
    time_ += duration;
  }

  /// Sum of load and Coulomb friction now [N], for a body that moves, or just begins to, along
  /// `sign`.
  [[nodiscard]] double net_force(double sign) const noexcept {
    const double net = force_at(time_) - sign * parameters_.coulomb_force;
    // A body breaks loose at no less than the Coulomb force: rounding must not decelerate it.
    return step_.state.velocity == 0.0 && net * sign < 0.0 ? 0.0 : net;
  }

  /// Work of the load over the motion that begins now [J], by three-point Gauss quadrature, which
  /// is of fifth order: its error is far below the noise of any force.
  [[nodiscard]] double work_of_load(const Slide& motion, double duration) const noexcept {
    const double offset = 0.5 * std::sqrt(0.6);
    const double at[3] = {0.5 - offset, 0.5, 0.5 + offset};
    const double weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    double work = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double t = at[i] * duration;
      work += weight[i] * duration * force_at(time_ + t) * motion.velocity_at(t);
    }
    return work;
  }

  void conclude() noexcept {
    SliderState& state = step_.state;
    const double force = load_.force_at_end;
    if (state.velocity != 0.0) {
      state.phase = FrictionPhase::sliding;
      step_.friction = -std::copysign(parameters_.coulomb_force, state.velocity) -
                       parameters_.viscous * state.velocity;
      return;
    }
    const double band = parameters_.limiting_force - parameters_.limiting_force_std;
    state.phase = std::abs(force) < band ? FrictionPhase::static_contact : FrictionPhase::critical;
    step_.friction = -clamped_to(static_friction_limit(parameters_), force);
  }

  const FrictionParameters& parameters_;
  const SliderLoad& load_;
  double slope_;  // of the load [N/s]
  double dt_;
  double time_ = 0.0;  // since the step's begin
  SliderStep step_;
};

}  // namespace

std::string_view name_of(FrictionPhase phase) noexcept {
  switch (phase) {
    case FrictionPhase::static_contact:
      return "static";
    case FrictionPhase::critical:
      return "critical";
    case FrictionPhase::sliding:
      return "sliding";
  }
  return "unknown";
}

bool is_physical(const FrictionParameters& p) noexcept {
  const double not_negative[] = {p.limiting_force, p.limiting_force_std, p.coulomb_force,
                                 p.viscous};
  return std::isfinite(p.mass) && p.mass > 0.0 &&
         std::all_of(std::begin(not_negative), std::end(not_negative),
                     [](double value) { return std::isfinite(value) && value >= 0.0; });
}

double static_friction_limit(const FrictionParameters& parameters) noexcept {
  return std::max(parameters.limiting_force, parameters.coulomb_force);
}

SliderStep step_slider(const FrictionParameters& parameters, const SliderState& state,
                       const SliderLoad& load, double dt) noexcept {
  const bool is_valid = is_physical(parameters) && std::isfinite(load.force_at_begin) &&
                        std::isfinite(load.force_at_end) && std::isfinite(state.velocity) &&
                        dt >= 0.0;
  if (!is_valid) {
    SliderStep unchanged;
    unchanged.state = {state.position, 0.0, FrictionPhase::static_contact};
    return unchanged;
  }
  return Stepper(parameters, state, load, dt).run();
}

}  // namespace pcavr
