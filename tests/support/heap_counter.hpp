// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

/// How often the heap was asked for memory. Replaces the global operators: include it in one source
/// file of a test executable only.
inline std::atomic<long> heap_allocations{0};

// Not inlined: GCC would see new's malloc beside delete's free, and take them for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++heap_allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
