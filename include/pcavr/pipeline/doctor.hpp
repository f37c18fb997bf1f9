// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/bag_import/bag_selection.hpp"
#include "pcavr/recordings/bag_import/bag_survey.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

enum class DiagnosisVerdict { agrees, disagrees, not_checked };

/// One check of the inputs.
struct DiagnosisRow {
  DiagnosisVerdict verdict = DiagnosisVerdict::agrees;
  std::string what;        ///< the input, as recording.yaml or the folder names it, or the check
  std::string figure;      ///< what was measured; where nothing could be checked, why not
  std::string cause = {};  ///< of a disagreement: the likely cause, and what to do
};

/// All checks of `pcavr doctor`, by verdict, and what to do next.
struct DiagnosisReport {
  std::vector<DiagnosisRow> rows;
  std::string next;  ///< a command line

  [[nodiscard]] bool has_disagreement() const;
};

/// Checks a recording: its streams' rates, gaps and clocks, tags and other images (in a few
/// frames), bodies, robot, force and contacts. An input that can't be read is a row, and the checks
/// that need it are not made. Thread-safe.
[[nodiscard]] DiagnosisReport diagnose_recording(const Recording& recording,
                                                 const PerceptionOptions& options = {});

/// Checks what `import` would take of a bag, or of a folder of tables: each topic's use, rate and
/// gaps, and what a recording would lack. Reads the bag once more. `selection` is that of the
/// survey.
[[nodiscard]] DiagnosisReport diagnose_bag(const std::filesystem::path& bag,
                                           const BagSurvey& survey, const BagSelection& selection);

/// Checks what a camera's file states of itself: field of view, square pixels, principal point.
[[nodiscard]] DiagnosisReport diagnose_camera(const std::filesystem::path& file,
                                              const CameraFile& content);

/// The report on a recording that can't be read even where its bad rows are left out: the first
/// error, and what could not be checked for it.
[[nodiscard]] DiagnosisReport diagnose_unreadable(const Error& error);
/// The same, for one of which the rest can be read: the error comes first.
void add_unreadable(const Error& error, DiagnosisReport& report);

/// The command line that imports the bag, with the options whose files the bag lacks.
[[nodiscard]] std::string import_command(const std::filesystem::path& bag,
                                         const BagSelection& selection);

}  // namespace pcavr
