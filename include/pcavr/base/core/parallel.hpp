// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace pcavr {

/// The number of threads that a call may use, including the caller's. Passed to every function that
/// may run in parallel.
struct Parallelism {
  int threads = 1;  ///< >= 1

  /// The number of hardware threads.
  [[nodiscard]] static Parallelism max();
};

/// Calls `body(begin, end)` for consecutive chunks of [0, count), each of `grain` items (the last
/// may be shorter). The chunks do not depend on the number of threads: a sum kept per chunk and
/// added in chunk order has the same bits for any Parallelism. Returns when all are done; the
/// first exception that a body throws is rethrown.
void parallel_for(Parallelism parallelism, std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace pcavr
