// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// PCAVR_IS_SANITIZED: an address or thread sanitizer runs. It aborts the process when memory runs
/// out, and its shadow memory exceeds any limit of the address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCAVR_IS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PCAVR_IS_SANITIZED
#endif
#endif
