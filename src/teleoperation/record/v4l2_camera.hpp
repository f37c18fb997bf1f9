// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "pcavr/teleoperation/record/camera_source.hpp"

#include "video_device.hpp"

namespace pcavr {

/// The camera behind a device that is open; `name` is that of messages.
[[nodiscard]] Expected<std::unique_ptr<CameraSource>> start_v4l2_camera(
    std::unique_ptr<VideoDevice> device, const std::string& name, const CameraRequest& request);

}  // namespace pcavr
