// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Dense>

#include "identify_signals.hpp"

namespace pcavr {
namespace {

constexpr double kRange = 0.25;       // [s] as estimate_time_offset looks for
constexpr double kGrid = 0.010;       // [s] well below the time in which a contact is let go
constexpr double kHalfWidth = 0.016;  // [s] smoothing of both signals alike
// Two neighbours of the line between two of the tip's samples share one of them.
constexpr double kInterpolated = 2.0;
constexpr double kExponents[] = {1.0, 1.5, 2.0};
constexpr double kHold = 0.15;            // [s] of a push before it is let go
constexpr std::size_t kMaxSamples = 250;  // of a contact: more are not independent

/// Instants on the force's clock at which the object stands under the tip.
struct StandingContact {
  Eigen::Vector3d direction_base;
  std::vector<double> t;
  std::vector<double> smooth_force;  ///< [N]
  std::vector<double> force;         ///< [N] as measured
};

StandingContact standing(const ContactEpisode& episode) {
  StandingContact result{episode.direction_base, {}, {}, {}};
  const std::vector<SmoothedSample> f = smooth(episode.t, episode.force, episode.t, kHalfWidth);
  // A push is let go from its last high force on; before, the object may have moved.
  double from = episode.begin;
  const double low = 0.1 * episode.peak_force;
  if (episode.kind != ContactKind::press) {
    double held = 0.0;
    for (std::size_t i = f.size(); i-- > 0;) {
      if (!f[i].is_valid || episode.t[i] > episode.end) continue;
      if (f[i].value > held) held = f[i].value, from = episode.t[i];
      if (held > 0.3 * episode.peak_force && f[i].value < 0.9 * held) break;
      if (held > 0.3 * episode.peak_force && from - episode.t[i] > kHold) break;
    }
    from -= kHold;
  }
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (f[i].is_valid && episode.t[i] >= from && f[i].value > low) chosen.push_back(i);
  }
  const std::size_t step = chosen.size() / kMaxSamples + 1;
  for (std::size_t k = 0; k < chosen.size(); k += step) {
    result.t.push_back(episode.t[chosen[k]]);
    result.smooth_force.push_back(f[chosen[k]].value);
    result.force.push_back(std::max(0.0, episode.force[chosen[k]]));
  }
  return result;
}

struct Misfit {
  double squares = 0.0;  ///< [m^2] of the residuals
  double slopes = 0.0;   ///< [m^2/s^2] of q' that nothing else explains
  double pull = 0.0;     ///< [m^2/s] of the residual on it
  double motion = 0.0;   ///< [m^2] of q about its means
  double count = 0.0;
};

/// Smoothed, the best offset stands out of the noise; but where they bend, signals smoothed alike
/// keep to no power law, and on a stiff object, loaded in 10 ms, that makes 2 ms.
enum class Signals { smoothed, measured };

/// Everything but the offset is eliminated, contact by contact.
Misfit misfit(const std::vector<StandingContact>& contacts, const PathView& tip, double offset,
              double exponent, Signals signals) {
  Misfit total;
  for (const StandingContact& contact : contacts) {
    const auto n = static_cast<Eigen::Index>(contact.t.size());
    if (n < 12) continue;
    const bool is_smoothed = signals == Signals::smoothed;
    const std::vector<double>& force = is_smoothed ? contact.smooth_force : contact.force;
    Eigen::MatrixXd columns(n, 3);
    Eigen::VectorXd q(n), rate(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double at = contact.t[k] - offset;
      // The tip smoothed by differences over the same window as the force.
      double sum = 0.0, weights = 0.0, slope = 0.0, spread = 0.0;
      for (int j = -4; j <= 4; ++j) {
        const double u = j / 5.0;
        const double weight = (1.0 - u * u) * (1.0 - u * u);
        const double value = tip.at(at + u * kHalfWidth).dot(contact.direction_base);
        sum += weight * value, weights += weight;
        slope += (1.0 - u * u) * u * value, spread += (1.0 - u * u) * u * u;
      }
      q[i] = is_smoothed ? sum / weights : tip.at(at).dot(contact.direction_base);
      rate[i] = slope / (spread * kHalfWidth);
      const double depth = std::pow(force[k], 1.0 / exponent);
      columns.row(i) << 1.0, depth, depth * rate[i];
    }
    const auto solver = columns.colPivHouseholderQr();
    const Eigen::VectorXd left = q - columns * solver.solve(q);
    const Eigen::VectorXd slope = rate - columns * solver.solve(rate);
    total.squares += left.squaredNorm();
    total.slopes += slope.squaredNorm();
    total.pull += slope.dot(left);
    total.motion += (q.array() - q.mean()).matrix().squaredNorm();
    total.count += static_cast<double>(n) - 4.0;
  }
  return total;
}

/// Down the slope of the residual; false where the tip's pace tells nothing.
bool refine(const std::vector<StandingContact>& contacts, const PathView& tip, double exponent,
            Signals signals, double& offset) {
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Misfit at = misfit(contacts, tip, offset, exponent, signals);
    if (!(at.slopes > 0.0)) return false;
    // The residual is that of q(t - offset), which falls with the offset where q grows.
    offset += std::clamp(at.pull / at.slopes, -kGrid, kGrid);
  }
  return true;
}

/// With the exponent that what was measured keeps to best.
void refine_by_measured(const std::vector<StandingContact>& contacts, const PathView& tip,
                        double& offset, double& exponent) {
  const double start = offset;
  double least = std::numeric_limits<double>::infinity();
  for (const double n : kExponents) {
    double reached = start;
    if (!refine(contacts, tip, n, Signals::measured, reached)) continue;
    const double squares = misfit(contacts, tip, reached, n, Signals::measured).squares;
    if (squares >= least) continue;
    least = squares;
    offset = reached;
    exponent = n;
  }
}

}  // namespace

TimeOffset force_offset(const Segmentation& found, std::span<const double> t_force,
                        const PathView& tip) {
  TimeOffset result;
  // Presses tell it, being loaded and let go; pushes speak where there are none.
  const bool has_presses =
      std::any_of(found.contacts.begin(), found.contacts.end(),
                  [](const ContactEpisode& e) { return e.kind == ContactKind::press; });
  std::vector<StandingContact> contacts;
  for (const ContactEpisode& episode : found.contacts) {
    const bool is_press = episode.kind == ContactKind::press;
    if (!episode.t.empty() && is_press == has_presses) contacts.push_back(standing(episode));
  }
  double least = std::numeric_limits<double>::infinity();
  double exponent = 1.0;
  bool is_at_end = false;
  for (const double n : kExponents) {
    for (double offset = -kRange; offset < kRange + 0.5 * kGrid; offset += kGrid) {
      const Misfit at = misfit(contacts, tip, offset, n, Signals::smoothed);
      if (!(at.count > 0.0) || at.squares >= least) continue;
      least = at.squares;
      result.offset = offset;
      exponent = n;
      is_at_end = std::abs(offset) > kRange - 0.5 * kGrid;
    }
  }
  if (!std::isfinite(least)) return result;
  // A weak push is lost in the noise of what was measured.
  if (has_presses) {
    refine_by_measured(contacts, tip, result.offset, exponent);
  } else if (!refine(contacts, tip, exponent, Signals::smoothed, result.offset)) {
    return result;
  }
  const Signals signals = has_presses ? Signals::measured : Signals::smoothed;
  const Misfit at = misfit(contacts, tip, result.offset, exponent, signals);
  if (!(at.slopes > 0.0)) return result;
  // What is left of a press is noise; of a push it is creep, too.
  const double correlated =
      has_presses ? kInterpolated : correlated_samples(kHalfWidth, mean_interval(t_force));
  result.deviation = std::sqrt(at.squares / at.count * correlated / at.slopes);
  const Misfit trend = misfit(contacts, tip, result.offset, exponent, Signals::smoothed);
  result.correlation = std::sqrt(std::max(0.0, 1.0 - trend.squares / trend.motion));
  // Where nothing changes its pace under load, any offset would do.
  result.is_known = !is_at_end && result.correlation > 0.9 && result.deviation < 0.5 * kGrid;
  return result;
}

}  // namespace pcavr
