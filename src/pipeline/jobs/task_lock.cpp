// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "task_lock.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace pcavr {
namespace {

constexpr int kMode = 0666;  // as the umask allows: others of a lab may run the plan, too

}  // namespace

TaskLock::TaskLock(TaskLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

TaskLock& TaskLock::operator=(TaskLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

TaskLock::~TaskLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Expected<std::optional<TaskLock>> TaskLock::try_acquire(const std::filesystem::path& file) {
  TaskLock lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kMode));
  if (lock.descriptor_ >= 0 && ::flock(lock.descriptor_, LOCK_EX | LOCK_NB) == 0)
    return std::optional(std::move(lock));
  if (lock.descriptor_ >= 0 && errno == EWOULDBLOCK) return std::optional<TaskLock>();
  return Error{.message = std::string("can't be locked: ") + std::strerror(errno),
               .file = file.string(),
               .place = {},
               .hint = "check the folder's permissions, and that its file system has locks"};
}

bool TaskLock::is_locked(const std::filesystem::path& file) {
  const TaskLock probe(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  return probe.descriptor_ >= 0 && ::flock(probe.descriptor_, LOCK_SH | LOCK_NB) != 0 &&
         errno == EWOULDBLOCK;
}

}  // namespace pcavr
