// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace pcavr {

/// A bounded queue from one thread to one other, wait-free on both sides. `Size` is a power of two,
/// so that the counters may run over.
template <typename T, std::uint32_t Size>
class SampleRing {
  static_assert((Size & (Size - 1)) == 0);

 public:
  /// Writer: false where there is no room.
  bool push(const T& item) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Size) return false;
    items_[head % Size] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Writer: the reader is to forget what is in it now, and what it took from it before.
  void forget() noexcept {
    const std::uint64_t forgets = (forgotten_.load(std::memory_order_relaxed) >> 32) + 1;
    forgotten_.store(forgets << 32 | head_.load(std::memory_order_relaxed),
                     std::memory_order_release);
  }

  /// Reader: whether the writer said to forget since the last call. What is older is gone then.
  [[nodiscard]] bool forgets() noexcept {
    const std::uint64_t forgotten = forgotten_.load(std::memory_order_acquire);
    if (forgotten == seen_) return false;
    seen_ = forgotten;
    const auto there = static_cast<std::uint32_t>(forgotten);
    const std::uint32_t ahead = there - tail_.load(std::memory_order_relaxed);
    // Not back: what was taken since is the writer's to write over.
    if (ahead <= Size) tail_.store(there, std::memory_order_release);
    return true;
  }
  /// Reader.
  [[nodiscard]] std::optional<T> pop() noexcept {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return std::nullopt;
    const T item = items_[tail % Size];
    tail_.store(tail + 1, std::memory_order_release);
    return item;
  }

 private:
  std::array<T, Size> items_{};
  std::atomic<std::uint32_t> head_{0};       ///< written by the writer
  std::atomic<std::uint32_t> tail_{0};       ///< written by the reader
  std::atomic<std::uint64_t> forgotten_{0};  ///< how often; the head at the last time
  std::uint64_t seen_ = 0;                   ///< the reader's
};

}  // namespace pcavr
