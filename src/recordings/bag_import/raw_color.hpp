// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {

/// Whether load_raw_color reads images of this encoding [sensor_msgs/image_encodings.hpp].
[[nodiscard]] bool is_color_encoding(std::string_view encoding);

/// The pixels of an image that is not compressed. Bayer patterns are interpolated between the
/// nearest pixels of each colour; two pixels share the colour of YUV 4:2:2 [ITU-R BT.601, 16 to
/// 235]; 8UC3 and 8UC4, which do not state the order of their channels, are taken as blue, green,
/// red, as OpenCV has them. Errors have no file.
[[nodiscard]] Expected<ColorImage> load_raw_color(const RosImage& message);

}  // namespace pcavr
