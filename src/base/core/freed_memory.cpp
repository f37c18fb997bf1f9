// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/freed_memory.hpp"

#include <malloc.h>

namespace pcavr {

void return_large_blocks_at_once() {
  constexpr int kLarge = 4 << 20;  // [bytes] an image of a megapixel stays, the arrays of a mesh go
  mallopt(M_MMAP_THRESHOLD, kLarge);
  mallopt(M_TRIM_THRESHOLD, 16 * kLarge);  // not for each image at the end of the heap
}

void return_freed_memory() { malloc_trim(0); }

}  // namespace pcavr
