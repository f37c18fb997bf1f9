// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"

#include "robots/calibration/rig.hpp"

namespace pcavr {

/// What is wrong with the poses of both inputs, if they fit each other at once when it is put
/// right: inverted, another order of the quaternion, degrees, mirrored, another unit of length, a
/// partner one view later. Its `place` is the input: "ROBOT" or "CAMERA". nullopt where they fit as
/// they are, or nothing explains them.
[[nodiscard]] std::optional<Error> find_input_error(const std::vector<RigView>& views,
                                                    CameraMount mount);

}  // namespace pcavr
