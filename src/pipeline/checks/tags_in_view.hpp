// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/perception_options.hpp"

namespace pcavr {

/// Tags in some of a recording's frames, declared or not.
struct TagsInView {
  std::size_t frames = 0;                     ///< that were searched
  std::map<MarkerId, std::size_t> seen = {};  ///< frames with the tag, of the declared families
  std::size_t frames_of_others = 0;           ///< that were searched for other families
  std::map<MarkerId, std::size_t> seen_of_others = {};  ///< frames with the tag, of these
};

/// Searches some of `frames` (indices) for the AprilTag families that the recording does not
/// declare.
[[nodiscard]] Expected<void> search_other_families(const Recording& recording,
                                                   const std::vector<std::size_t>& frames,
                                                   const TagDetectorOptions& options,
                                                   FamilySearch families, TagsInView& tags);

/// The declared tags in the manifest's order, then the others in view: those seen in one frame only
/// are false detections.
[[nodiscard]] std::vector<SearchedTag> searched_tags(const Manifest& manifest,
                                                     const TagsInView& tags);

/// A warning for base and each object of whose tags none is in view; it states which tags are.
[[nodiscard]] std::vector<ConsistencyFinding> check_tags_in_view(const Recording& recording,
                                                                 const TagsInView& tags);

/// "tag36h11:0 in 16 of 16 sampled frames; not declared: tag36h11:9 in 3 of 16"; "none".
[[nodiscard]] std::string tags_text(const Manifest& manifest, const TagsInView& tags);

}  // namespace pcavr
