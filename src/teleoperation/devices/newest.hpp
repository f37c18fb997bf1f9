// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace pcavr {

/// The newest value from one thread to one other, wait-free on both sides: a triple buffer.
template <typename T>
class Newest {
 public:
  /// Writer.
  void put(const T& value) noexcept {
    values_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }
  /// Reader: T{} before the first.
  [[nodiscard]] const T& get() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    }
    return values_[front_];
  }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;

  std::array<T, 3> values_{};
  std::uint32_t back_ = 0;                ///< the writer's
  std::atomic<std::uint32_t> middle_{1};  ///< exchanged; kFresh is set until the reader takes it
  std::uint32_t front_ = 2;               ///< the reader's
};

}  // namespace pcavr
