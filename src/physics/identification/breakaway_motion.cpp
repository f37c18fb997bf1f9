// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/breakaway_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

/// Variants of one motion, which processors compute side by side.
template <int N>
using Variants = Eigen::Array<double, N, 1>;

/// d^n along paths of short steps, by the binomial series about the step before: a fifth of a power
/// function's time.
template <int N>
class PowerAlongPath {
  static constexpr double kMaxRelativeStep = 0.01;  // the sixth term is below 1e-12 then

 public:
  explicit PowerAlongPath(double exponent) : n_(exponent) {
    double term = 1.0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto order = static_cast<double>(k);
      terms_[k] = term *= (n_ - order) / (order + 1.0);
    }
  }

  const Variants<N>& at(const Variants<N>& depth) {
    const Variants<N> e = depth / depth_ - 1.0;
    if ((e.abs() <= kMaxRelativeStep).all()) {
      const Variants<N> second =
          terms_[1] + e * terms_[2] + e.square() * (terms_[3] + e * terms_[4]);
      power_ *= 1.0 + e * terms_[0] + e.square() * second;
    } else {
      power_ = depth.unaryExpr([this](double one) { return penetration_power(one, n_); });
    }
    depth_ = depth;
    return power_;
  }

 private:
  double n_;
  std::array<double, 5> terms_;
  Variants<N> depth_ = Variants<N>::Zero(), power_ = Variants<N>::Zero();
};

/// One breakaway's force, and the equation of motion that predicts it.
class BreakawayFit {
  static constexpr double kPathHalfWidth = 0.040;  // [s] of the tip's smoothing: it moves smoothly
  /// Share of Coulomb friction from which on the force is fitted: the object surely rests before.
  static constexpr double kFromShare = 0.6;
  static constexpr double kMinStartShare = 0.1;  // of the peak: in contact, whatever the noise
  static constexpr double kMaxLead = 0.3;        // [s] before the peak
  // [s] after the peak; between them, a quarter of the contact's swing.
  static constexpr double kMinAfter = 0.004, kMaxAfter = 0.03;
  static constexpr std::size_t kMinSamples = 10;
  static constexpr double kMinNoiseShare = 1e-3;  // of the force: a simulated one may have none
  // Largest step of the integration [s]: a hundredth of a hard contact's swing.
  static constexpr double kMaxStep = 1e-4;
  static constexpr double kDampedSpeed = 0.005;  // [m/s] bristles damp slower motion only
  static constexpr int kIterations = 20;
  static constexpr double kMaxDamping = 1e6;     // of the normal equations: no step improves them
  static constexpr double kConverged = 1e-6;     // relative change of the misfit
  static constexpr double kDifference = 0.1;     // step of the derivatives, in stds
  static constexpr double kMinRemaining = 1e-3;  // of a distribution that bounds cut

  /// The unknowns. All but the penetration have a prior, whose std is their unit.
  enum Unknown {
    kLogExcess,    // of the limit over Coulomb friction
    kPenetration,  // of the tip at the window's begin, in hundredths of its start value
    kSpeed,        // errors of the tip's speed and acceleration
    kAcceleration,
    kOwn,  // the unknowns before are the push's own, those from here on the object's
    kCompliance = kOwn,
    kDamping,
    kLogStribeck,
    kCoulomb,  // along the columns of the Cholesky factor of sliding friction's covariance
    kViscous,
    kLogPresliding,
    kUnknowns
  };
  using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
  using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Own = Eigen::Matrix<double, kOwn, kOwn>;

 public:
  BreakawayFit(const ForceMotion& push, const Breakaway& breakaway, const PushedObject& object,
               const BreakawayPriors& priors)
      : object_(object),
        priors_(priors),
        friction_factor_(object.sliding_covariance.llt().matrixL()) {
    const HuntCrossley& law = object.contact_law;
    const double depth = static_penetration(law, breakaway.force);
    const double stiffness = law.exponent * breakaway.force / depth;
    take_window(push, breakaway, 0.5 * std::numbers::pi * std::sqrt(object.mass / stiffness));
    if (!is_usable()) return;
    noise_ = std::max(estimate_noise_std(push.force), kMinNoiseShare * breakaway.force);
    const double interval = mean_interval(push.t);
    const double tip_noise = push.tool_noise.value_or(estimate_noise_std(push.tool));
    const double cube = std::pow(kPathHalfWidth, 3);
    speed_std_ = tip_noise * std::sqrt(15.0 / 7.0 * interval / cube);
    acceleration_std_ =
        tip_noise * std::sqrt(22.5 * interval / (cube * kPathHalfWidth * kPathHalfWidth));
    start_penetration_ =
        static_penetration(law, std::max(mean_about(force_, 0), kMinStartShare * breakaway.force));
    const SmoothedSample tip = smooth_at(push.t, push.tool, breakaway.t, kPathHalfWidth);
    const double tip_speed = tip.is_valid ? std::max(0.0, tip.rate) : 0.0;
    const double overshoot = tip_speed * std::sqrt(stiffness * object.mass);
    max_limit_ = (1.0 + priors_.max_shortfall) * breakaway.force + breakaway.std;
    min_limit_ = breakaway.force - breakaway.std - (1.0 + object.compliance_std) * overshoot -
                 object.sliding[1] * tip_speed;
  }

  [[nodiscard]] bool is_usable() const { return t_.size() >= kMinSamples; }

  [[nodiscard]] LimitOfMotion solve() const {
    const Place found = minimise();
    const Unknowns& theta = found.theta;
    Normal normal;
    Unknowns gradient;
    linearise(theta, found.forces, normal, gradient);
    const Normal covariance = normal.llt().solve(Normal::Identity());
    const double inflation = std::max(1.0, found.misfit / static_cast<double>(t_.size() - 2));
    const Unknowns by = limit_by(theta);
    const double variance = inflation * by.dot(covariance * by);
    if (!std::isfinite(variance) || !(variance > 0.0)) return {};
    // The limit by this push alone, without the prior, if all shared unknowns are known.
    Own own = normal.topLeftCorner<kOwn, kOwn>();
    own(kLogExcess, kLogExcess) = std::max(own(kLogExcess, kLogExcess) - 1.0, 1e-9);
    const Own inverse = own.llt().solve(Own::Identity());
    const double own_variance = inflation * std::pow(by[kLogExcess], 2) * inverse(0, 0);
    const double own_share = std::sqrt(std::min(1.0, own_variance / variance));
    const IdentifiedParameter limit = within_bounds(limit_at(theta), std::sqrt(variance));
    return {{limit.value, own_share * limit.std, true},
            std::sqrt(1.0 - own_share * own_share) * limit.std};
  }

 private:
  /// The samples that are fitted, about the peak.
  void take_window(const ForceMotion& push, const Breakaway& breakaway, double quarter_swing) {
    const std::vector<double> force = remove_spikes(push.force).values;
    const double loaded = kFromShare * std::min(breakaway.force, object_.sliding[0]);
    const auto peak = std::lower_bound(push.t.begin(), push.t.end(), breakaway.t);
    auto begin = static_cast<std::size_t>(peak - push.t.begin());
    const double from = breakaway.t - kMaxLead;
    while (begin > 0 && push.t[begin - 1] > from && mean_about(force, begin) > loaded) --begin;
    const double to = breakaway.t + std::clamp(quarter_swing, kMinAfter, kMaxAfter);
    for (std::size_t i = begin; i < push.t.size() && push.t[i] <= to; ++i) {
      const SmoothedSample tip = smooth_at(push.t, push.tool, push.t[i], kPathHalfWidth);
      if (!tip.is_valid) continue;
      // Removes the bias by the path's curvature: the smoothing kernel's second moment is a
      // seventh.
      const double bias = tip.acceleration * kPathHalfWidth * kPathHalfWidth / 14.0;
      t_.push_back(push.t[i]);
      tip_.push_back(tip.value - bias);
      force_.push_back(force[i]);
    }
  }

  static double mean_about(const std::vector<double>& values, std::size_t middle) {
    constexpr std::size_t kReach = 3;
    const std::size_t from = middle - std::min(middle, kReach);
    const std::size_t to = std::min(values.size(), middle + kReach + 1);
    double sum = 0.0;
    for (std::size_t i = from; i < to; ++i) sum += values[i];
    return sum / static_cast<double>(to - from);
  }

  [[nodiscard]] double excess_at(const Unknowns& theta) const {
    return priors_.excess * std::pow(priors_.excess_factor, theta[kLogExcess]);
  }
  [[nodiscard]] Eigen::Vector2d sliding_at(const Unknowns& theta) const {
    return object_.sliding + friction_factor_ * theta.segment<2>(kCoulomb);
  }
  /// [N] F_M, and its derivatives.
  [[nodiscard]] double limit_at(const Unknowns& theta) const {
    return sliding_at(theta)[0] * (1.0 + excess_at(theta));
  }
  [[nodiscard]] Unknowns limit_by(const Unknowns& theta) const {
    Unknowns by = Unknowns::Zero();
    by[kLogExcess] = sliding_at(theta)[0] * excess_at(theta) * std::log(priors_.excess_factor);
    by.segment<2>(kCoulomb) = (1.0 + excess_at(theta)) * friction_factor_.row(0).transpose();
    return by;
  }

  /// The object slid, so that the force has nearly reached the limit; and it has not exceeded it by
  /// more than an object under constant friction overshoots by. Moments of the truncated normal
  /// distribution [Johnson, Kotz & Balakrishnan 1994, ch. 13]; of the uniform one between the
  /// bounds where next to nothing of it remains.
  [[nodiscard]] IdentifiedParameter within_bounds(double limit, double std) const {
    const double low = (min_limit_ - limit) / std, high = (max_limit_ - limit) / std;
    const auto density = [](double x) {
      return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    };
    const double remaining =
        0.5 * (std::erfc(low / std::numbers::sqrt2) - std::erfc(high / std::numbers::sqrt2));
    if (!(remaining > kMinRemaining)) {
      return {0.5 * (min_limit_ + max_limit_), (max_limit_ - min_limit_) / std::sqrt(12.0), true};
    }
    const double shift = (density(low) - density(high)) / remaining;
    const double square =
        1.0 + (low * density(low) - high * density(high)) / remaining - shift * shift;
    return {limit + shift * std, std * std::sqrt(std::max(square, 0.0)), true};
  }

  /// Penetration [m] of the tip in the resting object, at unknowns in columns.
  template <int N>
  [[nodiscard]] Variants<N> tip_at(const Eigen::Matrix<double, kUnknowns, N>& thetas,
                                   std::size_t i) const {
    const double since = t_[i] - t_.front();
    return start_penetration_ * (1.0 + 0.01 * thetas.row(kPenetration).transpose().array()) +
           (tip_[i] - tip_.front()) + since * speed_std_ * thetas.row(kSpeed).transpose().array() +
           0.5 * since * since * acceleration_std_ * thetas.row(kAcceleration).transpose().array();
  }

  [[nodiscard]] HuntCrossley law_at(const Unknowns& theta) const {
    const HuntCrossley& known = object_.contact_law;
    // The swing depends on mass and compliance by their product.
    const double std = std::hypot(object_.compliance_std, object_.mass_std);
    HuntCrossley law = known;
    law.stiffness *= std::exp(-known.exponent * std * theta[kCompliance]);
    law.damping =
        law.stiffness * (known.damping / known.stiffness + object_.damping_std * theta[kDamping]);
    return law;
  }

  /// Friction at rest, presliding and sliding, without the viscous part: bristles that deflect,
  /// and slip at the Stribeck curve's level [LuGre model: Canudas de Wit et al. 1995].
  template <int N>
  struct Bristles {
    Variants<N> coulomb, excess;                  ///< [N] and of the limit over it
    Variants<N> speed;                            ///< [m/s] of Stribeck
    Variants<N> stiffness;                        ///< [N/m]
    Variants<N> damping;                          ///< [N s/m]
    Variants<N> deflected = Variants<N>::Zero();  ///< [N]

    Variants<N> step(const Variants<N>& v, double dt) {  // level: by stribeck_share of each
      const Variants<N> level = coulomb + excess * (-(v / speed).square()).exp();
      const Variants<N> before = deflected, scale = stiffness * dt;
      deflected = (deflected + scale * v) * level / (level + scale * v.abs());
      const Variants<N> fade = (-(v / kDampedSpeed).square()).exp();
      return deflected + damping / scale * fade * (deflected - before);
    }
  };

  /// The contact and the friction at unknowns in columns.
  template <int N>
  struct Laws {
    Variants<N> stiffness, damping;  ///< of the contact
    Variants<N> viscous;             ///< [N s/m]
    Bristles<N> bristles;
  };
  template <int N>
  [[nodiscard]] Laws<N> laws_at(const Eigen::Matrix<double, kUnknowns, N>& thetas) const {
    Laws<N> laws;
    for (int k = 0; k < N; ++k) {
      const Unknowns theta = thetas.col(k);
      const HuntCrossley contact = law_at(theta);
      laws.stiffness[k] = contact.stiffness;
      laws.damping[k] = contact.damping;
      laws.viscous[k] = sliding_at(theta)[1];
      Bristles<N>& bristles = laws.bristles;
      const double limit = limit_at(theta);
      const double stiffness =
          limit / (priors_.presliding * std::pow(priors_.presliding_factor, theta[kLogPresliding]));
      bristles.coulomb[k] = sliding_at(theta)[0];
      bristles.excess[k] = limit - sliding_at(theta)[0];
      bristles.speed[k] =
          object_.stribeck_speed * std::pow(priors_.stribeck_factor, theta[kLogStribeck]);
      bristles.stiffness[k] = stiffness;
      bristles.damping[k] = std::sqrt(stiffness * object_.mass);
    }
    return laws;
  }

  /// The contact's forces at the samples, from rest under the first one, at unknowns in columns.
  template <int N>
  [[nodiscard]] std::vector<Variants<N>> simulate(
      const Eigen::Matrix<double, kUnknowns, N>& thetas) const {
    const double exponent = object_.contact_law.exponent;
    Laws<N> laws = laws_at<N>(thetas);
    PowerAlongPath<N> power(exponent);
    Variants<N> v = Variants<N>::Zero(), s = Variants<N>::Zero();
    Variants<N> last = tip_at<N>(thetas, 0);
    Variants<N> contact = laws.stiffness * power.at(last.max(0.0));
    laws.bristles.deflected = contact;
    std::vector<Variants<N>> forces(t_.size(), contact);
    for (std::size_t i = 1; i < t_.size(); ++i) {
      const Variants<N> tip = tip_at<N>(thetas, i);
      const double span = t_[i] - t_[i - 1];
      const int steps = static_cast<int>(std::ceil(span / kMaxStep));
      const double dt = span / steps;
      for (int k = 1; k <= steps; ++k) {
        const Variants<N> depth =
            (last + (tip - last) * (static_cast<double>(k) / steps) - s).max(0.0);
        const Variants<N>& elastic = power.at(depth);
        const Variants<N> rate = (tip - last) / span - v;
        if (exponent == 1.0) {
          contact = (laws.stiffness * elastic + laws.damping * rate).max(0.0);
        } else {
          contact = (elastic * (laws.stiffness + laws.damping * rate)).max(0.0);
        }
        v += dt / object_.mass * (contact - laws.bristles.step(v, dt) - laws.viscous * v);
        s += dt * v;
      }
      forces[i] = contact;
      last = tip;
    }
    return forces;
  }

  /// Misfit of these forces at these unknowns.
  [[nodiscard]] double misfit(const Unknowns& theta, const std::vector<Variants<1>>& forces) const {
    double sum = theta.squaredNorm() - std::pow(theta[kPenetration], 2);
    for (std::size_t i = 0; i < forces.size(); ++i)
      sum += std::pow((force_[i] - forces[i][0]) / noise_, 2);
    return sum;
  }

  /// `forces` are those at these unknowns.
  void linearise(const Unknowns& theta, const std::vector<Variants<1>>& forces, Normal& normal,
                 Unknowns& gradient) const {
    Eigen::Matrix<double, kUnknowns, 2 * kUnknowns> thetas;
    thetas.colwise() = theta;
    thetas.template leftCols<kUnknowns>() += kDifference * Normal::Identity();
    thetas.template rightCols<kUnknowns>() -= kDifference * Normal::Identity();
    const std::vector<Variants<2 * kUnknowns>> beside = simulate<2 * kUnknowns>(thetas);
    normal.setIdentity();
    gradient = -theta;
    normal(kPenetration, kPenetration) = gradient[kPenetration] = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const Unknowns change =
          beside[i].template head<kUnknowns>() - beside[i].template tail<kUnknowns>();
      const Unknowns row = change / (2.0 * kDifference * noise_);
      normal += row * row.transpose();
      gradient += (force_[i] - forces[i][0]) / noise_ * row;
    }
  }

  /// The unknowns at which the search is, and the forces there.
  struct Place {
    Unknowns theta;
    std::vector<Variants<1>> forces;
    double misfit;
  };
  [[nodiscard]] Place at(const Unknowns& theta) const {
    Place place{theta, simulate<1>(theta), 0.0};
    place.misfit = misfit(theta, place.forces);
    return place;
  }

  /// Levenberg-Marquardt.
  [[nodiscard]] Place minimise() const {
    Normal normal;
    Unknowns gradient;
    Place place = at(Unknowns::Zero());
    double damping = 1e-3;
    for (int i = 0; i < kIterations && damping < kMaxDamping; ++i) {
      linearise(place.theta, place.forces, normal, gradient);
      for (; damping < kMaxDamping; damping *= 10.0) {
        Normal damped = normal;
        damped.diagonal() *= 1.0 + damping;
        Place candidate = at(place.theta + damped.llt().solve(gradient));
        if (!(candidate.misfit < place.misfit)) continue;
        const bool is_done = place.misfit - candidate.misfit < kConverged * place.misfit;
        place = std::move(candidate);
        damping *= 0.1;
        if (is_done) return place;
        break;
      }
    }
    return place;
  }

  const PushedObject& object_;
  const BreakawayPriors& priors_;
  Eigen::Matrix2d friction_factor_;
  std::vector<double> t_, tip_, force_;
  double noise_ = 0.0;                               ///< [N]
  double speed_std_ = 0.0, acceleration_std_ = 0.0;  ///< of the tip
  double start_penetration_ = 0.0;                   ///< [m]
  double min_limit_ = 0.0, max_limit_ = 0.0;         ///< [N]
};

}  // namespace

LimitOfMotion limit_by_motion(const ForceMotion& push, const Breakaway& breakaway,
                              const PushedObject& object, const BreakawayPriors& priors) {
  PCAVR_REQUIRE(priors.excess > 0.0 && priors.presliding > 0.0, priors.excess, priors.presliding);
  PCAVR_REQUIRE(object.mass > 0.0 && object.stribeck_speed > 0.0, object.mass);
  PCAVR_REQUIRE(object.contact_law.stiffness > 0.0, object.contact_law.stiffness);
  PCAVR_REQUIRE(object.sliding[0] > 0.0, object.sliding[0]);
  if (!breakaway.is_found || !(breakaway.force > 0.0)) return {};
  const BreakawayFit fit(push, breakaway, object, priors);
  return fit.is_usable() ? fit.solve() : LimitOfMotion{};
}

}  // namespace pcavr
