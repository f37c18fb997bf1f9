// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/operator_page.hpp"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/teleop/live_sites.hpp"

#include "serve/live_cycle_fixture.hpp"
#include "teleop/retraction_message.hpp"

namespace pcavr {
namespace {

// The page shows the robot's tool where it is moved out of an object, and not in the object.
TEST(OperatorPage, ShowsTheToolWhereItIsRetractedTo) {
  constexpr double kRetraction = 0.005;  // [m]
  DeviceSample sample{test::kToolStart, Eigen::Quaterniond::Identity(), false, true};
  HapticWorldModel model = test::one_box_on_a_table();
  const WorldBody box = model.world.bodies.front();
  TeleopInput world;
  world.tool_radius = model.world.tool_radius;
  world.objects.push_back({box.model.name, box.model, box.T_base_object, {}, {}});
  auto site = LiveOperatorSite::create(world, {}, 0.0, test::kToolStart).value();
  auto page = OperatorPage::create(std::move(model), {box.model.name},
                                   std::make_unique<test::ScriptedDevice>(sample),
                                   test::options_with_tool_start(), MotionLimits())
                  .value();
  static_cast<void>(page->p_base_start(0, nullptr));
  page->begin(site);
  const auto step = [&] { return page->step(0, site, OperatorLink()); };
  static_cast<void>(step());
  const Eigen::Vector3d before = page->newest().world.p_base_proxy.cast<double>();
  const Eigen::Vector3d up(0.0, 0.0, kRetraction);
  ASSERT_TRUE(site.apply(site.now(), retraction_message(site.now(), 0, up)));
  Eigen::Vector3d command = Eigen::Vector3d::Zero();
  for (int i = 0; i < 200; ++i) command = step().p_base_tip;
  EXPECT_NEAR(site.tool_offset().z(), kRetraction, 1e-4);
  const Eigen::Vector3d shown = page->newest().world.p_base_proxy.cast<double>();
  EXPECT_TRUE((shown - before - site.tool_offset()).isZero(1e-6)) << shown.transpose();
  EXPECT_TRUE((shown - command - site.tool_offset()).isZero(1e-6));  // the site adds it itself
}

}  // namespace
}  // namespace pcavr
