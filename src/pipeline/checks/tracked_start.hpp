// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/consistency.hpp"

#include "pipeline/build/survey.hpp"

namespace pcavr {

/// Pose of an object as its track begins, and the pose that it should have.
struct TrackedStart {
  std::string name;
  std::string file;  ///< of the track
  Pose T_base_object_stated;
  Pose T_base_object_tracked;
};

/// Tracks that begin elsewhere than stated: contradictions where those of two objects are
/// exchanged, or where mirroring an axis, exchanging x and y, another unit or inverting the poses
/// puts all of them where they should be; otherwise a warning for each, since an object may have
/// been moved before the recording.
[[nodiscard]] std::vector<ConsistencyFinding> check_tracked_starts(
    const std::vector<TrackedStart>& starts);

/// A contradiction as an Error; reports the warnings.
[[nodiscard]] Expected<void> accept_tracked_starts(const std::vector<TrackedStart>& starts,
                                                   const Observer& observer);

/// The same for the recording's own tracks and the poses in recording.yaml.
[[nodiscard]] Expected<std::vector<ConsistencyFinding>> check_own_tracks(
    const Recording& recording, const std::vector<DeclaredBody>& bodies);

}  // namespace pcavr
