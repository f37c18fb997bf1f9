// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/damping_choice.hpp"

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr {
namespace {

/// The parameters of a body that impacts at 0.1 m/s.
ParameterTable table_with(double restitution) {
  ObjectParameters box;
  box.contact_stiffness = ParameterValue{2e6, 2e4};
  box.contact_damping = ParameterValue{1.0, 0.1};
  box.contact_exponent = ParameterValue{1.5};
  box.contact_restitution = ParameterValue{restitution, 0.01};
  box.contact_impact_speed = ParameterValue{0.1, 0.0};
  return {{"box", box}};
}

TEST(ApplyDampingLaw, GivesTheDampingOfEachPublishedLaw) {
  for (const DampingLaw law : kPublishedDampingLaws) {
    ParameterTable table = table_with(0.8);
    const auto notes = apply_damping_law(law, table);
    const ObjectParameters& box = table.at("box");
    EXPECT_DOUBLE_EQ(box.contact_damping->value, damping_factor(law, 0.8) * 2e6 / 0.1);
    EXPECT_EQ(box.contact_damping_law, law);
    EXPECT_NE(notes.at(0).find(name_of(law)), std::string::npos) << notes[0];
    // Near c = 1 the factor is about 3/2 (1 - c): 0.01 of 0.2, and 1 % of the stiffness.
    EXPECT_NEAR(*box.contact_damping->std / box.contact_damping->value, 0.05, 0.02);
  }
}

TEST(ApplyDampingLaw, ByTheCriterionTakesTheLawOfTheSmallestError) {
  for (const auto& [restitution, law] :
       {std::pair{0.8, DampingLaw::herbert_mcwhannell}, std::pair{0.1, DampingLaw::gonthier}}) {
    ParameterTable table = table_with(restitution);
    (void)apply_damping_law(std::nullopt, table);
    EXPECT_EQ(table.at("box").contact_damping_law, law) << restitution;
  }
}

TEST(ApplyDampingLaw, LeavesWhatHasNoRestitutionOrIsLinear) {
  ParameterTable table = table_with(0.8);
  table["linear"] = table.at("box");
  table["linear"].contact_exponent = ParameterValue{1.0};
  table["pressed"] = table.at("box");
  table["pressed"].contact_restitution.reset();
  const auto notes = apply_damping_law(DampingLaw::exact, table);
  EXPECT_EQ(notes.size(), 3U);
  for (const char* name : {"linear", "pressed"}) {
    EXPECT_EQ(table.at(name).contact_damping->value, 1.0);
    EXPECT_FALSE(table.at(name).contact_damping_law) << name;
  }
}

TEST(ApplyDampingLaw, IsStatedInTheFileWithTheRestitution) {
  ParameterTable table = table_with(0.62);
  (void)apply_damping_law(DampingLaw::flores, table);
  const std::string text = format_parameters(table);
  const auto read = parse_parameters(text, "test.yaml");
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(read->at("box").contact_damping_law, DampingLaw::flores);
  EXPECT_EQ(read->at("box").contact_restitution->value, 0.62);
  EXPECT_EQ(read->at("box").contact_impact_speed->value, 0.1);
  std::string wrong = text;
  wrong.replace(wrong.find("restitution: 0.62"), 17, "restitution: 1.62");
  EXPECT_FALSE(parse_parameters(wrong, "test.yaml"));
}

}  // namespace
}  // namespace pcavr
