// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/calibrate.hpp"

namespace pcavr {

/// The poses of an input, turned round and inverted as it says. Errors as of read_pose_list.
[[nodiscard]] Expected<PoseList> read_pose_input(const PoseInput& input);

}  // namespace pcavr
