// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "pcavr/teleoperation/link/link_clock.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

namespace pcavr {

/// Lead with which an operator's site sends over a link whose delay varies.
class LinkLeads {
 public:
  /// The references are kept. `clock` must know the link's delay. `step` [s]: between two commands.
  LinkLeads(const LinkClock& clock, const OperatorSiteOptions& options, double step)
      : clock_(clock), options_(options), step_(step) {}

  /// [s] Time from sending a command to its execution; empty while the link is not steady yet, so
  /// that the robot would wait for long.
  [[nodiscard]] std::optional<double> command_lead() const {
    const double early = variations() + options_.lead_margin;
    if (early > kMaxEarly) return std::nullopt;
    return 0.5 * clock_.mean_delay() + early;
  }

  /// [s] Time from the robot's cycle that composes a correction to the first command that contains
  /// it. It ends between two commands: their times' rounding must not decide.
  [[nodiscard]] double correction_delay(double command_lead) const {
    const double delay = command_lead + 0.5 * clock_.mean_delay() +
                         std::min(variations(), kMaxCorrectionWait) + options_.correction_margin;
    return step_ * (std::ceil(delay / step_) + 0.5);
  }

 private:
  static constexpr double kDelayVariations = 4.0;
  static constexpr double kMaxEarly = 0.4;  // [s] that commands may arrive early: below max_lead
  // [s] that corrections wait for others whose delay varies; later ones apply as they arrive.
  static constexpr double kMaxCorrectionWait = 0.05;

  [[nodiscard]] double variations() const { return kDelayVariations * clock_.delay_variation(); }

  const LinkClock& clock_;
  const OperatorSiteOptions& options_;
  double step_;
};

}  // namespace pcavr
