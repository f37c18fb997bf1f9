// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Time per cycle of an operator's device in the world's thread: RemoteDevice with a page that sends
// at 90 Hz (a cycle with a new sample is the slowest), a trace and the simulated hand.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "pcavr/teleoperation/devices/simulated_force_device.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "devices/jittered_hand.hpp"

namespace {

constexpr double kDuration = 60.0;  // [s] of simulated time

class Times {
 public:
  template <typename Step>
  auto measure(const Step& step) {
    const auto start = std::chrono::steady_clock::now();
    const auto result = step();
    times_.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
            .count());
    return result;
  }
  void print(const char* what) {
    std::sort(times_.begin(), times_.end());
    const std::size_t n = times_.size();
    std::printf("%-24s p50 %6.3f  p99 %6.3f  p99.9 %6.3f  max %6.3f us\n", what, times_[n / 2],
                times_[n * 99 / 100], times_[n * 999 / 1000], times_.back());
  }

 private:
  std::vector<double> times_;
};

void time_alone(pcavr::Device& device) {
  Times times;
  pcavr::DeviceFeedback feedback;
  for (int i = 0; i * pcavr::test::kCycle < kDuration; ++i) {
    const double t = i * pcavr::test::kCycle;
    feedback.p_base_tool =
        times.measure([&] { return device.exchange(t, pcavr::test::kCycle, feedback); }).p_base_tip;
  }
  times.print(device.name().data());
}

void time_remote() {
  pcavr::RemoteDevice device;
  const auto samples = pcavr::test::sent_over({.interval = 1.0 / 90.0}, kDuration, 1);
  Times times;
  double total_delay = 0.0;
  std::size_t next = 0;
  int cycles = 0;
  for (; cycles * pcavr::test::kCycle < kDuration; ++cycles) {
    const double t = cycles * pcavr::test::kCycle;
    for (; next < samples.size() && samples[next].arrival <= t; ++next) {
      (void)device.push(samples[next]);
    }
    (void)times.measure([&] { return device.exchange(t, pcavr::test::kCycle, {}); });
    total_delay += device.status().delay;
  }
  times.print("remote at 90 Hz");
  std::printf("%-24s jitter buffer delay %.1f ms in the mean, interval %.1f ms\n", "",
              1e3 * total_delay / cycles, 1e3 / 90.0);
}

}  // namespace

int main() {
  time_remote();
  pcavr::SimulatedForceDevice simulated;
  time_alone(simulated);
  std::vector<pcavr::TraceSample> rows;
  for (int i = 0; i * 0.002 < kDuration; ++i) {
    rows.push_back({.t = i * 0.002, .p_base_tip = pcavr::test::CirclingHand()(i * 0.002)});
  }
  pcavr::TraceDevice trace(std::move(rows));
  time_alone(trace);
}
