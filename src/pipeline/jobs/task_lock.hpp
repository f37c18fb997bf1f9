// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// An exclusive lock on a file (flock), created where it is missing and never removed. A child
/// process that inherits the descriptor keeps it locked until it ends, too.
class TaskLock {
 public:
  /// Empty where another process has it.
  [[nodiscard]] static Expected<std::optional<TaskLock>> try_acquire(
      const std::filesystem::path& file);
  /// Whether any process has it. Creates nothing.
  [[nodiscard]] static bool is_locked(const std::filesystem::path& file);

  TaskLock(TaskLock&& other) noexcept;
  TaskLock& operator=(TaskLock&& other) noexcept;
  ~TaskLock();

  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  explicit TaskLock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_ = -1;
};

}  // namespace pcavr
