// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/pipeline/consistency.hpp"

namespace pcavr {

/// Ids that are printed more than once: seen at two places in one image. If only one of the copies
/// is in view, nothing shows which one it is.
class TagCopies {
 public:
  /// `detections` of one frame, and the ids that its detector left out.
  void add(const std::vector<TagDetection>& detections, const std::vector<MarkerId>& seen_twice);

  /// The ids that must not be used in any frame.
  [[nodiscard]] std::set<MarkerId> ids() const;

  /// A warning for each declared id that was seen twice in any frame.
  [[nodiscard]] std::vector<ConsistencyFinding> findings(const Manifest& manifest) const;

 private:
  struct Count {
    std::size_t frames = 0;  ///< with the id, once or twice
    std::size_t twice = 0;
  };
  [[nodiscard]] bool is_printed_twice(const Count& count) const;

  std::map<MarkerId, Count> counts_;
};

/// Removes the detections of these ids.
void remove_tags(const std::set<MarkerId>& ids, std::vector<TagDetection>& detections);

}  // namespace pcavr
