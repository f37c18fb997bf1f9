// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <utility>

#include "pcavr/core/parallel.hpp"

#include "beside.hpp"

namespace pcavr {

/// Runs a producer one step ahead of its consumer, on a second thread where there is one. The
/// producer is never called twice at once, so results do not depend on the number of threads.
template <typename Producer>
class OneAhead {
 public:
  using Item = decltype(std::declval<Producer&>()());

  OneAhead(Producer producer, Parallelism parallelism)
      : producer_(std::move(producer)), parallelism_(parallelism) {
    start();
  }
  ~OneAhead() {
    if (next_.valid()) next_.wait();
  }
  OneAhead(const OneAhead&) = delete;
  OneAhead& operator=(const OneAhead&) = delete;

  /// The item made meanwhile; `is_last` of it decides whether another is begun.
  template <typename IsLast>
  [[nodiscard]] Item take(IsLast&& is_last) {
    Item item = next_.get();
    if (!is_last(item)) start();
    return item;
  }

 private:
  void start() {
    next_ = beside(parallelism_, [this] { return producer_(); });
  }

  Producer producer_;
  Parallelism parallelism_;
  std::future<Item> next_;
};

}  // namespace pcavr
