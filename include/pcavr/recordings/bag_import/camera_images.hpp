// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {

struct ImageSize {
  int width = 0;  ///< [px]; 0 where not known
  int height = 0;

  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// The size that the message's fields state, or the header of the compressed image in it.
[[nodiscard]] ImageSize image_size(const RosMessage& message);

/// An image of a bag as the recording stores it, with its size [px].
struct ConvertedImage {
  EncodedImage file;
  int width = 0;
  int height = 0;
};

/// 16UC1 (millimetres) as it is, and 32FC1 (metres) in 1/depth_scale m, as PNG; compressedDepth of
/// both [ROS compressed_depth_image_transport], PNG only. Errors have no file.
[[nodiscard]] Expected<ConvertedImage> convert_depth(const RosMessage& message, double depth_scale);
/// 8-bit RGB, BGR, with alpha or grey, YUV 4:2:2 and Bayer patterns as JPEG; compressed JPEG and
/// PNG unchanged. Errors have no file.
[[nodiscard]] Expected<ConvertedImage> convert_color(const RosMessage& message);

/// The pixels of the same; another size [px] is an Error. Safe for untrusted bytes: memory is
/// bounded by the size.
[[nodiscard]] Expected<ColorImage> decode_color(const RosMessage& message, int width, int height);

/// Whether depth is in metres, as floating-point numbers, by encoding or format.
[[nodiscard]] bool is_metric_depth(const std::string& image_format);

/// The camera by its raw image's matrix and lens model, or, for a rectified image, by its
/// projection; of the region of interest and with the binning that the message states [REP 104].
/// `image`: the size of the images, where it is known; drivers state the size and the matrix of
/// either the full sensor or the image. Errors name the message's field.
[[nodiscard]] Expected<CameraModel> camera_of(const RosCameraInfo& info, bool is_rectified,
                                              ImageSize image = {});

}  // namespace pcavr
