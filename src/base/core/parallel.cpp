// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/parallel.hpp"

#include <algorithm>
#include <optional>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "pcavr/base/core/check.hpp"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PCAVR_HAS_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif
#endif

namespace pcavr {
namespace {

/// A point that threads pass one after the other. oneTBB is not instrumented: without it the thread
/// sanitizer would not see that chunks begin after the call and end before it returns.
class Handover {
 public:
#ifdef PCAVR_HAS_THREAD_SANITIZER
  void release() { __tsan_release(this); }
  void acquire() { __tsan_acquire(this); }
#else
  void release() {}
  void acquire() {}
#endif
};

}  // namespace

Parallelism Parallelism::max() {
  return {std::max(1, static_cast<int>(std::thread::hardware_concurrency()))};
}

void parallel_for(Parallelism parallelism, std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  PCAVR_REQUIRE(parallelism.threads >= 1, parallelism.threads);
  PCAVR_REQUIRE(grain >= 1, grain);
  const std::size_t chunks = (count + grain - 1) / grain;
  Handover begin, end;
  const auto run_chunk = [&](std::size_t chunk) {
    begin.acquire();
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
    end.release();
  };
  if (parallelism.threads == 1 || chunks <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) run_chunk(chunk);
    return;
  }
  // By default oneTBB limits itself to the hardware threads, and prints a warning.
  std::optional<tbb::global_control> thread_limit;
  if (parallelism.threads > Parallelism::max().threads) {
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism,
                         static_cast<std::size_t>(parallelism.threads));
  }
  tbb::task_arena arena(parallelism.threads);
  begin.release();
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, run_chunk); });
  end.acquire();
}

}  // namespace pcavr
