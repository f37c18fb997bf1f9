// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "results/evaluation/correction_metrics.hpp"
#include "results/evaluation/phase_timeline.hpp"

namespace pcavr {

inline Stamp at(double seconds) { return Stamp::from_seconds(seconds); }

inline PhaseTimeline timeline(const std::vector<std::pair<double, Phase>>& changes) {
  PhaseTimeline result;
  for (const auto& [seconds, phase] : changes) result.push_back({at(seconds), phase});
  return result;
}

/// Contact at 1 s, critical at 1.2 s, sliding from 1.5 to 2 s, left at 2.5 s; `delay` shifts all
/// but the first.
inline PhaseTimeline one_push(double delay = 0.0) {
  return timeline({{0.0, Phase::free},
                   {1.0 + delay, Phase::static_contact},
                   {1.2 + delay, Phase::critical},
                   {1.5 + delay, Phase::sliding},
                   {2.0 + delay, Phase::static_contact},
                   {2.5 + delay, Phase::free}});
}

/// A position error for each tenth of a second from 0 on.
inline std::vector<PoseError> errors_every_tenth(const std::vector<double>& metres) {
  std::vector<PoseError> errors;
  for (std::size_t i = 0; i < metres.size(); ++i) {
    errors.push_back({at(0.1 * static_cast<double>(i)), metres[i], 0.0});
  }
  return errors;
}

}  // namespace pcavr
