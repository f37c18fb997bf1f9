// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_tags.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

namespace pcavr {
namespace {

constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;
/// Images in which a tag that nothing names has to be, to be one and no pattern.
constexpr std::size_t kMinUnnamedImages = 5;

using TagBodies = std::map<std::string, std::vector<LayoutTag>>;

/// By body, base is "": the tags with stated poses, and those in view that have a size only.
TagBodies tag_bodies_of(const TagWalk& walk, const TagWalkInput& input) {
  TagBodies bodies;
  std::set<MarkerId> known;
  for (const MarkerEntry& marker : walk.known.markers) {
    bodies[marker.object].push_back(
        {.id = marker.id, .size = marker.size, .T_body_tag = marker.T_parent_marker});
    known.insert(marker.id);
  }
  for (const auto& [id, size] : walk.known.unplaced) {
    if (known.insert(id).second) bodies[""].push_back({.id = id, .size = size});
  }
  if (!input.size) return bodies;
  std::map<MarkerId, std::size_t> seen;
  for (const auto& frame : walk.frames) {
    for (const TagDetection& tag : frame) ++seen[tag.id];
  }
  for (const auto& [id, images] : seen) {
    if (images < kMinUnnamedImages || !known.insert(id).second) continue;
    bodies[""].push_back({.id = id, .size = *input.size});
  }
  return bodies;
}

bool is_named(const MarkerId& id, const std::string& name) {
  return name == id.to_string() || name == std::to_string(id.id);
}

/// Marks the tags that are given; an Error where one is not known, or has no pose.
Expected<void> fix_tags(const std::vector<std::string>& names, TagBodies& bodies) {
  for (const std::string& name : names) {
    bool is_known = false;
    for (auto& [body, tags] : bodies) {
      for (LayoutTag& tag : tags) {
        if (!is_named(tag.id, name)) continue;
        if (!tag.T_body_tag) {
          return Error{.message = "--fixed " + name + ": no pose of this tag is stated",
                       .hint = "add it to the recording's markers, or to the file of --layout"};
        }
        tag.is_fixed = true;
        is_known = true;
      }
    }
    if (is_known) continue;
    return Error{.message = "--fixed " + name + ": no such tag is known",
                 .hint = "name a tag of the recording, as 3 or tag36h11:3"};
  }
  return {};
}

/// Tags in view that neither the files nor --size name.
std::optional<std::string> unnamed_note(const TagWalk& walk, const TagBodies& bodies) {
  std::map<MarkerId, std::size_t> unnamed;
  for (const auto& frame : walk.frames) {
    for (const TagDetection& detection : frame) ++unnamed[detection.id];
  }
  for (const auto& [body, tags] : bodies) {
    for (const LayoutTag& tag : tags) unnamed.erase(tag.id);
  }
  std::string names;
  for (const auto& [id, images] : unnamed) {
    if (images < kMinUnnamedImages) continue;
    names += (names.empty() ? "" : ", ") + id.to_string();
  }
  if (names.empty()) return std::nullopt;
  return "in view, but not known: " + names + "; --size takes them as tags of the base";
}

std::string body_text(const CalibratedBody& body) { return body.name.empty() ? "base" : body.name; }

std::string move_text(const TagWalk& walk, const LaidOutTag& tag) {
  const auto seconds = [&](std::size_t frame) {
    return to_seconds(walk.stamps[frame] - walk.stamps.front());
  };
  return fmt::format(
      "{} was moved by {:.1f} mm and {:.1f} degrees between {:.2f} s and {:.2f} s: its place is "
      "the later one",
      tag.id.to_string(), 1e3 * tag.move->offset, kDegreesOfRadian * tag.move->rotation,
      seconds(tag.move->last_before), seconds(tag.move->first_after));
}

std::vector<std::string> notes_of(const TagWalk& walk, const CalibratedBody& body) {
  std::vector<std::string> notes;
  bool has_stated = false;
  for (const LaidOutTag& tag : body.layout.tags) {
    has_stated = has_stated || tag.shift;
    if (tag.move) notes.push_back(move_text(walk, tag));
    if (!tag.shift || !tag.shift->has_moved) continue;
    notes.push_back(fmt::format("{} is {:.1f} mm and {:.1f} degrees from where it is said to be",
                                tag.id.to_string(), 1e3 * tag.shift->offset,
                                kDegreesOfRadian * tag.shift->rotation));
  }
  for (const MarkerId& id : body.layout.unlinked) {
    notes.push_back(id.to_string() + " is in no image together with the other tags of " +
                    body_text(body) + ": not placed");
  }
  notes.insert(notes.end(), body.layout.notes.begin(), body.layout.notes.end());
  for (const LaidOutTag& tag : body.layout.tags) {
    if (has_stated || !tag.is_reference) continue;
    notes.push_back("no pose of a tag of " + body_text(body) + " is stated: its frame is that of " +
                    tag.id.to_string());
  }
  return notes;
}

}  // namespace

Expected<CalibratedTags> calibrate_tags(const TagWalk& walk, const TagWalkInput& input) {
  TagBodies bodies = tag_bodies_of(walk, input);
  const Expected<void> fixed = fix_tags(input.fixed, bodies);
  if (!fixed) return fixed.error();
  CalibratedTags found;
  for (const auto& [name, tags] : bodies) {
    if (tags.size() < 2) continue;
    Expected<TagLayout> layout = solve_tag_layout(tags, walk.frames, walk.camera);
    if (!layout) {
      Error error = layout.error();
      error.file = input.input.string();
      error.place = name.empty() ? "base" : name;
      return error;
    }
    CalibratedBody body{name, *std::move(layout)};
    const std::vector<std::string> notes = notes_of(walk, body);
    found.notes.insert(found.notes.end(), notes.begin(), notes.end());
    found.bodies.push_back(std::move(body));
  }
  if (found.bodies.empty()) {
    return Error{.message = "no body has two tags or more, whose places could be compared",
                 .file = input.input.string(),
                 .hint = "--size takes all tags in view as tags of the base"};
  }
  if (const auto unnamed = unnamed_note(walk, bodies)) found.notes.push_back(*unnamed);
  found.notes.insert(found.notes.end(), walk.notes.begin(), walk.notes.end());
  return found;
}

std::string describe_tags(const CalibratedTags& found) {
  std::string moved;
  std::size_t compared = 0;
  for (const CalibratedBody& body : found.bodies) {
    for (const LaidOutTag& tag : body.layout.tags) {
      compared += tag.shift ? 1 : 0;
      if (!tag.move && !(tag.shift && tag.shift->has_moved)) continue;
      moved += (moved.empty() ? "" : ", ") + tag.id.to_string();
    }
  }
  if (!moved.empty()) return "moved, or stated wrongly: " + moved;
  if (compared < 2) return "no stated poses are there to compare";
  return fmt::format("all {} stated poses agree with the images", compared);
}

}  // namespace pcavr
