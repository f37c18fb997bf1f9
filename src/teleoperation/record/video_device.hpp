// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The system calls on an open video device; a test's have a script in place of the kernel.
class VideoDevice {
 public:
  VideoDevice() = default;
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;
  virtual ~VideoDevice() = default;

  /// ioctl(); 0, or errno. Repeated while a signal interrupts it.
  [[nodiscard]] virtual int control(unsigned long request, void* argument) = 0;
  /// mmap() of `size` bytes that the driver has at `offset`; null if it failed. Mapped until the
  /// device is destroyed.
  [[nodiscard]] virtual const std::uint8_t* map(std::size_t size, std::int64_t offset) = 0;
  /// poll(): whether a frame is there, or an error to be found by control().
  [[nodiscard]] virtual bool wait(std::chrono::milliseconds timeout) = 0;
};

/// Opens a device. An Error where that is not possible, with what to do.
[[nodiscard]] Expected<std::unique_ptr<VideoDevice>> open_video_device(const std::string& path);

}  // namespace pcavr
