// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "video_device.hpp"

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace pcavr {
namespace {

class KernelVideoDevice final : public VideoDevice {
 public:
  explicit KernelVideoDevice(int descriptor) : descriptor_(descriptor) {}
  ~KernelVideoDevice() override {
    for (const auto& [address, size] : maps_) ::munmap(address, size);
    ::close(descriptor_);
  }

  int control(unsigned long request, void* argument) override {
    while (::ioctl(descriptor_, request, argument) != 0) {
      if (errno != EINTR) return errno;
    }
    return 0;
  }

  const std::uint8_t* map(std::size_t size, std::int64_t offset) override {
    void* const address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor_, offset);
    if (address == MAP_FAILED) return nullptr;
    maps_.emplace_back(address, size);
    return static_cast<const std::uint8_t*>(address);
  }

  bool wait(std::chrono::milliseconds timeout) override {
    pollfd waited{.fd = descriptor_, .events = POLLIN, .revents = 0};
    return ::poll(&waited, 1, static_cast<int>(timeout.count())) > 0;
  }

 private:
  int descriptor_;
  std::vector<std::pair<void*, std::size_t>> maps_;
};

const char* hint_of(int code) {
  switch (code) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      return "connect the camera; 'ls /dev/video*' lists those that are there";
    case EACCES:
    case EPERM:
      return "join the group that may read it, by 'sudo adduser $USER video', and log in again";
    case EBUSY:
      return "end the program that uses it";
    default:
      return "check the camera's connection";
  }
}

}  // namespace

Expected<std::unique_ptr<VideoDevice>> open_video_device(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISCHR(status.st_mode)) {
    return Error{.message = "is not a video device",
                 .file = path,
                 .hint = "give one such as /dev/video0, or file:FOLDER for a simulated camera"};
  }
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    const int code = errno;
    return Error{.message = std::string("can't be opened: ") + std::strerror(code),
                 .file = path,
                 .hint = hint_of(code)};
  }
  return std::unique_ptr<VideoDevice>(std::make_unique<KernelVideoDevice>(descriptor));
}

}  // namespace pcavr
