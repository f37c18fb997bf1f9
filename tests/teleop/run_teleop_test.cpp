// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kSeed = 2;

double quantile(const std::vector<double>& sorted, double fraction) {
  return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

TeleopOptions with_jitter(double jitter) {
  TeleopOptions options;
  options.jitter = jitter;
  options.seed = 4;
  return options;
}

TEST(RunTeleop, PredictsWithinMillimetresOverARoundTripOfFourTenths) {
  const PlantInput made = plant_input(kSeed, true);
  const TeleopRun run = run_teleop(made.input, {}).value();
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    const std::vector<double> errors = position_errors(made, run, i);
    ASSERT_FALSE(errors.empty());
    EXPECT_LT(quantile(errors, 0.5), 0.0015) << i;
    EXPECT_LT(quantile(errors, 0.95), 0.004) << i;
  }
  EXPECT_LT(static_cast<double>(run.correction_bytes),
            0.01 * static_cast<double>(run.streaming_bytes));
  EXPECT_FALSE(has_note(run, "too late"));
}

TEST(RunTeleop, IsDeterministicToTheBit) {
  const PlantInput made = plant_input(kSeed, false);
  TeleopOptions options = with_jitter(0.02);
  options.loss = 0.2;
  const TeleopRun one = run_teleop(made.input, options).value();
  const TeleopRun two = run_teleop(made.input, options).value();
  ASSERT_EQ(one.shown[0].size(), two.shown[0].size());
  for (std::size_t k = 0; k < one.shown[0].size(); ++k) {
    ASSERT_EQ(one.shown[0][k].T_base_object.translation(),
              two.shown[0][k].T_base_object.translation());
  }
  EXPECT_EQ(one.correction_bytes, two.correction_bytes);
  EXPECT_EQ(one.corrections.size(), two.corrections.size());
}

TEST(RunTeleop, RecoversFromWrongParametersAndPoses) {
  PlantInput made = plant_input(kSeed, true);
  for (TeleopObject& object : made.input.objects) {
    object.parameters.mass->value *= 2.0;
    object.parameters.limiting_static_friction->value *= 0.5;
    object.parameters.sliding_friction_coefficient->value *= 0.5;
    object.T_base_object = Pose::from_translation({0.008, 0.006, 0.0}) * object.T_base_object;
  }
  const TeleopRun run = run_teleop(made.input, {}).value();
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    const std::vector<double> errors = position_errors(made, run, i);
    EXPECT_LT(quantile(errors, 0.95), 0.003) << i;
  }
}

/// The last point of time at which the plant's body begins, and at which it ends, to slide.
std::pair<double, double> last_slide(const PlantInput& made, std::size_t body) {
  std::pair<double, double> slide{0.0, 0.0};
  bool is_sliding = false;
  for (const PlantPhaseChange& change : made.run.phases) {
    if (change.body != body) continue;
    if (change.phase == PlantPhase::sliding) slide.first = change.t;
    if (is_sliding) slide.second = change.t;
    is_sliding = change.phase == PlantPhase::sliding;
  }
  return slide;
}

TEST(RunTeleop, CorrectsTheForceOfASlideWhosePlaceIsRight) {
  // A friction that is too high by a quarter displaces the object by the hundredth of a millimetre
  // that the tip goes deeper.
  PlantInput made = plant_input(3, true);
  for (TeleopObject& object : made.input.objects) {
    ParameterValue& coefficient = *object.parameters.sliding_friction_coefficient;
    coefficient = {1.25 * coefficient.value, 0.05 * coefficient.value};
  }
  TeleopOptions options;
  options.correction_switch.position_stds = 100.0;  // no position is found to be wrong
  options.correction_switch.min_position_error = options.correction_switch.position_tolerance;
  const TeleopRun run = run_teleop(made.input, options).value();
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    const auto [begin, end] = last_slide(made, i);
    double measured = 0.0, rendered = 0.0;
    for (const ForceRow& row : run.forces) {
      if (row.object != i || row.t < begin + 1.2 || row.t > end - 0.1) continue;
      measured += row.measured;
      rendered += row.predicted;
    }
    ASSERT_GT(measured, 0.0) << i;
    EXPECT_NEAR(rendered / measured, 1.0, 0.05) << i;
  }
}

TEST(RunTeleop, LearnsFromPressesHowHighABodyIs) {
  PlantInput made = plant_input(3, false, {}, ToolTask::press);
  const Pose lower = Pose::from_translation({0.0, 0.0, -0.0006});
  for (TeleopObject& object : made.input.objects) {
    object.T_base_object = lower * object.T_base_object;
    for (TrackedPose& pose : object.tracked) pose.T_base_object = lower * pose.T_base_object;
  }
  const TeleopRun run = run_teleop(made.input, {}).value();
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    double largest = 0.0, end = 0.0;
    for (const ForceRow& row : run.forces) {
      if (row.object != i) continue;
      largest = std::max(largest, row.measured);
      end = std::max(end, row.t);
    }
    // The forces are those of the last two of seven presses, which take about a second each.
    double measured = 0.0, rendered = 0.0;
    for (const ForceRow& row : run.forces) {
      if (row.object != i || row.t < end - 1.5 || row.measured < 0.5 * largest) continue;
      measured += row.measured;
      rendered += row.predicted;
    }
    ASSERT_GT(measured, 0.0) << i;
    EXPECT_NEAR(rendered / measured, 1.0, 0.1) << i;
  }
}

/// [s] The first contact of an object at the robot's site.
double first_touch(const TeleopRun& run, std::size_t object) {
  for (const PhaseRow& row : run.phases) {
    if (row.object == object && row.measured == MotionPhase::static_contact) return row.t;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(RunTeleop, UsesAFirstLawWhileItsPressLasts) {
  constexpr double kUntilSent = 0.3;  // [s] after the touch
  for (const std::uint64_t seed : {51U, 52U}) {
    const PlantInput made = plant_input(seed, false, {}, ToolTask::paper);
    const TeleopOptions options;
    const TeleopRun run = run_teleop(made.input, options).value();
    for (std::size_t object = 0; object < made.input.objects.size(); ++object) {
      double assumed = 0.0;
      double used = std::numeric_limits<double>::infinity();  // [s] by the operator's site, since
      for (const ParameterRow& row : run.parameter_rows) {
        if (row.object != object || std::string_view(row.name) != "contact.stiffness") continue;
        if (assumed == 0.0) assumed = row.transmitted;
        if (row.transmitted != assumed) used = std::min(used, row.t);
      }
      EXPECT_LT(used, first_touch(run, object) + kUntilSent + options.backward_delay)
          << seed << ", object " << object;
    }
  }
}

TEST(RunTeleop, SendsTheLawOfAWholePressAfterThatOfItsBegin) {
  constexpr double kSecondPress = 4.0;  // [s]
  constexpr double kForce = 5.0;        // [N]
  int others = 0;                       // whole presses with another law than their begins
  for (const std::uint64_t seed : {3U, 5U}) {
    const PlantInput made = plant_input(seed, false, {}, ToolTask::press);
    const TeleopRun run = run_teleop(made.input, {}).value();
    double first_sent = 0.0;
    HuntCrossley running, transmitted;
    for (const ParameterRow& row : run.parameter_rows) {
      if (row.t > kSecondPress || row.object != 0) continue;
      if (std::string_view(row.name) == "contact.exponent") {
        running.exponent = row.running;
        transmitted.exponent = row.transmitted;
      }
      if (std::string_view(row.name) != "contact.stiffness") continue;
      if (first_sent == 0.0 && row.t > 1.0 && row.transmitted != transmitted.stiffness) {
        first_sent = row.transmitted;
      }
      running.stiffness = row.running;
      transmitted.stiffness = row.transmitted;
    }
    ASSERT_GT(first_sent, 0.0);
    others += std::abs(running.stiffness / first_sent - 1.0) > 0.1 ? 1 : 0;
    // A law is sent again where its force differs by more than that.
    const double penetration = static_penetration(running, kForce);
    EXPECT_NEAR(unclamped_contact_force(transmitted, penetration, 0.0), kForce,
                MessageOptions{}.min_parameter_change * kForce)
        << seed << ": " << transmitted.stiffness << ", " << running.stiffness;
  }
  EXPECT_GT(others, 0);
}

TEST(RunTeleop, KeepsCorrectingOverALinkWithJitter) {
  const PlantInput made = plant_input(kSeed, false);
  const TeleopRun even = run_teleop(made.input, {}).value();
  const TeleopRun delayed = run_teleop(made.input, with_jitter(0.02)).value();
  EXPECT_GE(2 * delayed.corrections.size(), even.corrections.size());
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    EXPECT_LT(quantile(position_errors(made, delayed, i), 0.95),
              0.002 + quantile(position_errors(made, even, i), 0.95));
  }
}

TEST(RunTeleop, NotesCorrectionsThatCameTooLate) {
  const PlantInput made = plant_input(kSeed, true);
  EXPECT_TRUE(has_note(run_teleop(made.input, with_jitter(1.5)).value(), "too late"));
}

TEST(RunTeleop, CountsNoDisplacementTwiceIfTheForceIsSampledSlowly) {
  PlantInput made = plant_input(kSeed, true);
  PlantInput slow = made;
  slow.input.t_force.clear();
  slow.input.force_base.clear();
  for (std::size_t i = 0; i < made.input.t_force.size(); i += 4) {  // 125 Hz
    slow.input.t_force.push_back(made.input.t_force[i]);
    slow.input.force_base.push_back(made.input.force_base[i]);
  }
  const TeleopRun run = run_teleop(slow.input, {}).value();
  for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
    EXPECT_LT(quantile(position_errors(made, run, i), 0.95), 0.003);
  }
}

TEST(RunTeleop, HasOnePhaseAtATimeIfARecordingBeginsInContact) {
  PlantInput made = plant_input(kSeed, true);
  const auto touch = std::find_if(
      made.run.phases.begin(), made.run.phases.end(), [](const PlantPhaseChange& change) {
        return change.body == 0 && change.phase == PlantPhase::static_friction;
      });
  ASSERT_NE(touch, made.run.phases.end());
  TeleopInput& input = made.input;
  const auto cut = std::lower_bound(input.t_tool.begin(), input.t_tool.end(), touch->t + 0.05);
  const auto first = cut - input.t_tool.begin();
  input.t_tool.erase(input.t_tool.begin(), cut);
  input.p_base_tip.erase(input.p_base_tip.begin(), input.p_base_tip.begin() + first);
  for (const bool has_wrench : {true, false}) {
    if (!has_wrench) {
      input.t_force.clear();
      input.force_base.clear();
    }
    const TeleopRun run = run_teleop(input, {}).value();
    for (std::size_t object = 0; object < input.objects.size(); ++object) {
      double last = -1e300;
      for (const PhaseRow& row : run.phases) {
        if (row.object != object) continue;
        EXPECT_GT(row.t, last) << object;
        last = row.t;
      }
    }
  }
}

TEST(RunTeleop, IgnoresAMotionOfHalfAMillisecond) {
  PlantInput made = plant_input(kSeed, true);
  made.input.t_tool.resize(2);
  made.input.p_base_tip.resize(2);
  made.input.t_tool[1] = made.input.t_tool[0] + 5e-4;
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(run.shown[0].empty());
}

TEST(RunTeleop, SendsNothingWithoutCorrections) {
  const PlantInput made = plant_input(kSeed, true);
  TeleopOptions options;
  options.with_corrections = false;
  const TeleopRun run = run_teleop(made.input, options).value();
  EXPECT_TRUE(run.corrections.empty());
  EXPECT_EQ(run.correction_bytes, 0U);
  EXPECT_GT(run.streaming_bytes, 0U);
}

/// rms of the shown position [m] over both boxes of two pushes without parameters.
double rms_without_parameters(bool parameters_by_force) {
  TeleopOptions options;
  options.messages.parameters_by_force = parameters_by_force;
  double squares = 0.0;
  std::size_t count = 0;
  for (const std::uint64_t seed : {1U, 2U}) {
    const PlantInput made = plant_input(seed, false);
    const TeleopRun run = run_teleop(made.input, options).value();
    for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
      for (const double error : position_errors(made, run, i)) {
        squares += error * error;
        ++count;
      }
    }
  }
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(RunTeleop, PredictsBetterWithAllChangedParametersThanWithOneGroupByForce) {
  EXPECT_LT(1.1 * rms_without_parameters(false), rms_without_parameters(true));
}

TEST(RunTeleop, SendsNoPositionAgainThatTheContactHasUndone) {
  const PlantInput made = plant_input(1, false);
  std::vector<int> positions(made.input.objects.size(), 0);
  const TeleopRun run = run_teleop(made.input, {}).value();
  for (const SentCorrection& sent : run.corrections) {
    const bool is_position = sent.which == CorrectionCase::both_sliding && sent.what == "position";
    if (is_position) ++positions[sent.object];
  }
  for (const int count : positions) EXPECT_LE(count, 1);
}

TEST(RunTeleop, KeepsParametersWithoutIdentification) {
  const PlantInput made = plant_input(kSeed, false);
  TeleopOptions options;
  options.identifies = false;
  const TeleopRun run = run_teleop(made.input, options).value();
  for (const ObjectParameters& known : run.parameters) {
    EXPECT_FALSE(known.limiting_static_friction);
    EXPECT_FALSE(known.contact_stiffness);
  }
}

TEST(RunTeleop, ReplaysTrackingWithoutAWrench) {
  PlantInput made = plant_input(kSeed, true);
  made.input.t_force.clear();
  made.input.force_base.clear();
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "no wrench"));
  EXPECT_TRUE(run.forces.empty());
  EXPECT_LT(quantile(position_errors(made, run, 0), 0.95), 0.006);
}

TEST(RunTeleop, DoesNotUseAForceOfTheWrongSign) {
  const PlantInput made = plant_input(kSeed, true, {.is_force_flipped = true});
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "sign"));
}

TEST(RunTeleop, DoesNotUseAForceInMillinewtons) {
  PlantInput made = plant_input(kSeed, true);
  for (Eigen::Vector3d& force : made.input.force_base) force *= 1000.0;
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "newtons"));
}

TEST(RunTeleop, NotesSensorSaturation) {
  const PlantInput made = plant_input(kSeed, false, {.saturation = 3.0});
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "saturated"));
  for (const ObjectParameters& known : run.parameters) {
    EXPECT_FALSE(known.limiting_static_friction);
  }
}

TEST(RunTeleop, SurvivesAToolThatJumps) {
  PlantInput made = plant_input(kSeed, true);
  for (std::size_t i = 300; i < 310; ++i)
    made.input.p_base_tip[i] += Eigen::Vector3d(0.4, 0.3, 0.0);
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "jumps"));
  EXPECT_LT(quantile(position_errors(made, run, 0), 0.95), 0.004);
}

TEST(RunTeleop, BridgesLossOfTracking) {
  const PlantInput made = plant_input(kSeed, true, {.lost_tracking = SensorFaults::Gap{1.6, 2.6}});
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "not tracked from"));
  EXPECT_LT(quantile(position_errors(made, run, 0), 0.95), 0.004);
}

double final_error(const PlantInput& made, const TeleopRun& run, std::size_t object) {
  const ShownPose& last = run.shown[object].back();
  const Pose truth = T_base_object_at(made.run, made.plant.bodies[object], object, last.t);
  return translation_distance(truth, last.T_base_object);
}

/// Corrections against none, of objects whose tracking ends at `t_lost` [s].
void expect_corrections_no_worse_without_tracking(bool known, double t_lost) {
  constexpr double kTolerance = 3e-4;  // a correction's rounding and the contact's std
  for (std::uint64_t seed = kSeed; seed < kSeed + 3; ++seed) {
    PlantInput made = plant_input(seed, known);
    for (TeleopObject& object : made.input.objects) {
      std::erase_if(object.tracked, [&](const TrackedPose& seen) { return seen.t > t_lost; });
    }
    TeleopOptions without;
    without.with_corrections = false;
    without.identifies = false;
    const TeleopRun corrected = run_teleop(made.input, {}).value();
    const TeleopRun uncorrected = run_teleop(made.input, without).value();
    for (std::size_t i = 0; i < made.input.objects.size(); ++i) {
      const std::vector<double> with = position_errors(made, corrected, i);
      const std::vector<double> none = position_errors(made, uncorrected, i);
      EXPECT_LT(quantile(with, 0.95), quantile(none, 0.95) + kTolerance) << seed << " " << i;
      EXPECT_LT(with.back(), none.back() + kTolerance) << seed << " " << i;
      EXPECT_LT(final_error(made, corrected, i), final_error(made, uncorrected, i) + kTolerance)
          << seed << " " << i;
    }
  }
}

TEST(RunTeleop, KeepsAnObjectThatIsNeverTrackedWhereTheContactLeftIt) {
  expect_corrections_no_worse_without_tracking(true, -1.0);
  expect_corrections_no_worse_without_tracking(false, -1.0);
}

TEST(RunTeleop, KeepsAnObjectThatIsLostForGoodWhereTheContactLeftIt) {
  expect_corrections_no_worse_without_tracking(true, 1.0);
  expect_corrections_no_worse_without_tracking(false, 1.0);
}

TEST(RunTeleop, NotesThatAnObjectWasNeverTouched) {
  PlantInput made = plant_input(kSeed, true);
  const double end = 4.0;  // before the tool reaches the second box
  while (made.input.t_tool.back() > end) {
    made.input.t_tool.pop_back();
    made.input.p_base_tip.pop_back();
  }
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, made.input.objects[1].name + " was never touched"));
}

/// Two adjacent boxes at rest, and a tip that presses on the seam between them.
TeleopInput pressed_seam() {
  constexpr double kHalf = 0.05;
  TeleopInput input;
  for (const double x : {-kHalf, kHalf}) {
    TeleopObject object{x < 0.0 ? "left" : "right",
                        box_model("box", Eigen::Vector3d::Constant(kHalf)),
                        Pose::from_translation({x, 0.1, kHalf}),
                        {},
                        {}};
    object.parameters.mass = ParameterValue{3.0};
    for (int i = 0; i < 90; ++i) {
      object.tracked.push_back({i / 30.0, object.T_base_object, 1e-4, 1e-3});
    }
    input.objects.push_back(std::move(object));
  }
  for (int i = 0; i < 1500; ++i) {
    const double t = 0.002 * i;
    const double penetration = 0.002 * std::clamp(t - 1.0, -1.0, 1.0);
    input.t_tool.push_back(t);
    input.t_force.push_back(t);
    input.p_base_tip.emplace_back(0.0, 0.05 - input.tool_radius + penetration, kHalf);
    // A periodic pattern as the sensor's noise.
    input.force_base.emplace_back(0.0, 4000.0 * std::max(penetration, 0.0) + 0.05 * (i % 3 - 1),
                                  0.0);
  }
  return input;
}

TEST(RunTeleop, NotesThatTheTipTouchesTwoObjects) {
  const TeleopRun run = run_teleop(pressed_seam(), {}).value();
  EXPECT_TRUE(has_note(run, "and another object"));
  EXPECT_LT(run.notes.size(), 10U);  // once per contact, not per sample
  for (const ObjectParameters& learned : run.parameters) {
    EXPECT_FALSE(learned.contact_stiffness.has_value());
  }
}

/// [s] Time from an object's true first touch to the measured one.
double touch_error(const PlantInput& made, const TeleopRun& run, std::size_t object) {
  const auto measured = std::find_if(run.phases.begin(), run.phases.end(), [&](const auto& row) {
    return row.object == object && row.measured == MotionPhase::static_contact;
  });
  const auto truth = std::find_if(
      made.run.phases.begin(), made.run.phases.end(), [&](const PlantPhaseChange& change) {
        return change.body == object && change.phase == PlantPhase::static_friction;
      });
  return measured == run.phases.end() ? 1e3 : measured->t - truth->t;
}

TEST(RunTeleop, CorrectsAClockOffsetOfATenthOfASecond) {
  const PlantInput made = plant_input(kSeed, true, {.clock_offset = 0.1});
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(has_note(run, "the force lags"));
  ASSERT_TRUE(run.inputs.is_force_offset_applied);
  EXPECT_NEAR(run.inputs.tool_to_force.offset, 0.1, 3.0 * run.inputs.tool_to_force.std);
  // The first push has shown it when the second begins.
  EXPECT_NEAR(touch_error(made, run, 0), 0.1, 0.045);
  EXPECT_NEAR(touch_error(made, run, 1), 0.0, 0.045);
  // Known beforehand, it is subtracted from the start.
  TeleopOptions calibrated;
  calibrated.sensors.force_offset = run.inputs.tool_to_force.offset;
  const TeleopRun again = run_teleop(made.input, calibrated).value();
  EXPECT_NEAR(touch_error(made, again, 0), 0.0, 0.045);
  EXPECT_FALSE(again.inputs.is_force_offset_applied);
}

TEST(RunTeleop, HasBothPhasesFromTheStart) {
  const PlantInput made = plant_input(kSeed, true);
  const TeleopRun run = run_teleop(made.input, {}).value();
  ASSERT_GE(run.phases.size(), 2U);
  EXPECT_EQ(run.phases[0].t, made.input.t_tool.front());
  EXPECT_EQ(run.phases[1].t, made.input.t_tool.front());
  for (std::size_t i = 1; i < run.phases.size(); ++i) {
    EXPECT_GE(run.phases[i].t, run.phases[i - 1].t);
  }
}

/// The same recording with its stamps shifted by -`earlier` seconds.
TeleopInput shifted(TeleopInput input, double earlier) {
  for (double& t : input.t_tool) t -= earlier;
  for (double& t : input.t_force) t -= earlier;
  for (TeleopObject& object : input.objects) {
    for (TrackedPose& pose : object.tracked) pose.t -= earlier;
  }
  return input;
}

TEST(RunTeleop, WorksWithNegativeStamps) {
  const TeleopInput input = plant_input(3, true).input;
  const TeleopRun known = run_teleop(input, {}).value();
  for (const double earlier : {0.002, 1000.0}) {
    const Expected<TeleopRun> run = run_teleop(shifted(input, earlier), {});
    ASSERT_TRUE(run.has_value()) << run.error().to_string();
    ASSERT_EQ(run->shown.size(), known.shown.size());
    for (std::size_t i = 0; i < known.shown.size(); ++i) {
      ASSERT_EQ(run->shown[i].size(), known.shown[i].size());
      const ShownPose& last = run->shown[i].back();
      EXPECT_NEAR(last.t, known.shown[i].back().t - earlier, 1e-9);
      // Decisions may differ by a stamp's rounding, and the shown pose then by the error that
      // corrections tolerate [m].
      EXPECT_LT(translation_distance(last.T_base_object, known.shown[i].back().T_base_object),
                2e-3);
    }
  }
}

TEST(RunTeleop, RejectsMoreObjectsThanAMessageCanAddress) {
  TeleopInput input = plant_input(3, true).input;
  input.objects.resize(256, input.objects.front());
  const Expected<TeleopRun> run = run_teleop(input, {});
  ASSERT_FALSE(run.has_value());
  EXPECT_NE(run.error().to_string().find("256 movable objects"), std::string::npos);
}

TEST(RunTeleop, PredictsNothingWithoutATool) {
  PlantInput made = plant_input(kSeed, true);
  made.input.t_tool.clear();
  made.input.p_base_tip.clear();
  const TeleopRun run = run_teleop(made.input, {}).value();
  EXPECT_TRUE(run.shown[0].empty());
  EXPECT_FALSE(run.notes.empty());
}

}  // namespace
}  // namespace pcavr
