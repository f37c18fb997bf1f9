// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <malloc.h>

/// Bytes allocated on the heap now, and their maximum. Replaces the global operators new and
/// delete: include it in one source file of a test executable only, and not with heap_counter.hpp.
inline std::atomic<std::size_t> heap_bytes{0};
inline std::atomic<std::size_t> heap_peak{0};

/// Peak heap use during its lifetime, above the use at its construction.
class HeapWatermark {
 public:
  HeapWatermark() : before_(heap_bytes) { heap_peak = before_; }
  [[nodiscard]] std::size_t peak() const { return heap_peak - before_; }

 private:
  std::size_t before_;
};

inline void* note_allocation(void* memory) noexcept {
  if (memory == nullptr) return memory;
  const std::size_t now = heap_bytes += ::malloc_usable_size(memory);
  std::size_t peak = heap_peak;
  while (now > peak && !heap_peak.compare_exchange_weak(peak, now)) {
  }
  return memory;
}
inline void free_and_count(void* memory) noexcept {
  if (memory != nullptr) heap_bytes -= ::malloc_usable_size(memory);
  std::free(memory);
}

// All forms that the standard library calls are replaced, and none is inlined, for the reasons that
// heap_counter.hpp gives.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return note_allocation(std::malloc(size > 0 ? size : 1));
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = note_allocation(std::aligned_alloc(step, (size + step - 1) / step * step))) {
    return memory;
  }
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { free_and_count(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  free_and_count(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  free_and_count(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  free_and_count(memory);
}
