// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace pcavr::simulation {

/// calib/robots/irb120_like/irb120_like.urdf, so that the command needs no file beside it.
[[nodiscard]] std::string_view six_axis_arm();

}  // namespace pcavr::simulation
