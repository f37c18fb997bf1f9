// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/camera.hpp"

namespace pcavr::cdr {

inline constexpr std::string_view kCameraInfoType = "sensor_msgs/msg/CameraInfo";
[[nodiscard]] std::string camera_info_definition();

/// A camera's image as it is taken, not rectified: the projection matrix is that of the lens
/// without its distortion. See cdr_messages.hpp.
[[nodiscard]] std::vector<std::uint8_t> camera_info(Stamp stamp, std::string_view frame,
                                                    const CameraModel& camera);

}  // namespace pcavr::cdr
