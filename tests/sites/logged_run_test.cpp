// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/logged_run.hpp"

#include <gtest/gtest.h>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"

#include "support/temporary_folder.hpp"
#include "teleoperation/sites/site_log.hpp"

namespace pcavr {
namespace {

constexpr double kFallingRate = 600.0;  // [N/s] at which the force falls
constexpr double kFirstForce = 30.0;    // [N] at 1 s

double force_at(double t) { return kFirstForce - kFallingRate * (t - 1.0); }

/// Logs a command for the time `t`, at `now` [s].
void log_command(double now, double t, SiteLog& log) {
  LinkCommand command{.t = t};
  command.predictions.resize(1);
  command.predictions[0].rendered_force = {0.0F, static_cast<float>(force_at(t)), 0.0F};
  log.on_received(now, encode(LinkMessage{{1, 7, t}, command}));
}

// Stamps of a real log differ by microseconds from those of the samples, which here fall by 1.2 N
// from one to the next.
TEST(LoggedRun, ComparesForcesOfTheSameTime) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "robot.mcap";
  SiteScene scene{.name = "table", .version = "1", .objects = {"box"}, .T_base_objects = {Pose()}};
  auto box = BlackBox::create(file, scene);
  ASSERT_TRUE(box) << box.error().to_string();
  SiteLog& log = (*box)->log();
  log.on_start(0.0);
  log.on_sent(0.5, encode(LinkMessage{{1, 7, 0.5}, LinkWelcome{0.0, 0.01}}));
  // The first command begins the session: nothing was measured before.
  for (int i = 0; i < 30; ++i) {
    const double t = 1.0 + 0.002 * i;
    log.on_wrench(t, {t, {0.0, force_at(t), 0.0}, Eigen::Vector3d::Zero()});
    if (i % 6 == 2) log_command(t, t + (i % 12 == 2 ? 1e-5 : 9e-4), log);
  }
  log_command(1.5, 1.5, log);  // nothing was measured then
  const auto summary = (*box)->close();
  ASSERT_TRUE(summary) << summary.error().to_string();
  SceneManifest manifest;
  manifest.objects.resize(1);
  manifest.objects[0].name = "box";
  const auto run = read_logged_run(file, manifest);
  ASSERT_TRUE(run) << run.error().to_string();
  ASSERT_EQ(run->teleop->forces.size(), 4U);
  for (const ForceRow& row : run->teleop->forces) {
    EXPECT_NEAR(row.measured, row.predicted, 1e-4) << row.t;
  }
}

}  // namespace
}  // namespace pcavr
