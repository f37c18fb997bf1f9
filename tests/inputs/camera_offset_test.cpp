// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/inputs/clock_offsets.hpp"
#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kBoxHalfSize = 0.05;     // [m]
constexpr double kPushingRadius = 0.005;  // [m]
constexpr double kPushBegin = 1.0;        // [s]
constexpr double kPushDuration = 1.0;     // [s]

struct TrackingErrors {
  double std = 0.0;          ///< [m] of a frame
  double correlation = 0.0;  ///< with that of the frame before
  double compression = 0.0;  ///< [m] of the contact while it slides, in excess of what is known
  double delay = 0.0;        ///< [s] of the stamps
  double first = 0.0;        ///< [s] from when on all is recorded
};

/// The offset that one push of a box at `speed` [m/s] gives, tracked at 30 Hz.
TimeOffset offset_of_push(double speed, const TrackingErrors& errors, unsigned seed) {
  const auto pushed = [&](double t) {
    return speed * std::clamp(t - kPushBegin, 0.0, kPushDuration);
  };
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  Contact push;
  push.object = 0;
  push.normal_object = -Eigen::Vector3d::UnitX();
  push.begin = std::max(kPushBegin, errors.first);
  push.end = kPushBegin + kPushDuration;
  push.direction_base = Eigen::Vector3d::UnitX();
  push.slides = {{.begin = push.begin, .end = kPushBegin + kPushDuration}};
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.001 * i;
    if (t < errors.first) continue;
    t_tool.push_back(t);
    p_base_tip.push_back({pushed(t) - kBoxHalfSize - kPushingRadius, 0.0, 0.0});
    push.t.push_back(t);
    push.tool.push_back(p_base_tip.back().x());
    push.force.push_back(5.0);
  }
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise;
  std::vector<TrackedPose> tracked;
  double error = errors.std * noise(generator);
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    if (t < errors.first) continue;
    const bool is_sliding = t > kPushBegin && t < kPushBegin + kPushDuration;
    error = errors.correlation * error +
            errors.std * std::sqrt(1.0 - std::pow(errors.correlation, 2)) * noise(generator);
    const double x = pushed(t) + error - (is_sliding ? errors.compression : 0.0);
    tracked.push_back({.t = t + errors.delay,
                       .T_base_object = Pose::from_translation(Eigen::Vector3d(x, 0.0, 0.0))});
  }
  const CadModel model = box_model("box", Eigen::Vector3d::Constant(kBoxHalfSize));
  InputSeries series{.tool_radius = kPushingRadius, .t_tool = t_tool, .p_base_tip = p_base_tip};
  series.bodies = {{.name = "box", .model = &model, .T_base_object = {}, .tracked = tracked}};
  std::vector<BodySurface> surfaces;
  surfaces.emplace_back(model);
  return camera_offset(series, surfaces, PathView(t_tool, p_base_tip), {&push, 1}, 0.02);
}

TEST(CameraOffset, IsThatOfTheStamps) {
  const TimeOffset offset = offset_of_push(0.05, {.std = 1e-4, .delay = 0.06}, 1);
  ASSERT_TRUE(offset.is_known);
  EXPECT_NEAR(offset.offset, 0.06, 3.0 * offset.std);
  EXPECT_LT(offset.std, 0.008);
}

TEST(CameraOffset, IsNotKnownWhereThePoseIsOffRatherThanLate) {
  // The pose jumps by 3 mm as the push begins, and back as it ends: its middle alone fits a lag.
  for (const double jump : {-0.003, 0.003}) {
    const TimeOffset offset = offset_of_push(0.05, {.std = 1e-4, .compression = jump}, 1);
    EXPECT_FALSE(offset.is_known && std::abs(offset.offset) > 3.0 * offset.std)
        << offset.offset << " +- " << offset.std;
  }
}

TEST(CameraOffset, IsNotKnownOfAPushThatWasUnderWayWhenTheRecordingBegan) {
  for (const double first : {1.1, 1.3, 1.5}) {
    EXPECT_FALSE(offset_of_push(0.05, {.std = 1e-4, .delay = 0.06, .first = first}, 1).is_known);
  }
}

TEST(CameraOffset, StaysWithinItsStdWhereErrorsLastForManyFrames) {
  double squares = 0.0;
  constexpr int kPushes = 100;
  for (unsigned seed = 0; seed < kPushes; ++seed) {
    const double sign = seed % 2 == 0 ? 1.0 : -1.0;
    const TimeOffset offset =
        offset_of_push(0.01, {.std = 1e-4, .correlation = 0.8, .compression = sign * 1e-4}, seed);
    squares += std::pow(offset.offset / offset.std, 2);
    EXPECT_LT(std::abs(offset.offset), 4.0 * offset.std) << seed;
  }
  EXPECT_LT(std::sqrt(squares / kPushes), 1.2);
}

}  // namespace
}  // namespace pcavr
