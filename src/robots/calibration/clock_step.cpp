// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "clock_step.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/doubted.hpp"

#include "clock_fit.hpp"
#include "step_scan.hpp"

namespace pcavr {
namespace {

constexpr double kMinSide = 3.0;     ///< [s] before a step, and after it
constexpr double kMinStds = 6.0;     ///< of a step: it is the best of many instants
constexpr double kMinStep = 5e-3;    ///< [s] less is jitter of the stamps
constexpr double kMinChance = 1e-4;  ///< [s] of a size: the convergence of the fits

/// Without those whose windows reach over the step.
VelocitySamples without_instant(const VelocitySamples& samples, double at, double half_window) {
  VelocitySamples kept;
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    if (std::abs(samples.t[i] - at) < half_window) continue;
    kept.t.push_back(samples.t[i]);
    kept.b.push_back(samples.b[i]);
  }
  return kept;
}

/// The step at an instant beside a clock that drifts and does not step.
struct StepFit {
  ClockOffset clock;
  double stds = 0.0;  ///< of the step, and of what it explains more
};

std::optional<StepFit> fit_step(const VelocitySignal& a, const VelocitySamples& samples,
                                const SteppedOffsets& start, const ClockOffset& without) {
  if (start.at - samples.t.front() < kMinSide || samples.t.back() - start.at < kMinSide) {
    return std::nullopt;
  }
  const VelocitySamples apart = without_instant(samples, start.at, a.half_window());
  if (apart.t.size() < 2 * kMinClockSamples) return std::nullopt;
  // A drift that no clock has would explain most of a step: then it is a rival of the step, not
  // what lies beside it.
  const bool is_rival = std::abs(without.drift.value_or(0.0)) > kMaxClockDrift;
  ClockFit smooth(a, apart), stepping(a, apart);
  ClockOffset stepped{.offset = start.before,
                      .step = ClockStep{.at = start.at, .size = start.after - start.before}};
  if (!is_rival) stepped.drift = 0.0;
  StepFit found{.clock = stepping.fit(stepped)};
  if (!found.clock.is_observable) return std::nullopt;
  const double unit = stepping.loss_unit();
  (void)smooth.fit({.offset = without.offset, .drift = without.drift});
  if (is_rival) {
    if (smooth.mean_loss(unit) < stepping.mean_loss(unit)) return std::nullopt;
    (void)smooth.fit({.offset = without.offset});
  }
  const ClockStep& step = *found.clock.step;
  const double gain = std::max(smooth.mean_loss(unit) - stepping.mean_loss(unit), 0.0);
  // A step of this std explains so much more by chance.
  const double by_chance = step.std * step.std * stepping.step_information();
  found.stds = std::min(std::abs(step.size) / step.std, std::sqrt(gain / by_chance));
  return found;
}

/// A drift beside the step changes its size by chance as much as it makes it less certain; what is
/// more comes of errors that are no noise, such as held samples.
void doubt_size(const ClockStep& straight, ClockStep& drifting) {
  const double variance = drifting.std * drifting.std - straight.std * straight.std;
  const double by_chance = std::sqrt(std::max(variance, kMinChance * kMinChance));
  drifting.std = std::hypot(drifting.std, doubted(drifting.size - straight.size, by_chance));
}

}  // namespace

std::optional<ClockOffset> find_clock_step(const VelocitySignal& a, const VelocitySamples& samples,
                                           const ClockOffset& start, bool with_drift) {
  std::optional<StepFit> best;
  for (const double drift : {0.0, start.drift.value_or(0.0)}) {
    const SteppedOffsets offsets = scan_for_step(a, samples, start.offset, drift);
    std::optional<StepFit> found = fit_step(a, samples, offsets, start);
    if (found && (!best || found->stds > best->stds)) best = std::move(found);
    if (!start.drift) break;
  }
  if (!best || best->stds < kMinStds || std::abs(best->clock.step->size) < kMinStep) {
    return std::nullopt;
  }
  const VelocitySamples apart = without_instant(samples, best->clock.step->at, a.half_window());
  best->clock.drift.reset();
  const ClockOffset straight = ClockFit(a, apart).fit(best->clock);
  if (!with_drift) return straight;
  best->clock.drift = 0.0;
  ClockOffset drifting = ClockFit(a, apart).fit(best->clock);
  if (drifting.step && straight.step) doubt_size(*straight.step, *drifting.step);
  return drifting;
}

}  // namespace pcavr
