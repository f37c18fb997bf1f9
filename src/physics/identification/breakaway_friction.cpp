// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/sliding.hpp"

namespace pcavr {
namespace {

constexpr double kTwoStds = 4.0;        // increase of chi squared at two stds
constexpr double kRestLookback = 0.15;  // [s] before the peak: the object still rests there

struct Track {
  std::span<const double> t;
  std::vector<double> force;   ///< [N] despiked
  std::vector<double> object;  ///< [m] tool less penetration
};

/// Fits an object that is at rest until `onset`, then moves by M s'' = F - friction, with the
/// measured F integrated twice; the rest position and the friction are found by least squares.
/// Returns the sum of squares over [begin, end).
double misfit(const Track& track, std::size_t begin, std::size_t onset, std::size_t end,
              double mass) {
  double n = 0.0, q = 0.0, qq = 0.0, y = 0.0, qy = 0.0, yy = 0.0;
  double speed = 0.0, displacement = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    double column = 0.0;
    if (i > onset) {
      const double dt = track.t[i] - track.t[i - 1];
      const double before = speed;
      speed += 0.5 * dt * (track.force[i] + track.force[i - 1]) / mass;
      displacement += 0.5 * dt * (speed + before);
      const double since = track.t[i] - track.t[onset];
      column = -0.5 * since * since / mass;
    }
    const double rest = track.object[i] - displacement;
    n += 1.0, q += column, qq += column * column, y += rest, qy += column * rest, yy += rest * rest;
  }
  const double spread = qq - q * q / n;
  const double cross = qy - q * y / n;
  return yy - y * y / n - (spread > 0.0 ? cross * cross / spread : 0.0);
}

}  // namespace

IdentifiedParameter friction_at_breakaway(const ForceMotion& push, const Breakaway& breakaway,
                                          const HuntCrossley& contact_law, double mass,
                                          const OnsetOptions& options) {
  PCAVR_REQUIRE(mass > 0.0, mass);
  PCAVR_REQUIRE(options.half_width > 0.0 && options.rest_time > 0.0);
  IdentifiedParameter friction;
  if (!breakaway.is_found) return friction;
  Track track{push.t, remove_spikes(push.force).values, {}};
  track.object = penetration_from_force(push.t, track.force, contact_law);
  for (std::size_t i = 0; i < track.object.size(); ++i) {
    track.object[i] = push.tool[i] - track.object[i];
  }
  const std::vector<SmoothedSample> x = smooth(push.t, track.object, push.t, options.half_width);
  const auto index = [&](double at) {
    return static_cast<std::size_t>(std::lower_bound(push.t.begin(), push.t.end(), at) -
                                    push.t.begin());
  };
  // The last rest before the object is surely moving, searched back from the peak's end.
  std::size_t moving = std::min(index(breakaway.t_decided), push.t.size() - 1);
  const std::size_t touched = index(breakaway.t_contact);
  const std::size_t reference = index(std::max(breakaway.t_contact, breakaway.t - kRestLookback));
  if (!x[reference].is_valid) return friction;
  const auto is_moving = [&](std::size_t i) {
    return !(x[i].value - x[reference].value < options.min_displacement);
  };
  while (moving > touched && is_moving(moving - 1)) --moving;
  const std::size_t first = std::max(touched, index(push.t[moving] - 2.0 * options.rest_time));
  const std::size_t begin = std::max(touched, index(push.t[moving] - 3.0 * options.rest_time));
  const std::size_t end = std::min(push.t.size(), index(push.t[moving] + options.moving_time));
  if (end < first + 10 || moving <= first + 2) return friction;

  std::vector<double> sums;
  for (std::size_t onset = first; onset < moving; ++onset) {
    sums.push_back(misfit(track, begin, onset, end, mass));
  }
  const auto best = std::min_element(sums.begin(), sums.end());
  const std::size_t onset = first + static_cast<std::size_t>(best - sums.begin());
  const SmoothedSample force = smooth_at(push.t, track.force, push.t[onset], options.half_width);
  const double variance = *best / static_cast<double>(end - begin - 3);
  double late = 0.0;  // the farthest onset within two stds
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (sums[k] > *best + kTwoStds * variance) continue;
    late = std::max(late, std::abs(push.t[first + k] - push.t[onset]));
  }
  friction.value = force.value;
  friction.std = std::hypot(breakaway.std, 0.5 * late * std::abs(force.rate),
                            options.creep_share * (breakaway.force - force.value));
  friction.is_excited = force.is_valid;
  return friction;
}

double inertial_overshoot(const Breakaway& breakaway, double mass) {
  if (!(breakaway.stiffness > 0.0)) return 0.0;
  return std::max(0.0, breakaway.loading_rate) * std::sqrt(mass / breakaway.stiffness);
}

IdentifiedParameter limit_of_push(const ForceMotion& push, const Breakaway& breakaway,
                                  const std::optional<HuntCrossley>& contact_law, double mass,
                                  const OnsetOptions& options) {
  PCAVR_REQUIRE(mass > 0.0, mass);
  if (!breakaway.is_found) return {};
  const double excess = inertial_overshoot(breakaway, mass);
  if (contact_law && excess > options.max_acceleration_share * breakaway.force) {
    const IdentifiedParameter limit =
        friction_at_breakaway(push, breakaway, *contact_law, mass, options);
    if (limit.is_excited) return limit;
  }
  return {breakaway.force - 0.5 * excess, std::hypot(breakaway.std, excess / std::sqrt(12.0)),
          true};
}

}  // namespace pcavr
