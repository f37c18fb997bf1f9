// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/stream_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/inputs/input_monitor.hpp"

#include "physics/inputs/clock_offsets.hpp"
#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kBoxHalfEdge = 0.05;    // [m]
constexpr double kBallRadius = 0.005;    // [m]
constexpr double kSampleRate = 500.0;    // [1/s]
constexpr double kPressDepth = 0.001;    // [m]
constexpr double kBoxStiffness = 2e4;    // [N/m]
constexpr double kApproachSpeed = 0.05;  // [m/s]

TEST(StreamGaps, AreWhereSeveralSamplesAreMissing) {
  std::vector<double> t;
  for (int i = 0; i < 400; ++i) {
    const bool is_missing = i == 50 || (i > 100 && i < 200);
    if (!is_missing) t.push_back(0.01 * i);
  }
  const std::vector<StreamGap> gaps = stream_gaps(t);
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(gaps[0].begin, 1.0, 1e-9);
  EXPECT_NEAR(gaps[0].end, 2.0, 1e-9);
  EXPECT_TRUE(is_in_gap(gaps, 1.5));
  EXPECT_FALSE(is_in_gap(gaps, 2.5));
  EXPECT_TRUE(stream_gaps(std::span(t).first(1)).empty());
}

/// A tip presses a fixed box once or twice, for a second each; within [from, to] the tool's pose,
/// the force or both are missing.
class PressesWithAGap {
 public:
  PressesWithAGap(int presses, double from, double to, bool is_tool_missing,
                  bool is_force_missing) {
    for (int i = 0; i < 4000; ++i) {
      const double t = i / kSampleRate;
      double x = penetration(t, 2.0);
      if (presses > 1) x = std::max(x, penetration(t, 5.0));
      const bool is_in_gap = t > from && t < to;
      if (!is_in_gap || !is_tool_missing) {
        t_tool_.push_back(t);
        tip_.emplace_back(x - kBoxHalfEdge - kBallRadius, 0.0, 0.0);
      }
      if (is_in_gap && is_force_missing) continue;
      t_force_.push_back(t);
      force_.emplace_back(kBoxStiffness * std::max(x, 0.0), 0.0, 0.0);
    }
    series_.bodies = {{.name = "box", .model = &model_, .T_base_object = {}, .tracked = {}}};
    series_.bodies[0].is_movable = false;
    series_.tool_radius = kBallRadius;
    series_.t_tool = t_tool_;
    series_.p_base_tip = tip_;
    series_.t_force = t_force_;
    series_.force_base = force_;
    surfaces_.emplace_back(model_);
  }

  [[nodiscard]] TimeOffset offset() const {
    return penetration_offset(series_, PathView(t_tool_, tip_),
                              BodyPoses(series_.bodies, surfaces_));
  }
  [[nodiscard]] InputFindings findings() const { return examine_inputs(series_, {}); }

 private:
  /// [m] Penetration of a press for a second from `begin` [s] on; negative while the tip approaches
  /// and leaves.
  static double penetration(double t, double begin) {
    const double outside = std::max(begin - t, t - begin - 1.0);
    const double varied = 0.2 * kPressDepth * std::sin(8.0 * t);  // no saturated sensor
    return kPressDepth + varied - kApproachSpeed * std::clamp(outside, 0.0, 0.5);
  }

  CadModel model_ = box_model("box", Eigen::Vector3d::Constant(kBoxHalfEdge));
  std::vector<double> t_tool_, t_force_;
  std::vector<Eigen::Vector3d> tip_, force_;
  InputSeries series_;
  std::vector<BodySurface> surfaces_;
};

TEST(StreamGaps, ShowNoClockOffset) {
  // Interpolated, the tip leaves the box when the tool's pose comes again.
  for (const double begin : {1.7, 2.6, 2.7}) {
    for (const double end : {begin + 0.5, begin + 0.7}) {
      const TimeOffset offset = PressesWithAGap(1, begin, end, true, false).offset();
      EXPECT_FALSE(is_significant(offset, InputOptions().min_force_offset, {}))
          << begin << " to " << end << ": " << offset.offset << " +- " << offset.std;
    }
  }
}

TEST(StreamGaps, LeaveAPressOutOfTheClocksOffset) {
  for (const bool is_tool_missing : {true, false}) {
    const InputFindings found =
        PressesWithAGap(2, 1.9, 2.3, is_tool_missing, !is_tool_missing).findings();
    EXPECT_FALSE(found.fault);
    EXPECT_FALSE(found.is_force_offset_applied)
        << found.tool_to_force.offset << " +- " << found.tool_to_force.std;
  }
}

}  // namespace
}  // namespace pcavr
