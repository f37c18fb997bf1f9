// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// One object at one instant, as it was and as the operator's site had predicted it.
struct SiteComparison {
  double t = 0.0;
  bool robot_slides = false, operator_slides = false;
  bool robot_touches = false, operator_touches = false;
  double robot_force = 0.0, operator_force = 0.0;  ///< along the push [N]
  std::optional<double> position_gap = {};         ///< [m]; where the robot knows it at t
  double position_sigma = 0.0;                     ///< of what the robot knows [m]
};

struct SwitchOptions {
  double force_tolerance = 0.10;      ///< share of the real force
  double force_floor = 0.3;           ///< [N] least difference: the sensor's noise and drift
  double position_tolerance = 0.003;  ///< [m] the most that is let pass
  double round_trip = 0.4;            ///< [s]
};

/// The correction switch of one object [paper C; methods of section 5]: says which case, if any,
/// calls for a correction now.
///
/// Thresholds adapt. Position: three deviations of what the robot knows of the place, at least 0.5
/// mm, times 1 to 3 as the traffic exceeds its budget, at most `position_tolerance`. Force: 10 % of
/// the real one, at least `force_floor`, times the same. A difference counts when it has stood for
/// 30 to 60 ms, longer than the two sites' clocks of a phase may be apart. While a correction is on
/// its way (a round trip and a margin), the same case is not sent again unless it has doubled.
class CorrectionSwitch {
 public:
  explicit CorrectionSwitch(const SwitchOptions& options) : options_(options) {}

  /// `traffic` is what corrections have cost so far, over what they may. Instants ascend.
  [[nodiscard]] std::optional<CorrectionCase> judge(const SiteComparison& seen, double traffic);
  /// A correction of that case left at `t_sent` [s].
  void note_sent(CorrectionCase which, double t_sent);
  /// Nothing new was there to say of that case: it is asked for again a tenth of a second later.
  void note_silent(CorrectionCase which, double t);

 private:
  struct Finding {
    CorrectionCase which;
    double size;         ///< over its threshold: > 1
    double persistence;  ///< [s]
  };
  [[nodiscard]] std::optional<Finding> find(const SiteComparison& seen, double factor) const;

  /// One case: since when it has stood, with lapses shorter than a flicker; and what was sent.
  struct Matter {
    double since = 0.0;
    double last = -1e300;
    double size = 0.0;
    double on_its_way_until = -1e300;
    double silent_until = -1e300;
    double size_sent = 0.0;
  };

  SwitchOptions options_;
  std::array<Matter, 5> matters_{};
};

}  // namespace pcavr
