// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/teleoperation/sites/picture_source.hpp"

namespace pcavr {

/// The colour images of a recording, each from its stamp on; null if it has none. Times are seconds
/// from the recording's start.
[[nodiscard]] std::unique_ptr<PictureSource> make_recorded_pictures(const Recording& recording);

}  // namespace pcavr
