// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Time per cycle of the haptic world: ten boxes in contact, pushed along a table that the tool is
// pressed into, scanned with 300 000 triangles. The counters are median, p99, p99.9 and max over
// the cycles; the time is that of all 4000. Target for the whole 1 kHz step: p99.9 below 250 us.
#include <algorithm>
#include <chrono>
#include <vector>

#include <benchmark/benchmark.h>

#include "haptics/tabletop.hpp"

namespace {

using pcavr::test::kCycle;

constexpr int kCycles = 4000;
constexpr int kRuns = 7;

/// The row along x and 0.4 m of free table before it.
pcavr::HapticWorldModel ten_boxes(double noise) {
  pcavr::HapticWorldModel model;
  model.world = pcavr::test::row_of_boxes(10, 0.0);
  // 612 x 245 squares of 4 mm.
  model.world.static_mesh_base =
      pcavr::test::scanned_table(noise, 0.004, {-0.25, -0.49}, {2.2, 0.49});
  model.supports_base = {
      {{-0.25, -0.49, 0.0}, {2.2, -0.49, 0.0}, {2.2, 0.49, 0.0}, {-0.25, 0.49, 0.0}}};
  return model;
}

/// The tip goes down to 3 mm into the table, and on into the row at 0.1 m/s, oscillating sideways.
Eigen::Vector3d tip_at(int cycle) {
  const double t = cycle * kCycle;
  return {-0.12 + 0.1 * t, 0.02 * std::sin(4.0 * t), std::max(0.007, 0.03 - 0.1 * t)};
}

/// Takes the minimum over all runs for each cycle, which excludes other load: the same cycle does
/// the same work in each run.
void step_all(benchmark::State& state, const pcavr::HapticWorldModel& model) {
  pcavr::HapticWorld world = pcavr::HapticWorld::create(model).value();
  std::vector<double> fastest(kCycles, 1e9);
  for (auto _ : state) {
    world.reset(tip_at(0));
    for (int i = 0; i < kCycles; ++i) {
      const auto start = std::chrono::steady_clock::now();
      world.step({tip_at(i), true}, kCycle);
      const std::chrono::duration<double, std::micro> elapsed =
          std::chrono::steady_clock::now() - start;
      double& best = fastest[static_cast<std::size_t>(i)];
      best = std::min(best, elapsed.count());
    }
  }
  std::sort(fastest.begin(), fastest.end());
  state.counters["p50_us"] = fastest[kCycles / 2];
  state.counters["p99_us"] = fastest[kCycles * 99 / 100];
  state.counters["p99.9_us"] = fastest[kCycles * 999 / 1000];
  state.counters["max_us"] = fastest.back();
}

void TenTouchingBoxes(benchmark::State& state) {
  step_all(state, ten_boxes(1e-4 * static_cast<double>(state.range(0))));
}
BENCHMARK(TenTouchingBoxes)
    ->ArgName("noise_in_0.1_mm")
    ->Arg(0)
    ->Arg(3)
    ->Arg(10)
    ->Iterations(kRuns)
    ->Unit(benchmark::kMillisecond);

/// The tool slides on the table, far from all boxes.
void TenBoxesAtRest(benchmark::State& state) {
  pcavr::HapticWorldModel model = ten_boxes(3e-4);
  for (pcavr::WorldBody& body : model.world.bodies) {
    body.T_base_object = pcavr::Pose::from_translation({0.0, 0.35, 0.0}) * body.T_base_object;
  }
  step_all(state, model);
}
BENCHMARK(TenBoxesAtRest)->Iterations(kRuns)->Unit(benchmark::kMillisecond);

}  // namespace
