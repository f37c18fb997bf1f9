// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace pcavr {

/// Passes the newest value from one thread to another, wait-free: writer and reader each own a
/// slot, and exchange it atomically for the third.
template <typename Value>
class TripleBuffer {
 public:
  explicit TripleBuffer(const Value& start) : slots_{start, start, start} {}

  /// The writer's slot. It contains an old value: all of it must be overwritten.
  [[nodiscard]] Value& back() noexcept { return slots_[back_]; }
  /// Writer: publishes back() as the newest value.
  void publish() noexcept {
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kIsNew), std::memory_order_acq_rel) &
            kSlotMask;
  }
  /// Reader: the newest published value; valid until the next call.
  [[nodiscard]] const Value& newest() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kIsNew) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kSlotMask;
    }
    return slots_[front_];
  }

 private:
  static constexpr std::uint8_t kIsNew = 4;
  static constexpr std::uint8_t kSlotMask = 3;

  std::array<Value, 3> slots_;
  std::uint8_t back_ = 0;
  std::uint8_t front_ = 1;
  std::atomic<std::uint8_t> middle_{2};
};

}  // namespace pcavr
