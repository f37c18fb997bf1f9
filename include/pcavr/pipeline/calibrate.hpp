// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/bag_import/pose_list.hpp"
#include "pcavr/robots/calibration/clock_offset.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// A file or folder of poses, and how they become those that a calibration needs.
struct PoseInput {
  std::string path;
  PoseListOptions reading = {};
  bool is_inverted = false;               ///< the poses are those of the other frame in this one
  std::optional<int> mirrored_axis = {};  ///< 0 to 2: of left-handed frames, which is turned round
};

/// The views of both inputs, paired by number, or by stamps where both have them.
struct PairedPoses {
  std::vector<HandEyeView> views = {};
  std::optional<ClockOffset> clock = {};  ///< of CAMERA against ROBOT, where both have stamps
  std::vector<std::string> formats = {};  ///< how each input was recognised
  std::vector<std::string> notes = {};    ///< for the user
};

[[nodiscard]] Expected<PairedPoses> read_paired_poses(const PoseInput& robot,
                                                      const PoseInput& camera);

/// The streams of both inputs, cleaned, and the clock of the second against the first.
struct ComparedClocks {
  PoseStream a = {}, b = {};
  ClockOffset clock = {};
  std::vector<std::string> formats = {};
  std::vector<std::string> notes = {};
};
[[nodiscard]] Expected<ComparedClocks> compare_pose_clocks(const PoseInput& a, const PoseInput& b,
                                                           const ClockOffsetOptions& options);

/// The calibration files, in YAML; is_calibration_file() knows them by their first line.
[[nodiscard]] std::string format_hand_eye(const HandEyeResult& found, const PoseInput& robot,
                                          const PoseInput& camera);
[[nodiscard]] std::string format_clock(const ComparedClocks& found);
[[nodiscard]] bool is_calibration_file(const std::filesystem::path& file);

/// Writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_hand_eye_report(const HandEyeResult& found,
                                                   const PairedPoses& input,
                                                   const std::string& report_json,
                                                   const std::filesystem::path& folder);
[[nodiscard]] Expected<void> write_clock_report(const ComparedClocks& found,
                                                const std::string& report_json,
                                                const std::filesystem::path& folder);

}  // namespace pcavr
