// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/jackknife.hpp"

#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

constexpr double kRange = 0.25;       // [s] as the search range of estimate_time_offset
constexpr double kGridStep = 0.010;   // [s] well below the time in which a contact is released
constexpr double kHalfWidth = 0.016;  // [s] smoothing of both signals
// Neighbouring linear interpolations of the tip's samples share one sample.
constexpr double kCorrelatedByInterpolation = 2.0;
constexpr double kExponents[] = {1.0, 1.5, 2.0};
constexpr double kBeforeRelease = 0.15;   // [s] of a push before its release that are used
constexpr std::size_t kMaxSamples = 250;  // of a contact: more are not independent
// A linear contact's force leads the tip by its damping over its stiffness, as an early clock
// would.
constexpr double kMaxLinearLead = 0.010;  // [s] real tissue: 4 ms
constexpr double kMinCorrelation = 0.9;   // of the tip with the law, where its offset is known
// Of one contact's delay [s]: its range; a std from which on the contact does not show it.
constexpr double kDriftRange = 0.6;
constexpr double kMaxDelayOfContactStd = 0.03;
constexpr std::size_t kEnoughPresses = 3;  // for a drift
// What the law does not explain of a delay [s]: in one contact, and in all of a body. A linear
// contact's damping looks like a lead; objects creep while a push is released.
constexpr double kPressStd = 0.001, kPressBias = 0.005;
constexpr double kReleaseStd = 0.005, kReleaseBias = 0.04;

/// Samples on the force's clock at which the object is at rest under the tip.
struct StationaryContact {
  Eigen::Vector3d direction_base;
  std::vector<double> t;
  std::vector<double> smooth_force;  ///< [N]
  std::vector<double> force;         ///< [N] as measured
};

/// The time at which the force of a push begins to fall for good: the object is at rest from then
/// on. A held push's largest force may be well before that, while it still slid.
double release_begin(const Contact& contact, const std::vector<SmoothedSample>& f) {
  constexpr double kContactShare = 0.3;  // of the peak: less is the tip leaving
  constexpr double kReleaseShare = 0.9;  // of the last force: less is its release
  const auto is_used = [&](std::size_t i) { return f[i].is_valid && contact.t[i] <= contact.end; };
  double last_force = 0.0, peak = contact.begin;
  for (std::size_t i = f.size(); i-- > 0;) {
    if (!is_used(i)) continue;
    if (f[i].value > last_force) last_force = f[i].value, peak = contact.t[i];
    if (last_force <= kContactShare * contact.peak_force) continue;
    if (f[i].value < kReleaseShare * last_force || peak - contact.t[i] > kBeforeRelease) break;
  }
  for (std::size_t i = f.size(); i-- > 0;) {
    if (is_used(i) && f[i].value >= kReleaseShare * last_force) return contact.t[i];
  }
  return contact.begin;
}

StationaryContact stationary_samples(const Contact& contact) {
  StationaryContact result{contact.direction_base, {}, {}, {}};
  const std::vector<SmoothedSample> f = smooth(contact.t, contact.force, contact.t, kHalfWidth);
  const bool is_press = contact.kind == ContactKind::press;
  const double from = is_press ? contact.begin : release_begin(contact, f) - kBeforeRelease;
  const double min_force = 0.1 * contact.peak_force;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (f[i].is_valid && contact.t[i] >= from && f[i].value > min_force) chosen.push_back(i);
  }
  const std::size_t step = chosen.size() / kMaxSamples + 1;
  for (std::size_t k = 0; k < chosen.size(); k += step) {
    result.t.push_back(contact.t[chosen[k]]);
    result.smooth_force.push_back(f[chosen[k]].value);
    result.force.push_back(std::max(0.0, contact.force[chosen[k]]));
  }
  return result;
}

/// Sums of a least-squares fit: the residual, and its gradient in the offset.
struct ResidualSums {
  double squares = 0.0;         ///< [m^2] of the residuals
  double rate_squares = 0.0;    ///< [m^2/s^2] of q' after elimination of the other parameters
  double gradient = 0.0;        ///< [m^2/s] of the residual in the offset
  double motion_squares = 0.0;  ///< [m^2] of q about its means
  double count = 0.0;
};

/// The signals that are compared. With smoothed ones the minimum is clear of the noise; but
/// smoothing distorts the power law where the signals are curved: a bias of 2 ms on a stiff object
/// that is loaded in 10 ms.
enum class Signals { smoothed, measured };

/// One contact's series at one offset: position and speed of the tip along the contact's direction,
/// and F^(1/n) of the force.
struct ContactSeries {
  Eigen::VectorXd q;            ///< [m]
  Eigen::VectorXd rate;         ///< [m/s]
  Eigen::VectorXd penetration;  ///< [N^(1/n)]
};

ContactSeries series_at(const StationaryContact& contact, const PathView& tip, double offset,
                        double exponent, Signals signals) {
  const auto n = static_cast<Eigen::Index>(contact.t.size());
  const bool is_smoothed = signals == Signals::smoothed;
  const std::vector<double>& force = is_smoothed ? contact.smooth_force : contact.force;
  ContactSeries series{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double at = contact.t[k] - offset;
    // The tip smoothed by differences over the same window as the force.
    double sum = 0.0, weights = 0.0, slope = 0.0, slope_weights = 0.0;
    for (int j = -4; j <= 4; ++j) {
      const double u = j / 5.0;
      const double weight = (1.0 - u * u) * (1.0 - u * u);
      const double value = tip.at(at + u * kHalfWidth).dot(contact.direction_base);
      sum += weight * value, weights += weight;
      slope += (1.0 - u * u) * u * value, slope_weights += (1.0 - u * u) * u * u;
    }
    series.q[i] = is_smoothed ? sum / weights : tip.at(at).dot(contact.direction_base);
    series.rate[i] = slope / (slope_weights * kHalfWidth);
    series.penetration[i] = static_penetration({.stiffness = 1.0, .exponent = exponent}, force[k]);
  }
  return series;
}

/// Fits q = q_0 + a F^(1/n) (1 + c q')^(-1/n) to one contact: Hunt and Crossley's law, F = k d^n (1
/// + c d'), solved for the penetration. Returns the columns of its last linearisation in q_0, a and
/// c. The first order in c alone is not enough: of a penetration of 8 mm at 60 mm/s it leaves out
/// 0.2 mm, or 3 ms.
Eigen::MatrixXd linearised(const ContactSeries& series, double exponent) {
  constexpr int kFitIterations = 4;
  constexpr double kMaxChange = 0.6;  // of the force by damping: beyond, the law has no inverse
  Eigen::MatrixXd columns(series.q.size(), 3);
  columns.col(0).setOnes();
  const double max_rate = std::max(series.rate.cwiseAbs().maxCoeff(), 1e-6);
  double damping = 0.0;  // c [s/m]
  for (int i = 0; i < kFitIterations; ++i) {
    const Eigen::ArrayXd factor = 1.0 + damping * series.rate.array();
    columns.col(1) = series.penetration.array() * factor.pow(-1.0 / exponent);
    columns.col(2) = columns.col(1).array() * series.rate.array() / factor;
    if (i + 1 == kFitIterations) break;
    const Eigen::Vector3d x = columns.colPivHouseholderQr().solve(series.q);
    if (!(std::abs(x[1]) > 0.0)) break;
    const double next = damping - exponent * x[2] / x[1];
    damping = std::clamp(next, -kMaxChange / max_rate, kMaxChange / max_rate);
  }
  return columns;
}

/// Eliminates all parameters but the offset, contact by contact (variable projection).
ResidualSums residual_sums(const std::vector<StationaryContact>& contacts, const PathView& tip,
                           double offset, double exponent, Signals signals) {
  ResidualSums total;
  for (const StationaryContact& contact : contacts) {
    if (contact.t.size() < 12) continue;
    const ContactSeries series = series_at(contact, tip, offset, exponent, signals);
    const Eigen::MatrixXd columns = linearised(series, exponent);
    const auto solver = columns.colPivHouseholderQr();
    const Eigen::VectorXd residual = series.q - columns * solver.solve(series.q);
    const Eigen::VectorXd rate_residual = series.rate - columns * solver.solve(series.rate);
    total.squares += residual.squaredNorm();
    total.rate_squares += rate_residual.squaredNorm();
    total.gradient += rate_residual.dot(residual);
    total.motion_squares += (series.q.array() - series.q.mean()).matrix().squaredNorm();
    total.count += static_cast<double>(series.q.size()) - 4.0;
  }
  return total;
}

/// Gauss-Newton in the offset; false where the tip's speed does not determine it.
bool refine(const std::vector<StationaryContact>& contacts, const PathView& tip, double exponent,
            Signals signals, double& offset) {
  for (int iteration = 0; iteration < 4; ++iteration) {
    const ResidualSums at = residual_sums(contacts, tip, offset, exponent, signals);
    if (!(at.rate_squares > 0.0)) return false;
    // The residual is that of q(t - offset), which decreases with the offset where q increases.
    offset += std::clamp(at.gradient / at.rate_squares, -kGridStep, kGridStep);
  }
  return true;
}

/// Refines offset and exponent on the measured signals: the exponent with the smallest residual.
void refine_by_measured(const std::vector<StationaryContact>& contacts, const PathView& tip,
                        double& offset, double& exponent) {
  const double start = offset;
  double min_squares = std::numeric_limits<double>::infinity();
  for (const double n : kExponents) {
    double refined = start;
    if (!refine(contacts, tip, n, Signals::measured, refined)) continue;
    const double squares = residual_sums(contacts, tip, refined, n, Signals::measured).squares;
    if (squares >= min_squares) continue;
    min_squares = squares;
    offset = refined;
    exponent = n;
  }
}

/// Std of the offset by leaving out contacts: what moves in each of them is no noise of the
/// sensors.
double std_between(const std::vector<StationaryContact>& contacts, const PathView& tip,
                   double exponent, Signals signals, double offset) {
  const std::size_t groups = jackknife_groups(contacts.size());
  std::vector<double> without;
  for (std::size_t group = 0; group < groups; ++group) {
    std::vector<StationaryContact> kept;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (jackknife_group(i, contacts.size()) != group) kept.push_back(contacts[i]);
    }
    double refined = offset;
    if (refine(kept, tip, exponent, signals, refined)) without.push_back(refined);
  }
  const bool is_known = without.size() > 1;
  return is_known ? jackknife_std(without) : std::numeric_limits<double>::infinity();
}

/// The delay of the force in one contact; empty where its force does not show it.
std::optional<PressDelay> delay_of(const Contact& contact, const PathView& tip) {
  const std::vector<StationaryContact> one{stationary_samples(contact)};
  const bool is_press = contact.kind == ContactKind::press;
  double min_squares = 1.0 - kMinCorrelation * kMinCorrelation;
  std::optional<PressDelay> found;
  double exponent = 1.0;
  for (const double n : kExponents) {
    for (double delay = -kDriftRange; delay <= kDriftRange; delay += kGridStep) {
      const ResidualSums at = residual_sums(one, tip, delay, n, Signals::smoothed);
      const double squares = at.squares / at.motion_squares;
      if (!(at.count > 0.0) || !(squares < min_squares)) continue;
      min_squares = squares;
      exponent = n;
      found = PressDelay{0.5 * (one[0].t.front() + one[0].t.back()), delay, 0.0,
                         is_press ? kPressBias : kReleaseBias};
    }
  }
  if (!found || std::abs(found->delay) > kDriftRange - 2.0 * kGridStep) return std::nullopt;
  if (!refine(one, tip, exponent, Signals::smoothed, found->delay)) return std::nullopt;
  const ResidualSums at = residual_sums(one, tip, found->delay, exponent, Signals::smoothed);
  if (!(at.rate_squares > 0.0)) return std::nullopt;
  const double correlated = correlated_samples(kHalfWidth, mean_interval(one[0].t));
  found->std = std::hypot(std::sqrt(at.squares / at.count * correlated / at.rate_squares),
                          is_press ? kPressStd : kReleaseStd);
  if (found->std > kMaxDelayOfContactStd) return std::nullopt;
  return found;
}

}  // namespace

std::vector<PressDelay> press_delays(const Segmentation& found, const PathView& tip) {
  std::vector<PressDelay> presses, releases;
  for (const Contact& contact : found.contacts) {
    if (contact.t.empty() || contact.impact) continue;
    const auto delay = delay_of(contact, tip);
    if (delay) (contact.kind == ContactKind::press ? presses : releases).push_back(*delay);
  }
  return presses.size() >= kEnoughPresses ? presses : releases;
}

TimeOffset force_offset(const Segmentation& found, std::span<const double> t_force,
                        const PathView& tip) {
  TimeOffset result;
  // Presses determine it best, by loading and release; pushes are used where there are none.
  const bool has_presses =
      std::any_of(found.contacts.begin(), found.contacts.end(),
                  [](const Contact& e) { return e.kind == ContactKind::press && !e.impact; });
  std::vector<StationaryContact> contacts;
  for (const Contact& contact : found.contacts) {
    const bool is_press = contact.kind == ContactKind::press;
    if (!contact.t.empty() && !contact.impact && is_press == has_presses)
      contacts.push_back(stationary_samples(contact));
  }
  double min_squares = std::numeric_limits<double>::infinity();
  double exponent = 1.0;
  bool is_at_end = false;
  for (const double n : kExponents) {
    for (double offset = -kRange; offset < kRange + 0.5 * kGridStep; offset += kGridStep) {
      const ResidualSums at = residual_sums(contacts, tip, offset, n, Signals::smoothed);
      // Next to its short release a push is held: there any force explains a tip at rest.
      const double squares = has_presses ? at.squares : at.squares / at.motion_squares;
      if (!(at.count > 0.0) || !(squares < min_squares)) continue;
      min_squares = squares;
      result.offset = offset;
      exponent = n;
      is_at_end = std::abs(offset) > kRange - 0.5 * kGridStep;
    }
  }
  if (!std::isfinite(min_squares)) return result;
  // For a weak push, the measured signals are too noisy.
  if (has_presses) {
    refine_by_measured(contacts, tip, result.offset, exponent);
  } else if (!refine(contacts, tip, exponent, Signals::smoothed, result.offset)) {
    return result;
  }
  const Signals signals = has_presses ? Signals::measured : Signals::smoothed;
  const ResidualSums at = residual_sums(contacts, tip, result.offset, exponent, signals);
  if (!(at.rate_squares > 0.0)) return result;
  // The residual of a press is noise; that of a push contains creep, too.
  const double correlated = has_presses ? kCorrelatedByInterpolation
                                        : correlated_samples(kHalfWidth, mean_interval(t_force));
  result.std = std::sqrt(at.squares / at.count * correlated / at.rate_squares);
  if (!has_presses) {
    result.std = std::max(result.std, std_between(contacts, tip, exponent, signals, result.offset));
  }
  const ResidualSums trend =
      residual_sums(contacts, tip, result.offset, exponent, Signals::smoothed);
  result.correlation = std::sqrt(std::max(0.0, 1.0 - trend.squares / trend.motion_squares));
  const bool may_be_damping = has_presses && exponent == kExponents[0] && result.offset < 0.0 &&
                              result.offset > -kMaxLinearLead;
  // At constant speed under load, any offset would fit.
  result.is_known = !is_at_end && !may_be_damping && result.correlation > kMinCorrelation &&
                    result.std < 0.5 * kGridStep;
  return result;
}

}  // namespace pcavr
