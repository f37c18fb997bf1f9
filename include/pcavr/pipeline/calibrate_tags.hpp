// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/perception/marker/tag_layout.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// What is known of tags before they are calibrated: those with a place, and those without.
struct TagFile {
  std::string format;  ///< as it was recognised: "apriltag_ros, 2 bundles"
  std::vector<MarkerEntry> markers = {};
  std::vector<std::pair<MarkerId, double>> unplaced = {};  ///< with their sizes [m]
};

/// Reads a file of pcavr (`markers:` of a recording or of a calibration), apriltag_ros's tags.yaml
/// (bundles and standalone tags), or TagSLAM's. `family` is that of the tags of the latter two,
/// which name none. A bundle or body named "base", or a static one, or the only one, is the base;
/// the others are objects. Errors name file, line and key.
[[nodiscard]] Expected<TagFile> read_tag_file(const std::filesystem::path& file,
                                              const std::string& family);

enum class TagFileFormat { pcavr, apriltag_ros, tagslam };

struct TagWalkInput {
  std::filesystem::path input;   ///< a recording, or a table of tag corners
  std::filesystem::path layout;  ///< a tag file, or empty: the recording's markers
  std::filesystem::path camera;  ///< a camera file, for a table of corners
  std::string family = "tag36h11";
  std::optional<double> size = {};      ///< [m] of the tags in view that nothing else names
  std::vector<std::string> fixed = {};  ///< "3" or "tag36h11:3": their stated poses are right
  bool skip_bad = false;
};

/// The tags that a walk's images show, and what is said of them.
struct TagWalk {
  CameraModel camera;
  std::vector<Stamp> stamps = {};
  std::vector<std::vector<TagDetection>> frames = {};
  TagFile known = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// Reads a recording, whose tags are detected, or a table `t, id, u0, v0, ..., u3, v3` (and
/// `family`) of corners [px] in the order of TagDetection, one row a tag and image.
[[nodiscard]] Expected<TagWalk> read_tag_walk(const TagWalkInput& input, const Observer& observer);

struct CalibratedBody {
  std::string name;  ///< of the object; empty: base
  TagLayout layout = {};
};

struct CalibratedTags {
  std::vector<CalibratedBody> bodies = {};
  std::vector<std::string> notes = {};  ///< for the user, the main ones first
};

/// The layout of each body that has two tags or more.
[[nodiscard]] Expected<CalibratedTags> calibrate_tags(const TagWalk& walk,
                                                      const TagWalkInput& input);

/// One sentence: what has moved, or that all agree.
[[nodiscard]] std::string describe_tags(const CalibratedTags& found);

/// The file in the given format. pcavr's is a calibration that recordings name (`calibration:`).
[[nodiscard]] std::string format_tags(const CalibratedTags& found, const TagWalkInput& input,
                                      TagFileFormat format);

/// Writes report.html and report.json, which has the same figures, to a folder.
[[nodiscard]] Expected<void> write_tags_report(const CalibratedTags& found, const TagWalk& walk,
                                               const std::string& report_json,
                                               const std::filesystem::path& folder);

}  // namespace pcavr
