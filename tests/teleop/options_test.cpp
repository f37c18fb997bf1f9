// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/options.hpp"

#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/options.hpp"

#include "support/option_defaults.hpp"
#include "teleoperation/teleop/correction_switch.hpp"
#include "teleoperation/teleop/phase_monitor.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

TEST(TeleopOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<TeleopOptions>();
  test::expect_documented_defaults<InputOptions>();
  test::expect_documented_defaults<SensorPriorOptions>();
  test::expect_documented_defaults<TouchOptions>();
  test::expect_documented_defaults<PhaseMonitorOptions>();
  test::expect_documented_defaults<PoseFusionOptions>();
  test::expect_documented_defaults<LearningOptions>();
  test::expect_documented_defaults<CorrectionSwitchOptions>();
  test::expect_documented_defaults<MessageOptions>();
}

TEST(TeleopOptions, AreOfThisPlanetAndOfAnOrdinaryLink) {
  const TeleopOptions options;
  EXPECT_EQ(options.gravity(), kStandardGravity);
  EXPECT_EQ(options.round_trip(), 0.4);
  EXPECT_EQ(options.seed, 1U);
}

TEST(TeleopOptions, SectionsHaveDistinctNames) {
  TeleopOptions options;
  std::set<std::string> names;
  for (const OptionSection& section : sections_of(options)) {
    EXPECT_TRUE(names.insert(section.name).second) << section.name;
  }
  EXPECT_TRUE(names.contains("teleop.switch"));
}

TEST(TeleopOptions, SectionsSetTheNestedOptions) {
  TeleopOptions options;
  for (const OptionSection& section : sections_of(options)) {
    if (section.name != "identification.segmentation") continue;
    for (const OptionRow& row : section.rows) {
      if (row.name == "min_force") row.set(2.5);
    }
  }
  EXPECT_EQ(options.learning.segmentation.min_force, 2.5);
}

TEST(TeleopOptions, SpeedWindowsMustBeInOrder) {
  PhaseMonitorOptions options;
  const OptionSection section = section_of(options);
  EXPECT_FALSE(section.check());
  options.min_speed_window = 0.2;
  ASSERT_TRUE(section.check());
  EXPECT_EQ(section.check()->place, "teleop.phases");
}

/// When the switch asks for a correction of forces that differ by 1.5 N [s]; < 0: never.
double correction_time(const CorrectionSwitchOptions& options) {
  CorrectionSwitch correction_switch(options, 0.3, 0.4);
  for (double t = 0.0; t < 1.0; t += 0.002) {
    SiteComparison seen;
    seen.t = t;
    seen.robot_touches = seen.operator_touches = true;
    seen.robot_force = 10.0;
    seen.operator_force = 11.5;
    if (correction_switch.evaluate(seen, 0.0)) return t;
  }
  return -1.0;
}

TEST(TeleopOptions, ForceToleranceAndPersistenceDecideOnACorrection) {
  CorrectionSwitchOptions options;
  EXPECT_NEAR(correction_time(options), 0.040, 0.004);
  options.force_persistence = 0.2;
  EXPECT_NEAR(correction_time(options), 0.2, 0.004);
  options.force_tolerance = 0.2;
  EXPECT_LT(correction_time(options), 0.0);
}

/// Number of phases of 3 samples of 5 N on a tip that rests at an object, and 3 without force.
std::size_t phases_of_a_tap(const PhaseMonitorOptions& options) {
  PhaseMonitor monitor(0.0, {}, options);
  for (int i = 0; i < 30; ++i) {
    MonitorSample sample;
    sample.t = 0.002 * i;
    sample.is_within_reach = true;
    if (i >= 10 && i < 13) sample.force_base.x() = 5.0;
    monitor.step(sample, std::nullopt, 0.0);
  }
  return monitor.changes().size();
}

TEST(TeleopOptions, DebouncingDecidesWhatIsAContact) {
  PhaseMonitorOptions options;
  EXPECT_EQ(phases_of_a_tap(options), 3U);  // until the force is gone
  options.debounce_samples = 4;
  EXPECT_EQ(phases_of_a_tap(options), 1U);
}

TEST(TeleopOptions, SmallParameterChangesAreSentIfWanted) {
  BodyPhysics physics;
  physics.friction.mass = 1.0;
  physics.friction.limiting_force = 5.0;
  physics.friction.coulomb_force = 4.0;
  physics.contact = {.stiffness = 1e4, .damping = 0.0, .exponent = 1.0};
  physics.friction_radius = 0.05;
  const ObjectParameters before = sent_parameters(physics);
  physics.friction.limiting_force = 5.1;
  const ObjectParameters after = sent_parameters(physics);
  MessageOptions options;
  EXPECT_FALSE(difference(after, before, nullptr, options).has_friction);
  options.min_parameter_change = 0.01;
  EXPECT_TRUE(difference(after, before, nullptr, options).has_friction);
}

}  // namespace
}  // namespace pcavr
