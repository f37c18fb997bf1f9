// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tags_in_view.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/recordings/recording/frame_reader.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Frames that are searched for other families: each costs a second at most.
constexpr std::size_t kOtherFrames = 6;
/// A pattern is mistaken for a tag in one or two frames.
constexpr std::size_t kMinOtherFrames = 2;

bool is_declared(const Manifest& manifest, const MarkerId& id) {
  return std::any_of(manifest.markers.begin(), manifest.markers.end(),
                     [&](const MarkerEntry& marker) { return marker.id == id; });
}

/// Bodies with declared tags of which none is in view: base is "", objects have their names.
std::vector<std::string> bodies_out_of_view(const Manifest& manifest, const TagsInView& tags) {
  std::map<std::string, bool> is_in_view;
  for (const MarkerEntry& marker : manifest.markers) {
    is_in_view[marker.role == MarkerRole::base ? "" : marker.object] |=
        tags.seen.contains(marker.id);
  }
  std::vector<std::string> bodies;
  for (const auto& [body, is_seen] : is_in_view) {
    if (!is_seen) bodies.push_back(body);
  }
  return bodies;
}

/// The AprilTag families that no marker has; their names begin with "tag".
std::vector<std::string> other_families(const Manifest& manifest) {
  std::vector<std::string> families;
  for (const std::string& family : tag_families()) {
    const bool is_used =
        std::any_of(manifest.markers.begin(), manifest.markers.end(),
                    [&](const MarkerEntry& marker) { return marker.id.family == family; });
    if (!is_used && family.starts_with("tag")) families.push_back(family);
  }
  return families;
}

/// The tags in view that are not declared, of all families searched.
std::string undeclared_text(const Manifest& manifest, const TagsInView& tags) {
  std::string text;
  for (const SearchedTag& tag : searched_tags(manifest, tags)) {
    if (tag.is_declared) continue;
    text += (text.empty() ? "" : ", ") +
            fmt::format("{} in {} of {} sampled frames", tag.id.to_string(), tag.seen, tag.frames);
  }
  return text;
}

}  // namespace

Expected<void> search_other_families(const Recording& recording,
                                     const std::vector<std::size_t>& frames,
                                     const TagDetectorOptions& options, FamilySearch families,
                                     TagsInView& tags) {
  const Manifest& manifest = recording.manifest;
  const bool is_missing = manifest.markers.empty() || !bodies_out_of_view(manifest, tags).empty();
  if (!is_missing && families == FamilySearch::where_missing) return {};
  TagDetectorOptions strict = options;
  strict.max_hamming = 0;  // many families: no pattern of the scene may count as a tag
  strict.full_search_interval = 1;
  Expected<TagDetector> detector = TagDetector::create(other_families(manifest), strict);
  if (!detector) return detector.error();
  const std::size_t count = std::min(kOtherFrames, frames.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Expected<RgbdFrame> frame = decode_frame(recording, frames[i * frames.size() / count]);
    if (!frame) return frame.error();
    ++tags.frames_of_others;
    for (const TagDetection& tag : detector->detect(to_gray(frame->color))) {
      ++tags.seen_of_others[tag.id];
    }
  }
  return {};
}

std::vector<SearchedTag> searched_tags(const Manifest& manifest, const TagsInView& tags) {
  std::vector<SearchedTag> searched;
  for (const MarkerEntry& marker : manifest.markers) {
    const auto found = tags.seen.find(marker.id);
    const std::size_t seen = found == tags.seen.end() ? 0 : found->second;
    searched.push_back({.id = marker.id, .is_declared = true, .seen = seen, .frames = tags.frames});
  }
  const auto add = [&](const std::map<MarkerId, std::size_t>& seen, std::size_t frames) {
    for (const auto& [id, count] : seen) {
      if (is_declared(manifest, id) || count < std::min(kMinOtherFrames, frames)) continue;
      searched.push_back({.id = id, .is_declared = false, .seen = count, .frames = frames});
    }
  };
  add(tags.seen, tags.frames);
  add(tags.seen_of_others, tags.frames_of_others);
  return searched;
}

std::vector<ConsistencyFinding> check_tags_in_view(const Recording& recording,
                                                   const TagsInView& tags) {
  const Manifest& manifest = recording.manifest;
  const std::string undeclared = undeclared_text(manifest, tags);
  std::vector<ConsistencyFinding> findings;
  for (const std::string& body : bodies_out_of_view(manifest, tags)) {
    std::string names;
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < manifest.markers.size(); ++i) {
      const MarkerEntry& marker = manifest.markers[i];
      if ((marker.role == MarkerRole::base ? "" : marker.object) != body) continue;
      if (!first) first = i;
      names += (names.empty() ? "" : ", ") + marker.id.to_string();
    }
    findings.push_back(
        {.file = "recording.yaml",
         .place = key_of_marker(*first),
         .message = fmt::format("no tag of {} ({}) is in any of {} sampled frames; in view but not "
                                "declared: {}",
                                body.empty() ? "base" : body, names, tags.frames,
                                undeclared.empty() ? "none" : undeclared),
         .hint = "check family and id of the printed tags"});
  }
  return findings;
}

std::string tags_text(const Manifest& manifest, const TagsInView& tags) {
  std::string text;
  for (const auto& [id, count] : tags.seen) {
    if (!is_declared(manifest, id)) continue;
    text += (text.empty() ? "" : ", ") + fmt::format("{} in {}", id.to_string(), count);
  }
  text = text.empty() ? "none of the declared"
                      : text + fmt::format(" of {} sampled frames", tags.frames);
  const std::string undeclared = undeclared_text(manifest, tags);
  return undeclared.empty() ? text : text + "; not declared: " + undeclared;
}

}  // namespace pcavr
