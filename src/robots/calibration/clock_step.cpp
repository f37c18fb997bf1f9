// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "clock_step.hpp"

#include <algorithm>
#include <cmath>

#include "clock_fit.hpp"
#include "step_scan.hpp"

namespace pcavr {
namespace {

constexpr double kMinSide = 3.0;   ///< [s] before a step, and after it
constexpr double kMinStds = 6.0;   ///< of a step: it is the best of many instants
constexpr double kMinStep = 5e-3;  ///< [s] less is jitter of the stamps

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
  ClockFit smooth(a, apart), stepping(a, apart);
  StepFit found{.clock = stepping.fit(
                    {.offset = start.before,
                     .drift = 0.0,
                     .step = ClockStep{.at = start.at, .size = start.after - start.before}})};
  if (!found.clock.is_observable) return std::nullopt;
  const double unit = stepping.loss_unit();
  (void)smooth.fit({.offset = without.offset, .drift = without.drift});
  const ClockStep& step = *found.clock.step;
  const double gain = std::max(smooth.mean_loss(unit) - stepping.mean_loss(unit), 0.0);
  // A step of this std explains so much more by chance.
  const double by_chance = step.std * step.std * stepping.step_information();
  found.stds = std::min(std::abs(step.size) / step.std, std::sqrt(gain / by_chance));
  return found;
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
  if (with_drift) return best->clock;
  best->clock.drift.reset();
  const VelocitySamples apart = without_instant(samples, best->clock.step->at, a.half_window());
  return ClockFit(a, apart).fit(best->clock);
}

}  // namespace pcavr
