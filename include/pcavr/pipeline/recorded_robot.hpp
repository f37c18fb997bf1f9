// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/teleoperation/sites/robot_interface.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// A recording in real time: each sample when it was measured, a tracked pose `tracking_latency`
/// [s] later. Keeps a reference to the input, which must outlive it. `pictures` may be null.
[[nodiscard]] std::unique_ptr<RobotInterface> make_recorded_robot(
    const TeleopInput& input, double tracking_latency,
    std::unique_ptr<PictureSource> pictures = nullptr);

}  // namespace pcavr
