// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/report/number_text.hpp"

#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

/// An object's errors during the phases for which `keep` is true.
template <typename Keep>
[[nodiscard]] std::vector<PoseError> errors_in(const std::vector<PoseError>& errors,
                                               const PhaseTimeline& timeline, Keep keep) {
  std::vector<PoseError> kept;
  for (const PoseError& error : errors) {
    const std::optional<Phase> phase = phase_at(timeline, error.stamp);
    if (phase && keep(*phase)) kept.push_back(error);
  }
  return kept;
}

[[nodiscard]] inline bool is_touched_or_moving(Phase phase) { return phase != Phase::free; }

/// Every predicted object's errors, in all phases.
[[nodiscard]] inline std::vector<PoseError> predicted_errors(const Findings& findings) {
  std::vector<PoseError> pooled;
  for (const ObjectFindings& object : findings.objects) {
    if (object.source != "predicted") continue;
    const std::vector<PoseError>& more = object.errors.absolute;
    pooled.insert(pooled.end(), more.begin(), more.end());
  }
  return pooled;
}

/// Every predicted object's errors during the phases for which `keep` is true.
template <typename Keep>
[[nodiscard]] std::vector<PoseError> predicted_errors_in(const Findings& findings, Keep keep) {
  std::vector<PoseError> pooled;
  for (const ObjectFindings& object : findings.objects) {
    if (object.source != "predicted" || !findings.run) continue;
    const std::vector<PoseError> more =
        errors_in(object.errors.absolute, findings.run->phases_of(object.name), keep);
    pooled.insert(pooled.end(), more.begin(), more.end());
  }
  return pooled;
}

/// Relative force errors in the phases static, critical and sliding, over all objects: of
/// RunFindings::forces or forces_with_parameters.
[[nodiscard]] inline std::vector<double> relative_force_errors(
    const std::map<std::string, ForceErrors>& forces) {
  std::vector<double> pooled;
  for (const auto& [object, errors] : forces) {
    const std::vector<double>& more = errors.in_contact.relative;
    pooled.insert(pooled.end(), more.begin(), more.end());
  }
  return pooled;
}

/// Mean and standard deviation of relative errors in percent: "2.1 ± 0.4"; the mean alone of one.
inline std::string mean_percent_text(const std::vector<double>& errors) {
  const ErrorStatistics stats = statistics(errors);
  const std::string mean = readable(kPercent * stats.mean);
  return errors.size() > 1 ? mean + " ± " + readable(kPercent * stats.std) : mean;
}

/// The text above, with the number of presses.
inline std::string press_errors_text(const std::vector<double>& errors) {
  return mean_percent_text(errors) + " % of " + std::to_string(errors.size()) +
         (errors.size() == 1 ? " press" : " presses");
}

}  // namespace pcavr
