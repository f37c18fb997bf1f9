// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/core/expected.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/recording/recording_writer.hpp"
#include "pcavr/rosbag/ros_messages.hpp"

namespace pcavr {

/// An image of a bag as the recording stores it, with its size [px].
struct ConvertedImage {
  EncodedImage file;
  int width = 0;
  int height = 0;
};

/// 16UC1 (millimetres) as it is, and 32FC1 (metres) in 1/depth_scale m, as PNG; compressedDepth of
/// both [ROS compressed_depth_image_transport], PNG only. Errors have no file.
[[nodiscard]] Expected<ConvertedImage> convert_depth(const RosMessage& message, double depth_scale);
/// rgb8, bgr8, rgba8, bgra8 and mono8 as JPEG; compressed JPEG and PNG unchanged. Errors have no
/// file.
[[nodiscard]] Expected<ConvertedImage> convert_color(const RosMessage& message);

/// The pixels of the same; another size [px] is an Error. Safe for untrusted bytes: memory is
/// bounded by the size.
[[nodiscard]] Expected<ColorImage> decode_color(const RosMessage& message, int width, int height);

/// Whether depth is in metres, as floating-point numbers, by encoding or format.
[[nodiscard]] bool is_metric_depth(const std::string& image_format);

/// The camera by its raw image's matrix and lens model, or, for a rectified image, by its
/// projection. Errors name the message's field.
[[nodiscard]] Expected<CameraModel> camera_of(const RosCameraInfo& info, bool is_rectified);

}  // namespace pcavr
