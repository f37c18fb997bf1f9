// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/pipeline/identify.hpp"

#include "pipeline/identified_case.hpp"

namespace pcavr {
namespace {

/// The measured impact of an object that is nearest to a time.
const MeasuredImpact* impact_near(const ObjectIdentification& object, double t) {
  const MeasuredImpact* nearest = nullptr;
  for (const MeasuredImpact& impact : object.impacts) {
    if (std::abs(impact.t - t) < 0.03) nearest = &impact;
  }
  return nearest;
}

// Seeds 1 to 10 were used while the method was made; these were not.
TEST(IdentifyImpacts, FindsTheRestitutionOfImpactsOf2To80MillisecondsWithin5Hundredths) {
  double shortest = 1.0, longest = 0.0, stds = 0.0;
  int count = 0, missed_count = 0;
  std::string missed;
  for (std::uint64_t seed = 101; seed <= 110; ++seed) {
    const IdentifiedCase made = identified_case(ToolTask::impact, seed, 600.0);
    const auto found = identify(made.input, IdentificationGoal::contact);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (const PlantImpact& truth : made.impacts) {
      if (truth.approach_speed < 0.05) continue;  // a slow press that bounced
      const MeasuredImpact* impact = impact_near(found->objects[truth.body], truth.t);
      const std::string at = std::to_string(seed) + " at " + std::to_string(truth.t) + " s";
      ++count;
      if (impact == nullptr) {
        missed += at + ", c " + std::to_string(truth.restitution) + '\n';
        ++missed_count;
        continue;
      }
      EXPECT_NEAR(impact->restitution.value, truth.restitution, 0.05) << at;
      EXPECT_NEAR(impact->approach_speed.value, truth.approach_speed, 0.01) << at;
      stds +=
          std::pow((impact->restitution.value - truth.restitution) / impact->restitution.std, 2);
      shortest = std::min(shortest, truth.duration);
      longest = std::max(longest, truth.duration);
    }
  }
  EXPECT_EQ(count, 100);
  // A soft impact ends below the force's threshold, in noise: it may be missed, but not misjudged.
  EXPECT_LE(missed_count, 3) << missed;
  EXPECT_LT(shortest, 0.004);
  EXPECT_GT(longest, 0.05);
  // The stated std is the error's.
  EXPECT_LT(std::sqrt(stds / (count - missed_count)), 2.0);
}

TEST(IdentifyImpacts, GiveTheDampingThatSlowPressesDoNot) {
  int from_impacts = 0;
  for (std::uint64_t seed = 101; seed <= 110; ++seed) {
    const IdentifiedCase made = identified_case(ToolTask::impact, seed, 600.0);
    const auto found = identify(made.input, IdentificationGoal::contact);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (std::size_t i = 0; i < 2; ++i) {
      const ObjectIdentification& object = found->objects[i];
      const PlantParameters& truth = made.plant.bodies[i].parameters;
      const std::string at = std::to_string(seed) + " " + object.name;
      const IdentifiedParameter& ratio = object.impact_findings.damping_over_stiffness;
      const double expected = truth.contact_damping / truth.contact_stiffness;
      EXPECT_NEAR(ratio.value, expected, std::max(0.05 * expected, 4.0 * ratio.std)) << at;
      const bool is_left_out =
          std::any_of(object.notes.begin(), object.notes.end(), [](const std::string& note) {
            return note.find("the damping law exact of impacts is not used") != note.npos;
          });
      EXPECT_EQ(is_left_out, !object.impact_findings.gives_damping) << at;
      if (is_left_out) continue;
      ++from_impacts;
      EXPECT_EQ(object.parameters.contact_damping_law, DampingLaw::exact) << at;
      // The damping, a multiple of the stiffness, is assumed where the stiffness is.
      EXPECT_EQ(object.parameters.contact_damping->std.has_value(),
                object.parameters.contact_stiffness->std.has_value())
          << at;
    }
  }
  EXPECT_GE(from_impacts, 15);  // of 20
}

// Two slow presses on a stiff box give a linear law whose exponent nobody knows, or a damping of
// another stiffness: the impacts' law replaces both.
TEST(IdentifyImpacts, ReplaceALawOfPressesThatTheyContradict) {
  int replaced = 0;
  for (const std::uint64_t seed : {31U, 33U}) {
    const IdentifiedCase made = identified_case(ToolTask::impact, seed, 600.0);
    const auto found = identify(made.input, IdentificationGoal::contact);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (std::size_t i = 0; i < 2; ++i) {
      const ObjectIdentification& object = found->objects[i];
      if (!object.impact_findings.gives_stiffness) continue;
      ++replaced;
      const ObjectParameters& law = object.parameters;
      const PlantParameters& truth = made.plant.bodies[i].parameters;
      const std::string at = std::to_string(seed) + " " + object.name;
      EXPECT_EQ(law.contact_exponent->value, object.impact_findings.exponent) << at;
      EXPECT_TRUE(object.impact_findings.gives_damping) << at;
      EXPECT_TRUE(object.comparison.empty()) << at;
      const double ratio = law.contact_damping->value / law.contact_stiffness->value;
      const double expected = truth.contact_damping / truth.contact_stiffness;
      EXPECT_NEAR(ratio, expected, 0.25 * expected) << at;
      EXPECT_FALSE(law.sources.presses.contains("contact.damping")) << at;
    }
  }
  EXPECT_EQ(replaced, 2);
}

// A spike of the force beside one of the five pulses would make this contact seven times too soft.
TEST(IdentifyImpacts, KeepTheStiffnessOfPressesDespiteASpike) {
  const IdentifiedCase made = identified_case(ToolTask::impact, 31, 600.0);
  const auto found = identify(made.input, IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectParameters& law = found->objects[1].parameters;
  const PlantParameters& truth = made.plant.bodies[1].parameters;
  const auto force_at = [](double stiffness, double exponent) {
    return stiffness * std::pow(0.001, exponent);  // 1 mm
  };
  const double expected = force_at(truth.contact_stiffness, truth.contact_exponent);
  EXPECT_NEAR(force_at(law.contact_stiffness->value, law.contact_exponent->value), expected,
              0.1 * expected);
  EXPECT_NEAR(found->objects[1].impact_findings.stiffness.value, truth.contact_stiffness,
              0.5 * truth.contact_stiffness);
}

TEST(IdentifyImpacts, NameTheDampingLawOfTheOptionOrOfPaperBsCriterion) {
  const IdentifiedCase made = identified_case(ToolTask::impact, 101, 600.0);
  IdentificationOptions options;
  options.damping_law = DampingLaw::gonthier;
  const auto chosen = identify(made.input, IdentificationGoal::contact, options);
  ASSERT_TRUE(chosen.has_value());
  EXPECT_EQ(chosen->objects[0].impact_findings.law, DampingLaw::gonthier);
  options.damping_law.reset();
  const auto by_criterion = identify(made.input, IdentificationGoal::contact, options);
  ASSERT_TRUE(by_criterion.has_value());
  const ImpactFindings& impacts = by_criterion->objects[0].impact_findings;
  EXPECT_NE(impacts.law, DampingLaw::exact);
  EXPECT_NE(impacts.choice.find("smallest error"), std::string::npos) << impacts.choice;
}

TEST(IdentifyImpacts, AreNotFoundWhereTheForceHasSpikesOnly) {
  for (const ToolTask task : {ToolTask::push, ToolTask::press}) {
    const IdentifiedCase made = identified_case(task, 3, 20.0);
    const auto found = identify(made.input, IdentificationGoal::contact);
    ASSERT_TRUE(found.has_value()) << found.error().to_string();
    for (const Contact& contact : found->contacts) {
      EXPECT_FALSE(contact.impact) << contact.begin;
    }
  }
}

}  // namespace
}  // namespace pcavr
