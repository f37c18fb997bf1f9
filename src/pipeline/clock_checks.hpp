// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// Whether the images are used together with the tool and its force.
enum class ImageUse { none, tracking };

/// Force, motion and tracked images that do not overlap at all are an Error; what overlaps little,
/// or is not used, is a warning.
[[nodiscard]] std::optional<Error> check_clocks(const Recording& recording, ImageUse images,
                                                const Observer& observer);

/// All conflicts as warnings: for what needs one of the streams only.
void warn_of_clocks(const Recording& recording, const Observer& observer);

/// Tracked poses of an object, in seconds from the recording's start, that lie wholly before or
/// after the tool's motion: a warning, because they may be what was measured beside it.
void warn_of_tracked_clock(const Recording& recording, const std::string& object,
                           std::span<const TrackedPose> tracked, const Observer& observer);

}  // namespace pcavr
