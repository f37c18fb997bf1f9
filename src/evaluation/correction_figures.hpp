// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/evaluation/trajectory_errors.hpp"

#include "run_files.hpp"

namespace pcavr {

/// A prediction nearer than this is good [paper C's position threshold, from what its markers and
/// camera resolve] [m].
inline constexpr double kGoodPosition = 0.003;

struct CorrectionCounts {
  std::size_t count = 0;
  std::size_t lost = 0;
  std::size_t bytes = 0;  ///< of all that were sent, lost ones too
  std::map<std::string, std::size_t> by_case;
  std::map<std::string, std::size_t> by_what;  ///< one correction may count in several
};
[[nodiscard]] CorrectionCounts count_corrections(const std::vector<RunCorrection>& corrections);

/// The error of what the operator saw [m], around one correction.
struct CorrectionEffect {
  std::optional<double> error_then;  ///< at the instant that it speaks of, or the next known
  /// From that instant until the error is below kGoodPosition [s]. Empty where it never is.
  std::optional<double> seconds_until_good;
};

/// `shown` are the object's position errors over time. Nothing happens in less than the round trip:
/// what is shown stands for the instant at which the command reaches the robot.
[[nodiscard]] CorrectionEffect effect_of(const RunCorrection& correction,
                                         const std::vector<PoseError>& shown);

/// How the prediction of one object came right.
struct Settling {
  bool begins_good = false;  ///< the first error is below kGoodPosition
  /// Corrections that had arrived when the error first was below kGoodPosition, and that moment,
  /// from the first pose on [s]. Empty where it never was.
  std::optional<std::size_t> corrections_until_good;
  std::optional<double> seconds_until_good;
  /// Corrections that had arrived when the error last was above: after these it stayed good. Empty
  /// where the last error is above.
  std::optional<std::size_t> corrections_until_settled;
};

/// A correction arrives `round_trip` after the instant it speaks of; lost ones never do.
[[nodiscard]] Settling settling_of(const std::string& object,
                                   const std::vector<RunCorrection>& corrections,
                                   const std::vector<PoseError>& shown, Duration round_trip);

}  // namespace pcavr
