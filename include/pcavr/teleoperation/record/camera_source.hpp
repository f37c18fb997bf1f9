// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A colour image as a camera gave it.
struct CameraFrame {
  double t = 0.0;                            ///< CLOCK_MONOTONIC [s] when it was taken
  std::string_view format;                   ///< "jpeg" or "png"
  std::span<const std::uint8_t> bytes = {};  ///< of the file; valid until the next call of next()
};

/// A colour camera, frame by frame. For one thread.
class CameraSource {
 public:
  CameraSource() = default;
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  virtual ~CameraSource() = default;

  /// Waits for the next frame, at most `timeout`; nothing if none came. An Error if the camera is
  /// gone; do not call it again then.
  [[nodiscard]] virtual Expected<std::optional<CameraFrame>> next(
      std::chrono::milliseconds timeout) = 0;
  /// Frames that were taken and did not arrive, or arrived damaged, up to now.
  [[nodiscard]] virtual std::uint64_t lost() const = 0;
  /// What it is, for messages: "/dev/video0: 1280 x 720 MJPG at 30 Hz".
  [[nodiscard]] virtual std::string description() const = 0;
  /// [px]
  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
};

/// What is asked of a camera; nothing: as it is set.
struct CameraRequest {
  std::optional<int> width = {};    ///< [px]; with `height`
  std::optional<int> height = {};   ///< [px]
  std::optional<double> rate = {};  ///< [Hz]; of a simulated camera 30 if not given
};

/// A V4L2 device, "/dev/video0": MJPEG where it offers that, else YUYV, which is encoded as JPEG
/// [Linux userspace API, "Video for Linux", streaming by mmap]. Errors say why it can't be used: it
/// is absent, in use, not readable for this user, no capture device, offers neither format, or not
/// the size.
[[nodiscard]] Expected<std::unique_ptr<CameraSource>> open_v4l2_camera(
    const std::string& device, const CameraRequest& request);

/// A simulated camera: the JPEG and PNG files of a folder, in the order of their names, again and
/// again, as a camera would take them. An Error for a folder without images, and for images of
/// different sizes.
[[nodiscard]] Expected<std::unique_ptr<CameraSource>> open_file_camera(
    const std::filesystem::path& folder, const CameraRequest& request);

/// "file:FOLDER" is a simulated camera, any other source a V4L2 device.
[[nodiscard]] Expected<std::unique_ptr<CameraSource>> open_camera(const std::string& source,
                                                                  const CameraRequest& request);

}  // namespace pcavr
