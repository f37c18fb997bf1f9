// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"
#include "pcavr/teleoperation/sites/picture_source.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "ros2_intake.hpp"

namespace pcavr {

/// Finds the objects of the scene in a camera's images by their tags, on a thread of its own: the
/// newest image wins.
class Ros2CameraTracker {
 public:
  virtual ~Ros2CameraTracker() = default;
  /// An image or a camera info of intake's subscription `topic` that arrived at `now` [s].
  virtual void on_message(std::size_t topic, bool is_image, std::span<const std::uint8_t> message,
                          double now) = 0;
  /// The images themselves; a picture's time [s] is that of its stamp on CLOCK_BOOTTIME.
  [[nodiscard]] virtual std::optional<CameraPicture> take_picture() = 0;
};

/// Writes the poses that it finds to `samples`. Keeps references to intake and queue. The camera is
/// where the base markers of its manifest show it in the same image, or else where the transforms
/// have its frame. An Error if the manifest can't be read, or no tag in it is on an object of
/// `world`.
[[nodiscard]] Expected<std::unique_ptr<Ros2CameraTracker>> make_ros2_camera(
    const Ros2Camera& camera, const TeleopInput& world, Ros2Intake& intake, RecordQueue& samples);

}  // namespace pcavr
