// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/parallel.hpp"

#include "errors.hpp"

namespace pcavr::python {

/// The argument `threads`; 0: all cores.
[[nodiscard]] inline Parallelism parallelism_of(int threads) {
  constexpr int kMaxThreads = 256;  // as of the command
  if (threads < 0 || threads > kMaxThreads) {
    raise_error({.message = std::to_string(threads) + " threads are not from 0 to " +
                            std::to_string(kMaxThreads),
                 .place = "threads",
                 .hint = "0 uses all cores"});
  }
  return threads == 0 ? Parallelism::max() : Parallelism{threads};
}

}  // namespace pcavr::python
