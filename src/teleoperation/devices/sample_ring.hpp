// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace pcavr {

/// A bounded single-producer single-consumer queue, wait-free on both sides. `Size` is a power of
/// two, so that the counters may overflow.
template <typename T, std::uint32_t Size>
class SampleRing {
  static_assert((Size & (Size - 1)) == 0);

 public:
  /// Writer: false if the queue is full.
  bool push(const T& item) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Size) return false;
    items_[head % Size] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Writer: requests the reader to discard the current items and those it has taken before.
  void request_clear() noexcept {
    const std::uint64_t requests = (clear_request_.load(std::memory_order_relaxed) >> 32) + 1;
    clear_request_.store(requests << 32 | head_.load(std::memory_order_relaxed),
                         std::memory_order_release);
  }

  /// Reader: whether a clear was requested since the last call. Older items are then discarded.
  [[nodiscard]] bool is_clear_requested() noexcept {
    const std::uint64_t request = clear_request_.load(std::memory_order_acquire);
    if (request == seen_) return false;
    seen_ = request;
    const auto end = static_cast<std::uint32_t>(request);
    const std::uint32_t ahead = end - tail_.load(std::memory_order_relaxed);
    // Never backwards: the writer may have overwritten the items taken since.
    if (ahead <= Size) tail_.store(end, std::memory_order_release);
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
  std::atomic<std::uint32_t> head_{0};           ///< written by the writer
  std::atomic<std::uint32_t> tail_{0};           ///< written by the reader
  std::atomic<std::uint64_t> clear_request_{0};  ///< number of requests; the head at the last one
  std::uint64_t seen_ = 0;                       ///< last request seen by the reader
};

}  // namespace pcavr
