// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/results/evaluation/options.hpp"

namespace pcavr {

/// Input of a comparison. Everything that both sides have is compared.
struct EvaluationInput {
  /// A scene's, a run's or a truth folder, or a parameter file.
  std::filesystem::path subject;
  /// A recording's `truth` folder (ground truth), or a second scene or run; for a parameter file
  /// also another one. Empty, for a run: its prediction is compared with its own tracking, and its
  /// predicted phases and forces with the measured ones.
  std::filesystem::path reference = {};
  EvaluationOptions options = {};
  /// Options that differ from their defaults, for report.json: "section.key", value.
  std::vector<std::pair<std::string, std::string>> configuration = {};
};

/// Compares and writes report.json and report.html (write_report_page) into a folder that exists.
/// Returns the text of report.json; its "headline" is a list of metrics (name, value
/// and unit) for people, its other keys are flat and in SI units. The only place in the library
/// that reads truth/. The same bytes for any Parallelism.
///
/// An Error where a side is missing, is no folder of those kinds or has a file that can't be read,
/// and where the two have no data or no time span in common. Objects that only the reference has,
/// and a recording that is not found, are warnings.
[[nodiscard]] Expected<std::string> evaluate(const EvaluationInput& input,
                                             const std::filesystem::path& report_folder,
                                             Parallelism parallelism,
                                             const Observer& observer = {});

/// The text of report.json alone; nothing is written.
[[nodiscard]] Expected<std::string> evaluation_metrics(const EvaluationInput& input,
                                                       Parallelism parallelism,
                                                       const Observer& observer = {});

}  // namespace pcavr
