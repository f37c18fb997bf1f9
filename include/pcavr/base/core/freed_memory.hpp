// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// By default the allocator keeps blocks as large as those freed before [mallopt(3),
/// M_MMAP_THRESHOLD], so that the peak of a long task is that of all its steps together.

/// From now on this process returns blocks of megabytes to the system when they are freed. Not for
/// blocks as small as images, which would be zeroed and mapped anew with each frame: that doubled
/// the time of a build by tiles. To be called before threads begin.
void return_large_blocks_at_once();

/// Returns what else is free, in milliseconds: once a step of the work. Thread-safe.
void return_freed_memory();

}  // namespace pcavr
