// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace pcavr {

/// From one thread to one other, the newest only. Neither ever waits for the other: each owns a
/// place, and the third goes to and fro between them.
template <typename Value>
class TripleBuffer {
 public:
  explicit TripleBuffer(const Value& start) : places_{start, start, start} {}

  /// The writer's place. What it holds is of some time before: all of it has to be written.
  [[nodiscard]] Value& back() noexcept { return places_[back_]; }
  /// The writer: what is in back() is the newest from now on.
  void publish() noexcept {
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kIsNew), std::memory_order_acq_rel) &
            kPlace;
  }
  /// The reader: the newest that was published; stays as it is until the next call.
  [[nodiscard]] const Value& newest() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kIsNew) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kPlace;
    }
    return places_[front_];
  }

 private:
  static constexpr std::uint8_t kIsNew = 4;
  static constexpr std::uint8_t kPlace = 3;

  std::array<Value, 3> places_;
  std::uint8_t back_ = 0;
  std::uint8_t front_ = 1;
  std::atomic<std::uint8_t> middle_{2};
};

}  // namespace pcavr
