// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

[[nodiscard]] std::vector<std::string> object_names(const Replay& replay);

/// A buffered text file in an OutputFolder. A full disk is an Error of the call that fails.
class StreamedFile {
 public:
  /// Creates the file and its parent folder.
  [[nodiscard]] Expected<void> open(const std::filesystem::path& file, std::string_view header);
  /// The buffer to which rows are appended; write_if_full() flushes it.
  [[nodiscard]] std::string& text() { return text_; }
  [[nodiscard]] Expected<void> write_if_full();
  [[nodiscard]] Expected<void> close();

 private:
  [[nodiscard]] Expected<void> write();

  std::filesystem::path file_;
  std::ofstream stream_;
  std::string text_;
};

/// objects/NAME/tracked.txt and tracking.csv of every object, frame by frame.
class TrackingWriter {
 public:
  [[nodiscard]] Expected<void> open(const std::filesystem::path& folder,
                                    const std::vector<std::string>& names);
  [[nodiscard]] Expected<void> add(std::size_t object, const ObjectObservation& seen);
  [[nodiscard]] Expected<void> close();

 private:
  std::vector<StreamedFile> tracked_;   ///< by object
  std::vector<StreamedFile> tracking_;  ///< by object
};

/// objects/NAME/predicted.txt of every object, force.csv, corrections.csv and parameters.csv,
/// streamed during a run.
class TeleopWriter {
 public:
  [[nodiscard]] Expected<void> open(const std::filesystem::path& folder,
                                    const std::vector<std::string>& names);
  /// A sink that writes to these files; the writer must outlive it.
  [[nodiscard]] TeleopSink sink();
  [[nodiscard]] Expected<void> add_shown(std::size_t object, const ShownPose& shown);
  [[nodiscard]] Expected<void> add_force(const ForceRow& row);
  [[nodiscard]] Expected<void> add_correction(const SentCorrection& sent);
  [[nodiscard]] Expected<void> add_parameter(const ParameterRow& row);
  [[nodiscard]] Expected<void> close();

 private:
  std::vector<std::string> names_;
  std::vector<StreamedFile> predicted_;  ///< by object
  StreamedFile forces_;
  StreamedFile corrections_;
  StreamedFile parameters_;
};

}  // namespace pcavr
