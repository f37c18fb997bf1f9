// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <utility>

#include "pcavr/base/core/parallel.hpp"

namespace pcavr {

/// Runs `work` on a second thread where the caller may use one, else deferred until get(). The
/// future's destructor waits for the work, so that no thread outlives the caller's scope.
template <typename Work>
[[nodiscard]] auto async_if_parallel(Parallelism parallelism, Work work) {
  return std::async(parallelism.threads > 1 ? std::launch::async : std::launch::deferred,
                    std::move(work));
}

}  // namespace pcavr
