// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// Whether the images are used together with the tool and its force.
enum class ImageUse { none, tracking };

/// An Error where force, motion or tracked images do not overlap in time at all; a warning where
/// they overlap little, or are not used.
[[nodiscard]] std::optional<Error> check_clocks(const Recording& recording, ImageUse images,
                                                const Observer& observer);

/// An Error where the tool or the force has rows too far apart to show a contact. Of fewer than 20
/// rows nothing is said.
[[nodiscard]] std::optional<Error> check_rates(const Recording& recording);

/// All conflicts as warnings: for commands that need only one of the streams.
void warn_of_clocks(const Recording& recording, const Observer& observer);

/// Tracked poses of an object, in seconds from `zero`, that lie wholly before or after the tool's
/// motion, or have stamps of another unit: a warning, because the object may have been tracked on
/// another clock.
void warn_of_tracked_clock(const Recording& recording, const std::string& object,
                           std::span<const TrackedPose> tracked, Stamp zero,
                           const Observer& observer);

}  // namespace pcavr
