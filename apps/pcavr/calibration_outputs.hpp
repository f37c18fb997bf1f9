// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"

namespace pcavr::app {

/// -o, --report and --force of `calibrate`.
struct CalibrationOutputOption {
  std::string file, report;
  bool replace = false;

  /// "wrote FILE", and how to open the report.
  [[nodiscard]] std::string written_lines() const;
};
/// How a recording takes the calibration: a line for the user.
[[nodiscard]] std::string how_to_use(const std::filesystem::path& calibration);

void add_calibration_output(CLI::App& command, CalibrationOutputOption& output);

/// The calibration and the report's folder, if one is wanted, before any work.
struct CalibrationOutputs {
  OutputFile file;
  std::optional<OutputFolder> report = {};

  /// Fails where an output overlaps an input, or can't be written.
  [[nodiscard]] static Expected<CalibrationOutputs> create(
      const CalibrationOutputOption& output, const std::vector<std::filesystem::path>& inputs);
  /// Writes the calibration, and by `write_report` the report where one is wanted, to a folder;
  /// commits both or none.
  [[nodiscard]] Expected<void> commit(
      const std::string& text,
      const std::function<Expected<void>(const std::filesystem::path&)>& write_report);
};

}  // namespace pcavr::app
