// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace pcavr {

/// The emergency stop between a driver's thread and the world's. A press is not lost, however short
/// it is.
class StopButton {
 public:
  /// The driver's thread.
  void set(bool is_pressed) noexcept {
    if (is_pressed) was_pressed_.store(true, std::memory_order_relaxed);
    is_held_.store(is_pressed, std::memory_order_relaxed);
  }
  /// The world's thread: whether it is held, or was pressed since the last call.
  [[nodiscard]] bool take() noexcept {
    return was_pressed_.exchange(false, std::memory_order_relaxed) ||
           is_held_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> is_held_{false};
  std::atomic<bool> was_pressed_{false};
};

}  // namespace pcavr
