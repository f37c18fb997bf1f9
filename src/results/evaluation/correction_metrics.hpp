// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include "run_files.hpp"

namespace pcavr {

/// [m] Tolerance of a prediction's position: paper C's threshold, from the resolution of its
/// markers and camera. Part of the metrics' definition, and named in the report: no option.
inline constexpr double kPositionTolerance = 0.003;

struct CorrectionCounts {
  std::size_t count = 0;
  std::size_t lost = 0;
  std::size_t bytes = 0;  ///< of all that were sent, lost ones too
  std::map<std::string, std::size_t> by_case;
  std::map<std::string, std::size_t> by_what;  ///< one correction may count in several
};
[[nodiscard]] CorrectionCounts count_corrections(const std::vector<RunCorrection>& corrections);

/// When the operator's site first receives parameters of the object; nothing where it never does.
[[nodiscard]] std::optional<Stamp> first_parameters(const std::string& object,
                                                    const std::vector<RunCorrection>& corrections,
                                                    Duration round_trip);

/// The error of what the operator saw [m], around one correction.
struct CorrectionEffect {
  std::optional<double> initial_error;  ///< at the corrected time, or the next known
  /// Recovery time: from then until the error is below kPositionTolerance [s]. Empty where it never
  /// is.
  std::optional<double> seconds_to_tolerance;
};

/// `errors` are the object's position errors over time. A correction has no effect before the round
/// trip: the prediction is for the instant at which the command reaches the robot.
[[nodiscard]] CorrectionEffect effect_of(const RunCorrection& correction,
                                         const std::vector<PoseError>& errors);

/// Convergence of one object's prediction (settling time).
struct Settling {
  bool starts_in_tolerance = false;  ///< the first error is below kPositionTolerance
  /// Corrections that had arrived when the error first was below kPositionTolerance, and that time
  /// from the first pose on [s]. Empty where it never was.
  std::optional<std::size_t> corrections_to_tolerance;
  std::optional<double> seconds_to_tolerance;
  /// Corrections that had arrived when the error last was above: it stayed below after these. Empty
  /// where the last error is above.
  std::optional<std::size_t> corrections_until_settled;
};

/// A correction arrives `round_trip` after the time that it corrects; lost ones never do.
[[nodiscard]] Settling settling_of(const std::string& object,
                                   const std::vector<RunCorrection>& corrections,
                                   const std::vector<PoseError>& errors, Duration round_trip);

}  // namespace pcavr
