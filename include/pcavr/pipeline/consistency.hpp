// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

enum class FindingSeverity {
  warning,        ///< the result is less accurate than its figures state
  contradiction,  ///< the result would be meaningless
};

/// An input of a recording that disagrees with the others, or that can't be right.
struct ConsistencyFinding {
  FindingSeverity severity = FindingSeverity::warning;
  std::string file;        ///< in the recording: "recording.yaml", "groundtruth.txt"
  std::string place = {};  ///< key in it, "markers[0].size"; empty for the whole file
  std::string message;     ///< what disagrees with what, by what factor or distance
  std::string hint;        ///< what to check
  double factor = 1.0;     ///< >= 1, by which they disagree; 1 where it is no ratio
  std::size_t frames = 0;  ///< that show it; 0 where the files alone show it

  /// "markers[0].size: ...; check ...", in one line.
  [[nodiscard]] std::string to_string() const { return input() + ": " + message + "; " + hint; }
  /// The key, or the file where there is none.
  [[nodiscard]] const std::string& input() const { return place.empty() ? file : place; }
};

/// States how far a recording's inputs can show a wrong principal point or distortion, and what
/// such an error would do; nullopt where they always can, and without a camera.
[[nodiscard]] std::optional<std::string> unchecked_camera(const Manifest& manifest);

/// A tag, and in how many of the sampled frames it is in view.
struct SearchedTag {
  MarkerId id;
  bool is_declared = false;  ///< in recording.yaml
  std::size_t seen = 0;      ///< frames with the tag
  std::size_t frames = 0;    ///< that were searched for its family
};

/// When the families of tags that a recording does not declare are searched for.
enum class FamilySearch {
  where_missing,  ///< where no tag of base or of an object is in view, or none is declared
  always,         ///< a second or two longer
};

/// An input that `inspect` compared with another one, or could not.
struct InputComparison {
  std::string what;         ///< "poses of tags of base", "camera.fx, camera.fy"
  std::string figure = {};  ///< how well they agree
  std::string reason = {};  ///< why it was not compared; empty where it was
  /// What it compares: a finding whose input() contains one of these contradicts it.
  std::vector<std::string> inputs = {};

  [[nodiscard]] bool is_compared() const { return reason.empty(); }
};

/// Findings of a recording's inputs about each other.
struct InputReport {
  std::vector<ConsistencyFinding> findings;  ///< contradictions first
  std::vector<InputComparison> comparisons;  ///< without those that a finding contradicts
  /// The declared tags, in view or not, and all others that are; empty without images.
  std::vector<SearchedTag> tags = {};
};

[[nodiscard]] bool has_contradiction(const std::vector<ConsistencyFinding>& findings);

/// The first contradiction as an Error, which states how many more there are. Throws ContractError
/// where there is none.
[[nodiscard]] Error contradiction_error(const Recording& recording,
                                        const std::vector<ConsistencyFinding>& findings);

/// Cross-checks a recording's inputs, the images on a few of the frames: sizes and poses of tags,
/// depth scale, focal lengths, CAD bodies, camera poses, tracks, tool and force; and states what
/// was compared. An Error where a frame, a CAD file or the robot's description can't be read, or
/// its joints are not those of the log.
[[nodiscard]] Expected<InputReport> inspect_inputs(
    const Recording& recording, const PerceptionOptions& options = {},
    FamilySearch families = FamilySearch::where_missing);

}  // namespace pcavr
