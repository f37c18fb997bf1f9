// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

/// Records of bytes from one thread to one other, in order: a ring of fixed size without locks. A
/// record that does not fit is dropped and counted.
class RecordQueue {
 public:
  /// `capacity` [bytes]: a power of two.
  explicit RecordQueue(std::size_t capacity) : ring_(capacity) {
    PCAVR_REQUIRE(std::has_single_bit(capacity), capacity);
  }

  /// The writing thread: `head` and `body` as one record. Never allocates, locks or waits.
  bool push(std::span<const std::uint8_t> head, std::span<const std::uint8_t> body) noexcept {
    const std::uint64_t end = end_.load(std::memory_order_relaxed);
    const std::uint64_t size = head.size() + body.size();
    const std::uint64_t used = end - begin_.load(std::memory_order_acquire);
    if (size > UINT32_MAX || used + kLength + size > ring_.size()) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    const auto length = static_cast<std::uint32_t>(size);
    copy_in(end, &length, kLength);
    copy_in(end + kLength, head.data(), head.size());
    copy_in(end + kLength + head.size(), body.data(), body.size());
    end_.store(end + kLength + size, std::memory_order_release);
    return true;
  }

  /// The reading thread: replaces `record` by the oldest one. False if there is none.
  bool pop(std::vector<std::uint8_t>& record) {
    const std::uint64_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    std::uint32_t length = 0;
    copy_out(begin, &length, kLength);
    record.resize(length);
    copy_out(begin + kLength, record.data(), length);
    begin_.store(begin + kLength + length, std::memory_order_release);
    return true;
  }

  /// Any thread may call it.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return dropped_.load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kLength = sizeof(std::uint32_t);

  void copy_in(std::uint64_t at, const void* bytes, std::size_t count) noexcept {
    const std::size_t place = at & (ring_.size() - 1);
    const std::size_t first = std::min(count, ring_.size() - place);
    if (first > 0) std::memcpy(ring_.data() + place, bytes, first);
    if (count > first) {
      std::memcpy(ring_.data(), static_cast<const std::uint8_t*>(bytes) + first, count - first);
    }
  }
  void copy_out(std::uint64_t at, void* bytes, std::size_t count) const noexcept {
    const std::size_t place = at & (ring_.size() - 1);
    const std::size_t first = std::min(count, ring_.size() - place);
    if (first > 0) std::memcpy(bytes, ring_.data() + place, first);
    if (count > first) {
      std::memcpy(static_cast<std::uint8_t*>(bytes) + first, ring_.data(), count - first);
    }
  }

  std::vector<std::uint8_t> ring_;
  std::atomic<std::uint64_t> begin_{0};  ///< of the oldest record; counts bytes
  std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace pcavr
