// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/live_world.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <system_error>
#include <thread>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include "pcavr/base/core/check.hpp"

#include "live_cycle.hpp"

namespace pcavr {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr std::chrono::milliseconds kSwitchWait{1};  // a cycle

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

/// Locks the memory that is mapped now, on its first use (MCL_ONFAULT). Later mappings are not
/// locked, and so do not count against the limit.
void lock_memory(std::vector<std::string>& notes) {
  if (::mlockall(MCL_CURRENT | MCL_ONFAULT) == 0) return;
  notes.push_back(std::string("the world's memory is not locked and may be paged out (") +
                  std::strerror(errno) + "); allow it with ulimit -l unlimited");
}

void set_priority(std::thread& thread, int real_time_priority, std::vector<std::string>& notes) {
  const sched_param priority{.sched_priority = real_time_priority};
  const int fault = ::pthread_setschedparam(thread.native_handle(), SCHED_FIFO, &priority);
  if (fault == 0) return;
  notes.push_back(std::string("the world runs without real-time priority (") +
                  std::strerror(fault) + "); allow it with ulimit -r " +
                  std::to_string(real_time_priority));
}

}  // namespace

struct LiveWorld::Content {
  Content(HapticWorld world, std::unique_ptr<Device> device, const LiveWorldOptions& options,
          std::unique_ptr<LiveArm> arm)
      : cycle(std::move(world), std::move(device), options, std::move(arm)),
        period(static_cast<std::int64_t>(std::llround(options.cycle * 1e9))),
        thread_priority(options.thread_priority),
        max_backlog(options.max_backlog) {}

  void run() noexcept {
    std::int64_t deadline = now_in_nanoseconds() + period;
    while (!is_stopping.load(std::memory_order_relaxed)) {
      sleep_until(deadline);
      const std::int64_t begin = now_in_nanoseconds();
      if (begin - deadline >= period) ++late_cycles;
      cycle.step(in_seconds(deadline));
      const std::int64_t end = now_in_nanoseconds();
      cycle.publish(in_seconds(end - begin), late_cycles, in_seconds(end));
      deadline = next_deadline(deadline);
    }
  }

  [[nodiscard]] std::int64_t next_deadline(std::int64_t deadline) noexcept {
    const std::int64_t backlog = (now_in_nanoseconds() - deadline) / period;
    if (backlog <= max_backlog) return deadline + period;
    late_cycles += static_cast<std::uint32_t>(backlog);
    return deadline + (backlog + 1) * period;
  }

  LiveCycle cycle;
  std::int64_t period;  ///< [ns]
  int thread_priority;
  std::int64_t max_backlog;  ///< [cycles]
  std::uint32_t late_cycles = 0;
  std::atomic<bool> is_stopping{false};
  std::thread thread;
  std::vector<std::string> notes;  ///< of start()
  PageRecorder* page_recorder = nullptr;
};

LiveWorld::LiveWorld(HapticWorld world, std::unique_ptr<Device> device,
                     const LiveWorldOptions& options, std::unique_ptr<LiveArm> arm)
    : content_(std::make_unique<Content>(std::move(world), std::move(device), options,
                                         std::move(arm))) {}

LiveWorld::~LiveWorld() { stop(); }

double LiveWorld::clock() noexcept { return in_seconds(now_in_nanoseconds()); }

void LiveWorld::record(SessionRecorder& recorder) noexcept { content_->cycle.record(recorder); }

void LiveWorld::switch_recorder(SessionRecorder* recorder) noexcept {
  content_->cycle.switch_recorder(recorder);
  if (recorder != nullptr) return;
  while (content_->cycle.uses_switched_recorder()) std::this_thread::sleep_for(kSwitchWait);
}

void LiveWorld::offer(PageRecorder& recorder) noexcept { content_->page_recorder = &recorder; }

PageRecorder* LiveWorld::recorder() noexcept { return content_->page_recorder; }

Expected<std::vector<std::string>> LiveWorld::start() {
  PCAVR_REQUIRE(!content_->thread.joinable());
  std::vector<std::string> notes;
  // Memory is locked before the thread starts: mlockall takes long and blocks page faults
  // meanwhile.
  lock_memory(notes);
  try {
    content_->thread = std::thread([content = content_.get()] { content->run(); });
  } catch (const std::system_error& error) {
    return Error{.message = std::string("can't start the world's thread: ") + error.what()};
  }
  set_priority(content_->thread, content_->thread_priority, notes);
  content_->notes = notes;
  return notes;
}

void LiveWorld::stop() noexcept {
  content_->is_stopping.store(true, std::memory_order_relaxed);
  if (content_->thread.joinable()) content_->thread.join();
}

CycleTimes LiveWorld::times() const { return content_->cycle.times(); }
const std::vector<std::string>& LiveWorld::notes() const { return content_->notes; }
const std::vector<std::string>& LiveWorld::names() const { return content_->cycle.names(); }
std::string_view LiveWorld::device_name() const { return content_->cycle.device().name(); }
RemoteDevice* LiveWorld::page_device() noexcept { return content_->cycle.page_device(); }
void LiveWorld::hold(bool is_on_hold) noexcept { content_->cycle.hold(is_on_hold); }
void LiveWorld::emergency_stop() noexcept { content_->cycle.emergency_stop(); }
void LiveWorld::release_emergency_stop() noexcept { content_->cycle.release_emergency_stop(); }
void LiveWorld::reset() noexcept { content_->cycle.reset(); }
void LiveWorld::undo_reset() noexcept { content_->cycle.undo_reset(); }
void LiveWorld::set_time_scale(double scale) noexcept { content_->cycle.set_time_scale(scale); }
double LiveWorld::time_scale() const noexcept { return content_->cycle.time_scale(); }
const WorldSnapshot& LiveWorld::newest() noexcept { return content_->cycle.newest(); }

}  // namespace pcavr
