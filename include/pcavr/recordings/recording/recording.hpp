// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// A colour and a depth image paired by time; the files are not opened yet.
struct FrameFiles {
  Stamp color_stamp;
  std::filesystem::path color_path;
  Stamp depth_stamp;                 ///< that of the colour image where there is no depth
  std::filesystem::path depth_path;  ///< empty without depth
};

/// Force and torque that the tool exerts on the environment, at the tool tip, in base axes.
struct WrenchSample {
  Stamp stamp;
  Eigen::Vector3d force;   ///< [N]
  Eigen::Vector3d torque;  ///< [N m]
};

/// One row of `joints.csv`; velocity and torque are empty where the file has no such columns.
struct JointSample {
  Stamp stamp;
  std::vector<double> position;  ///< [rad]
  std::vector<double> velocity;  ///< [rad/s]
  std::vector<double> torque;    ///< [N m]
};

/// The number of rows of one file that were skipped for one reason, with ReadOptions::skip_bad.
struct SkippedRows {
  std::string file;  ///< relative to the recording's folder
  std::string reason;
  std::size_t count = 0;  ///< rows, or images for the lists
};

/// The content of a recording. Images are decoded later, by a FrameReader.
struct Recording {
  std::filesystem::path folder;
  Manifest manifest;
  std::vector<FrameFiles> frames;  ///< paired by time, ascending
  /// False where there are colour images alone, in which tags are found and nothing else.
  bool has_depth = true;
  std::size_t unpaired_color = 0;  ///< colour images with no depth image close enough in time
  std::size_t unpaired_depth = 0;
  Trajectory groundtruth;  ///< T_base_camera; empty where the file is absent
  Trajectory tool;         ///< T_base_tool
  std::vector<WrenchSample> wrench;
  std::vector<JointSample> joints;
  std::vector<SkippedRows> left_out;  ///< rows, by ReadOptions::skip_bad; file by file
  std::vector<std::string> warnings;  ///< for the user, one line each
  std::vector<std::string> notes;     ///< what was put right in the streams, one line each

  /// The sum over all files and reasons.
  [[nodiscard]] std::size_t skipped_rows() const;
};

/// See src/recordings/recording/options.cpp for meanings, ranges and defaults.
struct ReadOptions {
  ReadOptions();

  /// Skip and count bad rows and frames instead of failing at the first.
  bool skip_bad = false;
  double max_pair_gap;  ///< [s]
};

/// The options "recording".
[[nodiscard]] OptionSection section_of(ReadOptions& options);

/// Reads a recording folder strictly. Samples that a controller repeated are left out, with a note
/// (held_samples.hpp). Every error names file, line and hint. Thread-safe.
[[nodiscard]] Expected<Recording> read_recording(const std::filesystem::path& folder,
                                                 const ReadOptions& options = {});

/// Reads a TUM trajectory `t tx ty tz qx qy qz qw`, `#` starting a comment.
[[nodiscard]] Expected<Trajectory> read_trajectory(const std::filesystem::path& file);

/// The text of a TUM trajectory, with a comment line that names the columns.
[[nodiscard]] std::string format_trajectory(const Trajectory& trajectory);

}  // namespace pcavr
