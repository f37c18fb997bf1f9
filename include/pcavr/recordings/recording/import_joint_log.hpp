// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"

namespace pcavr {

struct JointLogImportOptions {
  std::optional<double> period = {};  ///< [s] between rows, for logs without stamps; > 0
  bool skip_bad = false;              ///< leave out rows of a CSV file that can't be read
};

struct ImportedJointLog {
  JointLog log;
  std::size_t left_out = 0;  ///< rows whose stamp is not after the one before
  std::size_t bad = 0;       ///< rows that can't be read
};

/// Whether `source` looks like one of the layouts below.
[[nodiscard]] bool has_joint_log(const std::filesystem::path& source);

/// Reads the log of an arm from
///  - a CSV file without header: t, then five or three groups of n columns: q [rad], dq [rad/s],
///    motor current [A], and where there are five, desired current and torque (both left out);
///  - a folder with four files of one number a line: *positions.txt, *velocity.txt, *torques.txt
///    with n consecutive numbers a sample, and *time.txt with one [s];
///  - a CSV file with a header of q_NAME and tau_NAME, without t: needs the period.
[[nodiscard]] Expected<ImportedJointLog> import_joint_log(const std::filesystem::path& source,
                                                          const JointLogImportOptions& options);

}  // namespace pcavr
