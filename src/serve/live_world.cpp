// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/live_world.hpp"

#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <system_error>
#include <thread>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include "pcavr/core/check.hpp"

#include "live_cycle.hpp"

namespace pcavr {
namespace {

// Over ordinary programs, under what a machine runs for itself at 50 and above.
constexpr int kPriority = 20;
// What is more than this in arrears is left out: a hand has gone on since then.
constexpr std::int64_t kMaxArrears = 20;
constexpr std::int64_t kNanoseconds = 1'000'000'000;

std::int64_t now_in_nanoseconds() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * kNanoseconds + now.tv_nsec;
}

void sleep_until(std::int64_t deadline) noexcept {
  const timespec until{static_cast<time_t>(deadline / kNanoseconds),
                       static_cast<long>(deadline % kNanoseconds)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

double in_seconds(std::int64_t nanoseconds) noexcept {
  return static_cast<double>(nanoseconds) * 1e-9;
}

/// What is there already stays; what comes later does not count against the limit.
void keep_memory(std::vector<std::string>& notes) {
  if (::mlockall(MCL_CURRENT | MCL_ONFAULT) == 0) return;
  notes.push_back(std::string("the world's memory may be paged out (") + std::strerror(errno) +
                  "); ulimit -l unlimited permits to keep it");
}

void ask_for_real_time(std::thread& thread, std::vector<std::string>& notes) {
  const sched_param priority{.sched_priority = kPriority};
  const int refused = ::pthread_setschedparam(thread.native_handle(), SCHED_FIFO, &priority);
  if (refused == 0) return;
  notes.push_back(std::string("the world runs without real-time priority (") +
                  std::strerror(refused) + "); ulimit -r " + std::to_string(kPriority) +
                  " permits it");
}

}  // namespace

struct LiveWorld::Content {
  Content(HapticWorld world, std::unique_ptr<Device> device, const LiveWorldOptions& options)
      : cycle(std::move(world), std::move(device), options),
        period(static_cast<std::int64_t>(std::llround(options.cycle * 1e9))) {}

  void run() noexcept {
    std::int64_t deadline = now_in_nanoseconds() + period;
    while (!is_ending.load(std::memory_order_relaxed)) {
      sleep_until(deadline);
      const std::int64_t begin = now_in_nanoseconds();
      if (begin - deadline >= period) ++late;
      cycle.step(in_seconds(deadline));
      const std::int64_t end = now_in_nanoseconds();
      cycle.publish(in_seconds(end - begin), late, in_seconds(end));
      deadline = next_after(deadline);
    }
  }

  [[nodiscard]] std::int64_t next_after(std::int64_t deadline) noexcept {
    const std::int64_t arrears = (now_in_nanoseconds() - deadline) / period;
    if (arrears <= kMaxArrears) return deadline + period;
    late += static_cast<std::uint32_t>(arrears);
    return deadline + (arrears + 1) * period;
  }

  LiveCycle cycle;
  std::int64_t period;  ///< [ns]
  std::uint32_t late = 0;
  std::atomic<bool> is_ending{false};
  std::thread thread;
};

LiveWorld::LiveWorld(HapticWorld world, std::unique_ptr<Device> device,
                     const LiveWorldOptions& options)
    : content_(std::make_unique<Content>(std::move(world), std::move(device), options)) {}

LiveWorld::~LiveWorld() { stop(); }

double LiveWorld::clock() noexcept { return in_seconds(now_in_nanoseconds()); }

Expected<std::vector<std::string>> LiveWorld::start() {
  PCAVR_REQUIRE(!content_->thread.joinable());
  std::vector<std::string> notes;
  // First: it takes long, and holds up whoever touches new memory meanwhile.
  keep_memory(notes);
  try {
    content_->thread = std::thread([content = content_.get()] { content->run(); });
  } catch (const std::system_error& error) {
    return Error{.message = std::string("no thread for the world: ") + error.what()};
  }
  ask_for_real_time(content_->thread, notes);
  return notes;
}

void LiveWorld::stop() noexcept {
  content_->is_ending.store(true, std::memory_order_relaxed);
  if (content_->thread.joinable()) content_->thread.join();
}

CycleTimes LiveWorld::times() const { return content_->cycle.times(); }
const std::vector<std::string>& LiveWorld::names() const { return content_->cycle.names(); }
std::string_view LiveWorld::device_name() const { return content_->cycle.device().name(); }
RemoteDevice* LiveWorld::page_device() noexcept { return content_->cycle.page_device(); }
void LiveWorld::hold(bool is_on_hold) noexcept { content_->cycle.hold(is_on_hold); }
void LiveWorld::reset() noexcept { content_->cycle.reset(); }
const WorldSnapshot& LiveWorld::newest() noexcept { return content_->cycle.newest(); }

}  // namespace pcavr
