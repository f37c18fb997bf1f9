// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"

namespace pcavr {

/// What is held against what. Everything that is there on both sides is compared.
struct EvaluationInput {
  /// A scene's or a run's folder (a truth folder will do, too), or a parameter file.
  std::filesystem::path subject;
  /// A recording's `truth` folder, or a second scene or run; for a parameter file also another one.
  /// Empty, for a run: its prediction is held against its own tracking, and the phases and forces
  /// that it predicted against those it measured.
  std::filesystem::path reference = {};
};

/// Compares and writes report.json and report.html (self-contained, plots inside) into a folder
/// that exists. Returns the text of report.json; its "headline" is a list of name, value and unit
/// for people, its other keys are flat and in SI units. The only place in the library that reads
/// truth/. The same bytes for any Parallelism.
///
/// An Error where a side is missing, is no folder of those kinds or holds a file that can't be
/// read, and where the two have nothing in common or no time in common. Objects that only the
/// reference has, and a recording that is not to be found, are warnings.
[[nodiscard]] Expected<std::string> evaluate(const EvaluationInput& input,
                                             const std::filesystem::path& report_folder,
                                             Parallelism parallelism,
                                             const Observer& observer = {});

/// The text of report.json alone; nothing is written.
[[nodiscard]] Expected<std::string> evaluation_figures(const EvaluationInput& input,
                                                       Parallelism parallelism,
                                                       const Observer& observer = {});

}  // namespace pcavr
