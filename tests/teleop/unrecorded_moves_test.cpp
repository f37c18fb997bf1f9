// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/unrecorded_moves.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/command_path.hpp"

namespace pcavr {
namespace {

constexpr double kTipInterval = 0.01;             // [s]
constexpr double kGapBegin = 1.0, kGapEnd = 2.0;  // [s]

/// A tip that moves along x at `speed` [m/s] until a gap, and on from `x_after` [m] after it.
struct GappedTool {
  GappedTool(double speed, double x_after) {
    for (int i = 0; i * kTipInterval <= kGapBegin; ++i) {
      add(i * kTipInterval, -0.2 + speed * i * kTipInterval);
    }
    for (int i = 0; i * kTipInterval <= 1.0; ++i) {
      add(kGapEnd + i * kTipInterval, x_after + speed * i * kTipInterval);
    }
  }
  void add(double t, double x) {
    t_tool.push_back(t);
    p_base_tip.emplace_back(x, 0.0, 0.03);
  }
  [[nodiscard]] TipPath path() const {
    TipPath path;
    path.t = t_tool;
    path.p_base = p_base_tip;
    path.noise = 5e-5;
    return path;
  }

  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
};

TEST(UnseenMoves, AreGapsInWhichTheToolWentFartherThanItsSpeed) {
  const GappedTool jumping(0.003, 0.15);
  const std::vector<UnrecordedMove> moves = find_unrecorded_moves(jumping.path());
  ASSERT_EQ(moves.size(), 1U);
  EXPECT_NEAR(moves[0].begin, kGapBegin, 1e-9);
  EXPECT_NEAR(moves[0].end, kGapEnd, 1e-9);
  EXPECT_TRUE(find_unrecorded_moves(GappedTool(0.06, -0.08).path()).empty())
      << "a push that goes on through the gap";
  EXPECT_TRUE(find_unrecorded_moves(GappedTool(0.0, -0.2).path()).empty()) << "a tip at rest";
}

TEST(UnseenMoves, GoOverTheObjects) {
  const GappedTool tool(0.003, 0.15);
  const TipPath tip = tool.path();
  constexpr double kHeight = 0.12, kStep = 0.001;
  CommandPath command(tip, kHeight, 0.0, kStep);
  double max_speed = 0.0;
  for (std::size_t k = 1; k <= 3000; ++k) {
    const Eigen::Vector3d p_base = command.at(k);
    max_speed = std::max(max_speed, (p_base - command.at(k - 1)).norm() / kStep);
    // The object stands from -0.05 to 0.05 m.
    if (std::abs(p_base.x()) < 0.06) {
      EXPECT_NEAR(p_base.z(), kHeight, 1e-9) << k;
    }
  }
  EXPECT_LT(max_speed, 2.0);
  EXPECT_NEAR(command.at(2999).z(), 0.03, 1e-4);
}

TEST(UnseenMoves, LeaveTheObjectBetweenTheirEndsAtRest) {
  const GappedTool tool(0.003, 0.15);
  TeleopInput input;
  input.tool_radius = 0.01;
  input.objects.push_back({"box",
                           box_model("box", {0.05, 0.05, 0.03}),
                           Pose::from_translation({0.0, 0.0, 0.03}),
                           {},
                           {}});
  input.t_tool = tool.t_tool;
  input.p_base_tip = tool.p_base_tip;
  const TeleopRun run = run_teleop(input, {}).value();
  for (const ShownPose& shown : run.shown[0]) {
    ASSERT_LT(shown.T_base_object.translation().head<2>().norm(), 1e-6) << shown.t;
  }
  EXPECT_TRUE(has_note(run, "the tool was not recorded while it moved by 347 mm"));
}

}  // namespace
}  // namespace pcavr
