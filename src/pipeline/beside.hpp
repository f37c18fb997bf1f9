// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <utility>

#include "pcavr/core/parallel.hpp"

namespace pcavr {

/// Runs `work` on a second thread where the caller may use one, else when its result is asked for.
/// The future waits for the work when it goes, so nothing outlives the call that began it.
template <typename Work>
[[nodiscard]] auto beside(Parallelism parallelism, Work work) {
  return std::async(parallelism.threads > 1 ? std::launch::async : std::launch::deferred,
                    std::move(work));
}

}  // namespace pcavr
