// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <utility>

#include "pcavr/base/core/parallel.hpp"

#include "pipeline/replay/async_if_parallel.hpp"

namespace pcavr {

/// Prefetches one item: runs a producer one step ahead of its consumer, on a second thread where
/// one may be used. Calls of the producer never overlap, so results do not depend on the number of
/// threads.
template <typename Producer>
class Prefetcher {
 public:
  using Item = decltype(std::declval<Producer&>()());

  Prefetcher(Producer producer, Parallelism parallelism)
      : producer_(std::move(producer)), parallelism_(parallelism) {
    start();
  }
  ~Prefetcher() {
    if (next_.valid()) next_.wait();
  }
  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;

  /// Waits for the prefetched item, and starts the next unless `is_last(item)`.
  template <typename IsLast>
  [[nodiscard]] Item take(IsLast&& is_last) {
    Item item = next_.get();
    if (!is_last(item)) start();
    return item;
  }

 private:
  void start() {
    next_ = async_if_parallel(parallelism_, [this] { return producer_(); });
  }

  Producer producer_;
  Parallelism parallelism_;
  std::future<Item> next_;
};

}  // namespace pcavr
