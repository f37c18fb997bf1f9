// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "support/heap_watermark.hpp"
#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

/// A push of both boxes, repeated with pauses of a second.
TeleopInput repeated(const TeleopInput& once, int times) {
  TeleopInput input = once;
  const double period = once.t_tool.back() - once.t_tool.front() + 1.0;
  for (int i = 1; i < times; ++i) {
    const double later = period * i;
    for (std::size_t k = 0; k < once.t_tool.size(); ++k) {
      input.t_tool.push_back(once.t_tool[k] + later);
      input.p_base_tip.push_back(once.p_base_tip[k]);
    }
    for (std::size_t k = 0; k < once.t_force.size(); ++k) {
      input.t_force.push_back(once.t_force[k] + later);
      input.force_base.push_back(once.force_base[k]);
    }
    for (std::size_t object = 0; object < once.objects.size(); ++object) {
      for (TrackedPose pose : once.objects[object].tracked) {
        pose.t += later;
        input.objects[object].tracked.push_back(pose);
      }
    }
  }
  return input;
}

/// A sink that only counts what it receives.
struct Counted {
  std::size_t shown = 0, forces = 0, corrections = 0;

  TeleopSink sink() {
    return {.take_shown = [this](std::size_t, const ShownPose&) -> Expected<void> {
              ++shown;
              return {};
            },
            .take_force = [this](const ForceRow&) -> Expected<void> {
              ++forces;
              return {};
            },
            .take_correction = [this](const SentCorrection&) -> Expected<void> {
              ++corrections;
              return {};
            }};
  }
};

TEST(LongRun, GivesTheSameToASinkAsItStoresWithout) {
  const TeleopInput input = plant_input(1, false).input;
  const TeleopRun kept = run_teleop(input, {}).value();
  Counted counted;
  std::vector<ShownPose> last(input.objects.size());
  TeleopSink sink = counted.sink();
  sink.take_shown = [&](std::size_t object, const ShownPose& shown) -> Expected<void> {
    ++counted.shown;
    last[object] = shown;
    return {};
  };
  const TeleopRun streamed = run_teleop(input, {}, sink).value();
  EXPECT_EQ(counted.shown, kept.shown.size() * kept.shown[0].size());
  EXPECT_EQ(counted.forces, kept.forces.size());
  EXPECT_EQ(counted.corrections, kept.corrections.size());
  EXPECT_EQ(streamed.sent_corrections, kept.corrections.size());
  EXPECT_EQ(streamed.phases.size(), kept.phases.size());
  EXPECT_TRUE(streamed.shown[0].empty());
  for (std::size_t i = 0; i < last.size(); ++i) {
    EXPECT_EQ(last[i].t, kept.shown[i].back().t);
    EXPECT_EQ(last[i].T_base_object.translation(),
              kept.shown[i].back().T_base_object.translation());
  }
}

TEST(LongRun, EndsWithTheErrorOfItsSink) {
  const TeleopInput input = plant_input(1, false).input;
  Counted counted;
  TeleopSink sink = counted.sink();
  sink.take_shown = [&](std::size_t, const ShownPose&) -> Expected<void> {
    if (++counted.shown == 100) return Error{.message = "no space left on device"};
    return {};
  };
  const Expected<TeleopRun> run = run_teleop(input, {}, sink);
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().message, "no space left on device");
  EXPECT_EQ(counted.shown, 100U);
}

TEST(LongRun, StoresNothingPerCycle) {
  const TeleopInput once = plant_input(1, true).input;
  const auto peak_of = [&](int times) {
    const TeleopInput input = repeated(once, times);
    Counted counted;
    const TeleopSink sink = counted.sink();
    HeapWatermark watermark;
    EXPECT_TRUE(run_teleop(input, {}, sink));
    return static_cast<double>(watermark.peak());
  };
  const double period = once.t_tool.back() - once.t_tool.front() + 1.0;
  const double growth = (peak_of(12) - peak_of(4)) / (8.0 * period);
  std::printf("a push lasts %.1f s; memory grows by %.0f bytes a second\n", period, growth);
  // The buffers still fill in the first minute, and the first ten: 88 bytes per force sample at 500
  // Hz, and some 100 per sample while the noise is measured. Each object's shown poses and
  // predictions at 1 kHz alone would be 400 000.
  EXPECT_LT(growth, 150e3);
}

}  // namespace
}  // namespace pcavr
