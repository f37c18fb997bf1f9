// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "input_comparisons.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "pcavr/physics/inputs/input_monitor.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"
#include "pipeline/identify/series_of.hpp"

namespace pcavr {
namespace {

/// Contacts of which none is at an object that are a fault.
constexpr std::size_t kMinContacts = 2;

InputComparison compared(std::string what, std::string figure) {
  return {.what = std::move(what), .figure = std::move(figure)};
}

InputComparison not_compared(std::string what, std::string reason) {
  return {.what = std::move(what), .reason = std::move(reason)};
}

void compare_sizes(const Recording& recording, const InspectedFrames& seen, std::size_t min_frames,
                   const ConsistencyOptions& options, std::vector<InputComparison>& comparisons) {
  const Manifest& manifest = recording.manifest;
  std::size_t sizes = 0;
  double worst = 0.0;
  for (const ScaleRatio& ratio :
       tag_ratios(manifest, seen.observations.tags, min_frames, options)) {
    if (ratio.kind != ScaleRatio::Kind::tag_size) continue;
    ++sizes;
    const double off = ratio.by_depth / ratio.stated - 1.0;
    if (std::abs(off) > std::abs(worst)) worst = off;
  }
  const char* what = "tag sizes and camera.depth_scale";
  if (sizes > 0) {
    comparisons.push_back(compared(what, fmt::format("sizes of {} tags by depth: at most {:+.1f} % "
                                                     "off",
                                                     sizes, 100.0 * worst)));
  } else {
    comparisons.push_back(not_compared(
        what, recording.has_depth ? "no tag with depth inside it is in view" : "no depth images"));
  }
}

void compare_layout(const Manifest& manifest, const InspectedFrames& seen,
                    std::vector<InputComparison>& comparisons) {
  bool has_base_pair = false;
  for (const TagPairCheck& pair : seen.pairs) {
    const MarkerEntry& first = manifest.markers[pair.first];
    const bool is_base = first.role == MarkerRole::base;
    has_base_pair = has_base_pair || is_base;
    comparisons.push_back(compared(
        std::string("poses of tags of ") + (is_base ? "base" : first.object),
        fmt::format(
            "{} and {}: {:.4f} +- {:.4f} m apart by {} images, {:.4f} m as stated; {:.1f} mm "
            "and {} off",
            first.id.to_string(), manifest.markers[pair.second].id.to_string(), pair.distance(),
            pair.distance_std, pair.frames, pair.stated_distance(), 1e3 * pair.offset,
            degrees(pair.rotation))));
  }
  if (!has_base_pair) {
    comparisons.push_back(not_compared("poses of the base tags",
                                       "no two base tags are in view together in enough frames"));
  }
}

void compare_camera(const Recording& recording, const InspectedFrames& seen, std::size_t min_frames,
                    std::vector<InputComparison>& comparisons) {
  const std::size_t tags = seen.observations.tags.size();
  if (tags >= min_frames && tags > 0) {
    comparisons.push_back(compared("camera.fx, camera.fy",
                                   fmt::format("shapes of {} tags by depth are squares", tags)));
  } else {
    comparisons.push_back(not_compared(
        "camera.fx, camera.fy",
        recording.has_depth ? "no tag with depth inside it is in view" : "no depth images"));
  }
  if (const auto unchecked = unchecked_camera(recording.manifest)) {
    comparisons.push_back(not_compared("camera.cx, camera.cy, camera.distortion", *unchecked));
  }
}

void compare_given_poses(const Recording& recording, const InspectedFrames& seen,
                         const CameraTrack& track, std::vector<InputComparison>& comparisons) {
  const char* what = "groundtruth.txt";
  if (recording.groundtruth.empty()) {
    comparisons.push_back(not_compared(what, "there is none"));
    return;
  }
  const auto aligned =
      std::count_if(track.frames.begin(), track.frames.end(),
                    [](const FramePlacement& frame) { return frame.segment >= 0; });
  if (aligned > 1) {
    comparisons.push_back(compared(
        what,
        fmt::format("camera's motion by tracking {} frames, where it moves enough", aligned)));
  } else {
    comparisons.push_back(not_compared(what, "no two views could be aligned to each other"));
  }
  const bool has_base = std::any_of(
      seen.observations.tags.begin(), seen.observations.tags.end(), [&](const auto& tag) {
        return recording.manifest.markers[tag.marker].role == MarkerRole::base;
      });
  if (!has_base) {
    comparisons.push_back(
        not_compared("groundtruth.txt against base", "no base tag with depth is in view"));
  }
}

void compare_bodies(const Recording& recording, const InspectedFrames& seen,
                    std::vector<InputComparison>& comparisons) {
  std::size_t body = 0;
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (!object.is_movable || object.mesh.empty()) continue;
    const OutlineFit& fit = seen.observations.outlines[body++];
    const std::string what = object.name + "'s mesh";
    if (fit.frames > 0 && fit.outline[kUnscaled] > 0.0) {
      comparisons.push_back(compared(
          what,
          fmt::format("depth in its outline lies on it by {:.0f} % ({} frames)",
                      100.0 * fit.explained[kUnscaled] / fit.outline[kUnscaled], fit.frames)));
    } else {
      comparisons.push_back(not_compared(
          what, recording.has_depth ? "no sampled frame shows its tags" : "no depth images"));
    }
  }
}

}  // namespace

std::vector<InputComparison> compare_images(const Recording& recording, const InspectedFrames& seen,
                                            const CameraTrack& track,
                                            const ConsistencyOptions& options) {
  const std::size_t min_frames = std::min(kMinFindingFrames, recording.frames.size());
  std::vector<InputComparison> comparisons;
  comparisons.push_back(compared("tags in view", tags_text(recording.manifest, seen.tags)));
  compare_sizes(recording, seen, min_frames, options, comparisons);
  compare_layout(recording.manifest, seen, comparisons);
  compare_camera(recording, seen, min_frames, comparisons);
  compare_given_poses(recording, seen, track, comparisons);
  compare_bodies(recording, seen, comparisons);
  return comparisons;
}

std::vector<InputComparison> compare_contacts(const Recording& recording,
                                              const PerceptionOptions& options,
                                              std::vector<ConsistencyFinding>& findings) {
  const char* what = "tool and force against the objects";
  if (recording.tool.empty() || recording.wrench.empty()) {
    return {not_compared(what, recording.tool.empty() ? "no tool.csv" : "no wrench.csv")};
  }
  const auto input = identification_input(recording, {.perception = options});
  if (!input) {
    return {not_compared(what, input.error().message + " (build, then pcavr identify --scene)")};
  }
  if (const auto missing = missing_streams(*input)) return {not_compared(what, missing->message)};
  if (input->objects.empty()) return {not_compared(what, "no object has a mesh and a pose")};
  std::size_t elsewhere = 0;
  std::vector<std::size_t> contacts(input->objects.size(), 0);
  const InputFindings found =
      examine_inputs(series_of(*input), InputOptions(), [&](const AttributedContact& contact) {
        ++(contact.object ? contacts[*contact.object] : elsewhere);
      });
  if (found.fault) {
    const Error& error = found.fault->error;
    findings.push_back({.severity = FindingSeverity::contradiction,
                        .file = error.file.empty() ? "wrench.csv" : error.file,
                        .place = error.place,
                        .message = error.message,
                        .hint = error.hint});
    return {};
  }
  if (found.no_contact) return {not_compared(what, found.no_contact->message)};
  std::vector<InputComparison> comparisons;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const IdentifiableObject& object = input->objects[i];
    comparisons.push_back(
        contacts[i] > 0 ? compared(what, fmt::format("{}: {} contacts at its surface", object.name,
                                                     contacts[i]))
                        : not_compared("pose of " + object.name, "no contact is at its surface"));
    comparisons.push_back(
        object.mass
            ? compared("the force's scale", object.name + "'s weight")
            : not_compared("the force's scale", "the mass of " + object.name + " is not known"));
  }
  if (elsewhere > 0 && elsewhere < found.contacts) {
    comparisons.push_back(
        not_compared(what, fmt::format("{} more contacts are at no object", elsewhere)));
  }
  // Single contacts may be with the table; all of them are not.
  if (elsewhere >= kMinContacts && elsewhere == found.contacts) {
    std::string notes;
    for (const std::string& note : found.notes) notes += "; " + note;
    findings.push_back({.file = "recording.yaml",
                        .place = "objects",
                        .message = fmt::format("none of the tool's {} contacts is at an object's "
                                               "surface{}",
                                               elsewhere, notes),
                        .hint = "check the objects' poses and the tool's path: both are in base"});
  }
  return comparisons;
}

}  // namespace pcavr
