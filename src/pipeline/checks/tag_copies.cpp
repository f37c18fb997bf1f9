// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tag_copies.hpp"

#include <algorithm>
#include <string>

#include <fmt/core.h>

#include "consistency_checks.hpp"

namespace pcavr {

void TagCopies::add(const std::vector<TagDetection>& detections,
                    const std::vector<MarkerId>& seen_twice) {
  for (const TagDetection& detection : detections) ++counts_[detection.id].frames;
  for (const MarkerId& id : seen_twice) {
    ++counts_[id].frames;
    ++counts_[id].twice;
  }
}

/// Fewer frames may show a pattern that was mistaken for the tag.
bool TagCopies::is_printed_twice(const Count& count) const {
  return count.twice > 0 && count.twice >= std::min(kMinFindingFrames, count.frames);
}

std::set<MarkerId> TagCopies::ids() const {
  std::set<MarkerId> ids;
  for (const auto& [id, count] : counts_) {
    if (is_printed_twice(count)) ids.insert(id);
  }
  return ids;
}

std::vector<ConsistencyFinding> TagCopies::findings(const Manifest& manifest) const {
  std::vector<ConsistencyFinding> findings;
  for (std::size_t i = 0; i < manifest.markers.size(); ++i) {
    const auto found = counts_.find(manifest.markers[i].id);
    if (found == counts_.end() || found->second.twice == 0) continue;
    const Count& count = found->second;
    findings.push_back(
        {.file = "recording.yaml",
         .place = fmt::format("markers[{}]", i),
         .message = fmt::format("{} is seen twice in {} of the {} frames that show it, and is not "
                                "used in {}",
                                found->first.to_string(), count.twice, count.frames,
                                is_printed_twice(count) ? "any" : "these"),
         .hint = "remove or cover the other print: each id may be in view only once",
         .frames = count.twice});
  }
  return findings;
}

void remove_tags(const std::set<MarkerId>& ids, std::vector<TagDetection>& detections) {
  std::erase_if(detections, [&](const TagDetection& tag) { return ids.contains(tag.id); });
}

}  // namespace pcavr
