// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <future>
#include <utility>

#include <pthread.h>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/thread_priority.hpp"

#include "teleoperation/teleop/background.hpp"

namespace pcavr {

/// Result that another thread computes while the samples go on, used from a time of the data on:
/// whether it was ready by then or is waited for, and whether a thread computed it or the caller
/// does then, leaves no trace in the results. The destructor waits for the thread. A thread for a
/// real-time loop has real-time priority, too, below that loop's: else a loaded machine delays what
/// the loop needs. An exception of the work is its result: it does not end the site.
template <typename Result>
class DelayedResult {
 public:
  /// `due` [s]: from then on the result is used.
  template <typename Work>
  DelayedResult(const Background& background, const char* task, double due, Work work)
      : due_(due),
        result_(std::async(background.policy,
                           [background, task, loop = real_time_priority(),
                            work = std::move(work)]() mutable -> Expected<Result> {
                             if (background.policy == std::launch::async) {
                               follow_real_time(::pthread_self(), loop);
                             }
                             return caught([&]() -> Result {
                               if (background.before_task) background.before_task(task);
                               return work();
                             });
                           })
                    .share()) {}

  [[nodiscard]] bool is_due(double t) const { return t >= due_; }
  /// Whether its use at `t` [s] would wait for the thread.
  [[nodiscard]] bool would_wait(double t) const {
    return is_due(t) && result_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
  }
  /// Waits for it. An Error: the work failed.
  [[nodiscard]] const Expected<Result>& get() const { return result_.get(); }

 private:
  double due_;  ///< [s]
  std::shared_future<Expected<Result>> result_;
};

}  // namespace pcavr
