// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "pipeline/identified_case.hpp"
#include "support/report_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// Both boxes' first probe ends here: presses, ten breakaways and a slide of the first.
constexpr double kFirstProbe = 27.5;  // [s]
constexpr double kWhole = 600.0;      // [s] longer than any case

/// Simulated once: a plant at 20 kHz takes a second.
const IdentifiedCase& probe() {
  static const IdentifiedCase made = identified_case(ToolTask::probe, 2, kFirstProbe);
  return made;
}

const PlantParameters& truth() { return probe().plant.bodies[0].parameters; }

std::string error_of(const IdentificationInput& input,
                     IdentificationGoal goal = IdentificationGoal::friction) {
  const Expected<Identification> found = identify(input, goal);
  return found ? std::string("no error") : found.error().to_string();
}

bool has_note(const std::vector<std::string>& notes, const std::string& text) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

void expect_friction(const ObjectIdentification& found) {
  EXPECT_NEAR(found.parameters.limiting_static_friction->value, truth().limiting_static_friction,
              0.02 * truth().limiting_static_friction);
  ASSERT_TRUE(found.sliding.mass.is_excited);
  EXPECT_NEAR(found.parameters.mass->value, truth().mass, 0.05 * truth().mass);
  const double coulomb = truth().sliding_friction_coefficient * truth().mass * kStandardGravity;
  EXPECT_NEAR(found.sliding.coulomb.value, coulomb, 0.03 * coulomb);
}

TEST(Identify, SegmentsAWholeRecordingAndFindsFrictionAndMass) {
  const auto found = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectIdentification& box = found->objects[0];
  EXPECT_EQ(box.press_count, 3);
  EXPECT_GE(box.limit.pushes, 10);
  EXPECT_LT(box.limit.std, 0.3);
  expect_friction(box);
  EXPECT_LT(std::abs(found->inputs.tool_to_force.offset), 0.002);
  EXPECT_FALSE(found->inputs.is_force_offset_applied);
  EXPECT_TRUE(has_note(found->objects[1].notes, "never touched"));
}

TEST(Identify, FindsTheContactLawFromPresses) {
  const auto found = identify(probe().input, IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectParameters& p = found->objects[0].parameters;
  // Compares the penetration at a force. The tip's noise is 0.05 mm.
  const auto penetration = [](double force, double k, double n) {
    return std::pow(force / k, 1.0 / n);
  };
  for (const double force : {2.0, 5.0, 10.0}) {
    const double exact = penetration(force, truth().contact_stiffness, truth().contact_exponent);
    EXPECT_NEAR(penetration(force, p.contact_stiffness->value, p.contact_exponent->value), exact,
                std::max(0.02e-3, 0.05 * exact));
  }
  EXPECT_EQ(found->objects[0].comparison.size(), 3U);
  EXPECT_FALSE(p.limiting_static_friction.has_value());
}

/// The input of `probe` with its first box stated `lowered` [m] below where it was pressed.
IdentificationInput lowered_box(double lowered) {
  IdentificationInput input = probe().input;
  const auto lower = [&](Pose& T) {
    T = Pose(T.rotation(), T.translation() - lowered * Eigen::Vector3d::UnitZ());
  };
  IdentifiableObject& box = input.objects[0];
  lower(box.T_base_object);
  for (TrackedPose& tracked : box.tracked) lower(tracked.T_base_object);
  return input;
}

TEST(Identify, FindsWhereThePressesMetTheSurface) {
  const auto exact = identify(probe().input, IdentificationGoal::contact);
  ASSERT_TRUE(exact.has_value()) << exact.error().to_string();
  const auto& at_surface = exact->objects[0].parameters.contact_surface_offset;
  ASSERT_TRUE(at_surface.has_value());
  EXPECT_LT(at_surface->norm(), 0.1e-3);  // the tip's noise is 0.05 mm
  const auto found = identify(lowered_box(0.4e-3), IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const auto& raised = found->objects[0].parameters.contact_surface_offset;
  ASSERT_TRUE(raised.has_value());
  EXPECT_NEAR(raised->z() - at_surface->z(), 0.4e-3, 0.02e-3);
  EXPECT_LT(raised->head<2>().norm(), 0.01e-3);
}

TEST(Identify, NamesAPoseThatThePressesContradict) {
  const auto found = identify(lowered_box(2.0e-3), IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_FALSE(found->objects[0].parameters.contact_surface_offset.has_value());
  EXPECT_TRUE(has_note(found->objects[0].notes, "mm from the CAD body's"));
}

TEST(Identify, RemovesAClockOffsetOfATenthOfASecond) {
  for (const double late : {0.1, -0.1}) {
    IdentificationInput input = probe().input;
    for (double& t : input.t_force) t += late;
    const auto found = identify(input, IdentificationGoal::friction);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    EXPECT_TRUE(found->inputs.is_force_offset_applied);
    EXPECT_NEAR(found->inputs.tool_to_force.offset, late, 4.0 * found->inputs.tool_to_force.std);
    EXPECT_LT(found->inputs.tool_to_force.std, 0.002);
    expect_friction(found->objects[0]);
  }
}

TEST(Identify, FindsNoOffsetBetweenSynchronousClocksForAStiffObject) {
  // 200 N/mm, loaded within 10 ms by the fastest of the presses.
  const IdentifiedCase stiff = identified_case(ToolTask::press, 9707, kWhole);
  const auto found = identify(stiff.input, IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_LT(std::abs(found->inputs.tool_to_force.offset), 4.0 * found->inputs.tool_to_force.std);
  EXPECT_LT(found->inputs.tool_to_force.std, 0.0004);  // a fifth of a sample
  EXPECT_FALSE(found->inputs.is_force_offset_applied);
}

TEST(Identify, DrawsTheForceLinesOfAPushBesideThePresses) {
  const auto found = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value());
  const TemporaryFolder folder;
  ASSERT_TRUE(write_identification_report(*found, "probe", folder.path()));
  const auto json = nlohmann::json::parse(read_file(folder.path() / "report.json").value());
  const std::string key = "object." + found->objects[0].name + ".";
  const auto& lines = json[key + "force_lines"];
  EXPECT_GT(lines["t"].size(), 100U);
  EXPECT_EQ(lines["press_line"].size(), lines["t"].size());
  EXPECT_EQ(lines["push_line"].size(), lines["t"].size());
  EXPECT_GT(lines["t_breakaway"], lines["t"].front());
  const auto highest = [&lines](const char* name) {
    const auto values = lines[name].get<std::vector<double>>();
    return *std::max_element(values.begin(), values.end());
  };
  EXPECT_GT(highest("push_line"), 0.5 * highest("measured"));
  EXPECT_GT(highest("press_line"), 0.5 * highest("measured"));
  // A note says where the presses do not describe the pushed face.
  int checked = 0, different = 0;
  for (const auto& push : json[key + "breakaways"]) {
    if (!push.contains("press_line_ratio")) continue;
    const double ratio = push["press_line_ratio"], ratio_std = push["press_line_ratio_std"];
    ++checked;
    different += std::abs(ratio - 1.0) > std::max(0.1, 3.0 * ratio_std) ? 1 : 0;
  }
  EXPECT_GE(checked, 5);
  EXPECT_EQ(has_note(found->objects[0].notes, "as steeply as the press's law predicts"),
            2 * different > checked);
  const std::string page = report_data(folder.path());
  EXPECT_NE(page.find("force lines of an object at rest"), std::string::npos);
  EXPECT_NE(page.find("Pushes beside the press's law"), std::string::npos);
}

TEST(Identify, EstimatesTheMeanForceOfStationaryPressesBetterThanEachSample) {
  const IdentifiedCase soft = identified_case(ToolTask::press, 9701, kWhole);
  const auto found = identify(soft.input, IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  for (const ObjectIdentification& box : found->objects) {
    for (const EstimatorTrace& trace : box.comparison) {
      ASSERT_TRUE(trace.mean_force_error.has_value());
      // 75 samples of 0.05 mm are 1 % of 1 mm or less, and the tip is stationary four times.
      EXPECT_LT(*trace.mean_force_error, 0.015);
      EXPECT_LT(*trace.mean_force_error, trace.steady_error);
    }
  }
}

void expect_tool_friction(const IdentifiedCase& made, IdentificationGoal goal, int contacts) {
  const auto found = identify(made.input, goal);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectIdentification& block = found->objects[0];
  const double truth = made.plant.bodies[0].parameters.tool_friction_coefficient;
  ASSERT_TRUE(block.parameters.tool_friction_coefficient);
  const ParameterValue& coefficient = *block.parameters.tool_friction_coefficient;
  EXPECT_NEAR(coefficient.value, truth, 0.04 * truth);
  EXPECT_LT(*coefficient.std, 0.1 * truth);
  EXPECT_NEAR(coefficient.value, truth, 3.0 * *coefficient.std);
  EXPECT_EQ(block.tool_friction_contacts, contacts);
  const auto& given = block.parameters.sources.given;
  EXPECT_EQ(std::count(given.begin(), given.end(), "tool_friction_coefficient"), 0);
}

TEST(Identify, FindsTheFrictionOfATipThatSlidesAlongTheWallsOfASlot) {
  expect_tool_friction(identified_case(ToolTask::slot, 11, kWhole), IdentificationGoal::contact, 2);
}

TEST(Identify, FindsTheFrictionOfATipThatSlidesAlongTwoWallsOfAnObliqueHole) {
  expect_tool_friction(identified_case(ToolTask::hole, 104, kWhole), IdentificationGoal::friction,
                       2);
}

TEST(Identify, FindsNoToolFrictionWhereTheTipDoesNotSlide) {
  const auto found = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_FALSE(found->objects[0].parameters.tool_friction_coefficient);
}

TEST(Identify, RefusesAForceOfTheWrongSign) {
  IdentificationInput input = probe().input;
  for (Eigen::Vector3d& force : input.force_base) force = -force;
  EXPECT_NE(error_of(input).find("wrong sign"), std::string::npos) << error_of(input);
}

TEST(Identify, RefusesAForceInOtherAxes) {
  IdentificationInput input = probe().input;
  for (Eigen::Vector3d& force : input.force_base) force = {force.y(), -force.x(), force.z()};
  EXPECT_NE(error_of(input).find("motion"), std::string::npos) << error_of(input);
}

TEST(Identify, RefusesAForceInAnotherUnit) {
  const auto scaled = [](double factor) {
    IdentificationInput input = probe().input;
    for (Eigen::Vector3d& force : input.force_base) force *= factor;
    return error_of(input);
  };
  EXPECT_NE(scaled(1e3).find("millinewtons"), std::string::npos) << scaled(1e3);
  EXPECT_NE(scaled(1e-3).find("wrench.csv"), std::string::npos) << scaled(1e-3);
}

IdentificationInput in_kilograms_force(const IdentifiedCase& made) {
  IdentificationInput input = made.input;
  for (Eigen::Vector3d& force : input.force_base) force /= kStandardGravity;
  return input;
}

TEST(Identify, RecognisesKilogramsForceByAccelerations) {
  const std::string error = error_of(in_kilograms_force(probe()));
  EXPECT_NE(error.find("kilograms-force"), std::string::npos) << error;
}

TEST(Identify, WarnsOfAFrictionThatKilogramsForceWouldCause) {
  // Slow pushes only: 0.03 of the weight is unusual, but possible on rollers and ice.
  const IdentifiedCase slow = identified_case(ToolTask::probe, 2, 16.0);
  const auto found = identify(in_kilograms_force(slow), IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(has_note(found->notes, "check that the force is in newtons"));
}

TEST(Identify, ReportsMissingInputs) {
  IdentificationInput input = probe().input;
  input.t_force.clear();
  input.force_base.clear();
  EXPECT_NE(error_of(input).find("wrench.csv: identification needs"), std::string::npos);
  input = probe().input;
  input.t_tool.clear();
  input.p_base_tip.clear();
  input.q_base_tool.clear();
  EXPECT_NE(error_of(input).find("tool.csv"), std::string::npos);
  input = probe().input;
  input.objects.clear();
  EXPECT_NE(error_of(input).find("objects"), std::string::npos);
  input = probe().input;
  for (double& t : input.t_force) t += 1000.0;
  EXPECT_NE(error_of(input).find("do not overlap"), std::string::npos);
  input = probe().input;
  for (Eigen::Vector3d& force : input.force_base) force = Eigen::Vector3d::Zero();
  EXPECT_NE(error_of(input), "no error");
}

TEST(Identify, ExcludesSaturatedSamples) {
  IdentificationInput input = probe().input;
  for (Eigen::Vector3d& force : input.force_base) {
    force = force.cwiseMax(-9.0).cwiseMin(9.0);  // the presses saturate, the slow pushes do not
  }
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(has_note(found->notes, "force sensor saturated"));
  EXPECT_EQ(found->objects[0].press_count, 0);
  // The contact law comes from the pushes instead.
  EXPECT_TRUE(found->objects[0].parameters.contact_stiffness.has_value());
}

TEST(Identify, ExcludesAPushInWhichTheToolsPoseJumps) {
  IdentificationInput input = probe().input;
  const auto clean = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(clean.has_value());
  const Contact& push = clean->contacts[4];
  const double middle = 0.5 * (push.begin + push.end);
  for (std::size_t i = 0; i < input.t_tool.size(); ++i) {
    if (input.t_tool[i] > middle) input.p_base_tip[i].x() += 0.004;
  }
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(has_note(found->notes, "tool's pose jumps"));
  EXPECT_EQ(found->objects[0].limit.pushes, clean->objects[0].limit.pushes - 1);
}

TEST(Identify, IsRobustToSpikesOfTenTimesTheForceAndDrift) {
  IdentificationInput input = probe().input;
  for (std::size_t i = 0; i < input.force_base.size(); ++i) {
    if (i % 701 == 350) input.force_base[i] *= 10.0;
    input.force_base[i] += Eigen::Vector3d::Constant(0.3 * std::sin(0.5 * input.t_force[i]));
  }
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  expect_friction(found->objects[0]);
}

TEST(Identify, ExcludesAPushWithAnAmbiguousObject) {
  IdentificationInput input = probe().input;
  IdentifiableObject duplicate = input.objects[0];
  duplicate.name = "duplicate";
  input.objects.push_back(duplicate);
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(has_note(found->notes, "two objects"));
  EXPECT_EQ(found->objects[0].limit.pushes, 0);
}

TEST(Identify, ReportsContactsWithoutAKnownObject) {
  IdentificationInput input = probe().input;
  input.objects.erase(input.objects.begin());
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  EXPECT_TRUE(has_note(found->notes, "no known object"));
}

TEST(Identify, UpdatesAnUntrackedObjectsPoseByItsPushes) {
  IdentificationInput input = probe().input;
  for (IdentifiableObject& object : input.objects) object.tracked.clear();
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  expect_friction(found->objects[0]);
  for (const Contact& contact : found->contacts) {
    if (!contact.left_out.empty()) continue;
    EXPECT_LT(std::abs(contact.gap), 0.003);
  }
}

TEST(Identify, ReportsThatSlowPushesDoNotExciteTheMassAndProposesAMotion) {
  // The recording ends before the modulated slide.
  const IdentifiedCase slow = identified_case(ToolTask::probe, 2, 16.0);
  const auto found = identify(slow.input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectIdentification& box = found->objects[0];
  const auto mass = std::find_if(box.findings.begin(), box.findings.end(),
                                 [](const ParameterFinding& row) { return row.name == "mass"; });
  ASSERT_NE(mass, box.findings.end());
  EXPECT_FALSE(mass->is_excited);
  EXPECT_NE(mass->remark.find("2 Hz, 3 mm"), std::string::npos);
  // The given mass is kept, without an std.
  EXPECT_EQ(box.parameters.mass->value, truth().mass);
  EXPECT_FALSE(box.parameters.mass->std.has_value());
}

const ParameterFinding* finding_of(const ObjectIdentification& object, const std::string& name) {
  const auto row = std::find_if(object.findings.begin(), object.findings.end(),
                                [&](const ParameterFinding& one) { return one.name == name; });
  return row == object.findings.end() ? nullptr : &*row;
}

bool lists(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

TEST(Identify, WithholdsADampingThatThePressesOnlyBound) {
  IdentificationInput input = probe().input;
  Random random(5);
  for (Eigen::Vector3d& p : input.p_base_tip) p.z() += 4e-4 * random.normal();
  const auto found = identify(input, IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectIdentification& box = found->objects[0];
  ASSERT_FALSE(box.presses.best().damping.is_excited);
  // A predictor needs one all the same: the bound is in the file, as what it is.
  ASSERT_TRUE(box.parameters.contact_damping.has_value());
  EXPECT_FALSE(box.parameters.sources.presses.contains("contact.damping"));
  const ParameterFinding* damping = finding_of(box, "contact.damping");
  ASSERT_NE(damping, nullptr);
  EXPECT_FALSE(damping->is_excited);
  EXPECT_TRUE(lists(box.parameters.sources.given, "contact.damping"));
  EXPECT_NE(damping->remark.find("not excited"), std::string::npos);
}

TEST(Identify, DoesNotMixTheWeighedMassWithTheOneByAccelerations) {
  // The weighed mass is 3 % off: the friction at standstill must not be.
  IdentificationInput input = probe().input;
  input.objects[0].mass = 1.03 * truth().mass;
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectParameters& p = found->objects[0].parameters;
  EXPECT_EQ(p.mass->value, 1.03 * truth().mass);
  const double coulomb = truth().sliding_friction_coefficient * truth().mass;
  EXPECT_NEAR(p.sliding_friction_coefficient->value * p.mass->value, coulomb, 0.01 * coulomb);
  EXPECT_FALSE(finding_of(found->objects[0], "mass")->is_excited);
  EXPECT_TRUE(lists(p.sources.given, "mass"));
  const ParameterFinding* inertial = finding_of(found->objects[0], "inertial_mass");
  ASSERT_NE(inertial, nullptr);
  EXPECT_TRUE(inertial->is_excited);
  EXPECT_LT(std::abs(inertial->value - truth().mass), 3.0 * *inertial->std);
  ASSERT_TRUE(p.inertial_mass.has_value());
  EXPECT_EQ(p.inertial_mass->value, inertial->value);
  EXPECT_EQ(p.inertial_mass->std, inertial->std);
  EXPECT_TRUE(found->warnings.empty());
}

TEST(Identify, KeepsAWeighedMassThatTheForceContradicts) {
  for (const double factor : {0.5, 0.8, 1.3, 2.0}) {
    IdentificationInput input = probe().input;
    for (Eigen::Vector3d& force : input.force_base) force *= factor;
    const auto found = identify(input, IdentificationGoal::friction);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    EXPECT_EQ(found->objects[0].parameters.mass->value, *input.objects[0].mass);
    ASSERT_EQ(found->warnings.size(), 1U) << factor;
    EXPECT_NE(found->warnings[0].find("the given mass or the force is wrong"), std::string::npos);
  }
}

TEST(Identify, StatesWhatTheValuesRestOn) {
  IdentificationInput input = probe().input;
  input.objects[0].mass.reset();
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectParameters& p = found->objects[0].parameters;
  EXPECT_FALSE(lists(p.sources.given, "mass"));
  EXPECT_EQ(p.sources.presses.at("contact.stiffness"), 3);
  EXPECT_GE(p.sources.pushes.at("limiting_static_friction"), 9);
  EXPECT_EQ(p.sources.pushes.at("mass"), 11);
  // The damping of these presses is only bounded.
  ASSERT_EQ(p.sources.correlated.size(), 5U);
  const auto correlation = [&](const char* a, const char* b) {
    const std::vector<std::string>& keys = p.sources.correlated;
    const auto row = std::find(keys.begin(), keys.end(), a) - keys.begin();
    const auto column = std::find(keys.begin(), keys.end(), b) - keys.begin();
    return p.sources.correlation.at(static_cast<std::size_t>(5 * row + column));
  };
  for (const std::string& key : p.sources.correlated) {
    EXPECT_EQ(correlation(key.c_str(), key.c_str()), 1.0);
  }
  // A higher viscous friction leaves less to Coulomb friction at two speeds.
  EXPECT_LT(correlation("sliding_friction_coefficient", "viscous_friction"), -0.1);
  EXPECT_EQ(correlation("sliding_friction_coefficient", "viscous_friction"),
            correlation("viscous_friction", "sliding_friction_coefficient"));
  // A higher exponent needs a stiffer contact over the few depths of the presses.
  EXPECT_GT(correlation("contact.stiffness", "contact.exponent"), 0.9);
  EXPECT_EQ(correlation("contact.stiffness", "viscous_friction"), 0.0);
  ASSERT_GE(p.sliding_force.size(), 2U);
  EXPECT_LT(p.sliding_force.front().speed, p.sliding_force.back().speed);
  for (const SlidingForce& row : p.sliding_force) {
    const double force = truth().sliding_friction_coefficient * truth().mass * kStandardGravity +
                         truth().viscous_friction * row.speed;
    EXPECT_NEAR(row.force, force, 3.0 * row.std);
  }
}

TEST(Identify, AppliesItsOptions) {
  IdentificationOptions options;
  options.friction_priors.scatter = 0.2;
  options.inputs.segmentation.min_force = 1e3;
  EXPECT_FALSE(identify(probe().input, IdentificationGoal::friction, options).has_value());
  options.inputs.segmentation = {};
  const auto usual = identify(probe().input, IdentificationGoal::friction);
  const auto uneven = identify(probe().input, IdentificationGoal::friction, options);
  ASSERT_TRUE(usual && uneven);
  EXPECT_GT(*uneven->objects[0].parameters.sliding_friction_coefficient->std,
            1.2 * *usual->objects[0].parameters.sliding_friction_coefficient->std);
}

TEST(Identify, KeepsKnownParametersAndDoesNotIdentifyTheContactAgain) {
  IdentificationInput input = probe().input;
  input.known["box_1"].contact_stiffness = ParameterValue{truth().contact_stiffness, 1.0};
  input.known["box_1"].contact_exponent = ParameterValue{truth().contact_exponent, {}};
  input.known["box_1"].contact_damping = ParameterValue{truth().contact_damping, {}};
  input.known["elsewhere"].mass = ParameterValue{2.0, {}};
  const auto found = identify(input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ParameterTable table = found->parameters();
  EXPECT_EQ(table.at("box_1").contact_stiffness->value, truth().contact_stiffness);
  EXPECT_EQ(table.at("elsewhere").mass->value, 2.0);
  EXPECT_TRUE(table.at("box_1").limiting_static_friction.has_value());
}

TEST(Identify, GivesTheSameBytesEachTime) {
  const auto one = identify(probe().input, IdentificationGoal::friction);
  const auto two = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(format_parameters(one->parameters()), format_parameters(two->parameters()));
}

TEST(IdentificationReport, HasPlotsForPeopleAndAFlatFile) {
  const TemporaryFolder folder;
  const auto found = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value());
  ASSERT_TRUE(write_identification_report(*found, "a <recording>", folder.path()).has_value());
  const std::string data = report_data(folder.path());
  EXPECT_EQ(data.find("nan"), std::string::npos);
  for (const char* text : {"Identification of contact and friction", "a \\u003crecording>",
                           "Stiffness over time", "All pushes: force and phases",
                           "Breakaway of each push", "Mass over time", "Limiting friction F_M"}) {
    EXPECT_NE(data.find(text), std::string::npos) << text;
  }
  for (const char* key : {"limiting_static_friction", "contact.stiffness", "loading_rate"}) {
    EXPECT_EQ(data.find(key), std::string::npos) << key;  // names of the parameter file
  }
  const auto json = read_file(folder.path() / "report.json");
  ASSERT_TRUE(json.has_value());
  EXPECT_NE(json->find("\"object.box_1.limiting_static_friction_std\""), std::string::npos);
}

TEST(IdentificationReport, BeginsWithAVerdictAndFiveFigures) {
  const TemporaryFolder folder;
  const auto found = identify(probe().input, IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value());
  ASSERT_TRUE(write_identification_report(*found, "probe", folder.path()).has_value());
  const auto page = nlohmann::json::parse(report_data(folder.path()));
  const std::string verdict = page["verdict"];
  EXPECT_TRUE(verdict.starts_with("box_1: ")) << verdict;
  EXPECT_NE(verdict.find(" parameters identified"), std::string::npos) << verdict;
  const auto& headline = page["headline"];
  EXPECT_EQ(headline["columns"][2], "box_1");
  ASSERT_EQ(headline["rows"].size(), 5U);
  EXPECT_EQ(headline["rows"][0][0], "Limiting friction F_M");
  EXPECT_EQ(headline["rows"][0][1], "N");
  const std::string value = headline["rows"][0][2];
  EXPECT_NE(value.find(" ± "), std::string::npos) << value;
  // Enough sections for contents.
  EXPECT_GE(page["sections"].size(), 3U);
}

TEST(IdentificationInputOf, AnObjectWithoutAPoseIsAnErrorThatNamesIt) {
  Recording recording;
  recording.folder = "/somewhere";
  for (int i = 0; i < 500; ++i) {
    const Stamp stamp = Stamp::from_seconds(0.002 * i);
    recording.tool.append(stamp, Pose());
    recording.wrench.push_back({stamp, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  }
  recording.manifest.objects.push_back({.name = "cup", .mesh = "cup.obj"});
  const auto input = identification_input(recording, {});
  ASSERT_FALSE(input.has_value());
  EXPECT_NE(input.error().to_string().find("cup"), std::string::npos);
  recording.wrench.clear();
  const auto without_force = identification_input(recording, {});
  ASSERT_FALSE(without_force.has_value());
  EXPECT_NE(without_force.error().to_string().find("/somewhere/wrench.csv"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
