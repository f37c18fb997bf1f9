// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/parameters_file.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

ObjectParameters all_parameters() {
  return {.mass = ParameterValue{3.0, 0.02},
          .inertial_mass = ParameterValue{2.95, 0.04},
          .limiting_static_friction = ParameterValue{9.57, 0.11},
          .sliding_friction_coefficient = ParameterValue{0.283, 0.001},
          .viscous_friction = ParameterValue{10.0, 0.5},
          .contact_stiffness = ParameterValue{20600.0, 100.0},
          .contact_damping = ParameterValue{82400.0, 2000.0},
          .contact_exponent = ParameterValue{1.5, 0.01},
          .friction_radius = ParameterValue{0.067, 0.003},
          .tool_friction_coefficient = ParameterValue{0.3, 0.1},
          .loading_rate = ParameterValue{55.5, 3.0},
          .limit_surface = ellipsoid_surface(9.0, 0.6, {0.003, -0.002}),
          .sliding_force = {{0.01, 8.4, 0.05}, {0.06, 8.9, 0.04}},
          .sources = {.given = {"contact.exponent", "viscous_friction"},
                      .correlated = {"mass", "sliding_friction_coefficient"},
                      .correlation = {1.0, -0.25, -0.25, 1.0},
                      .pushes = {{"limiting_static_friction", 10}, {"mass", 11}},
                      .presses = {{"contact.stiffness", 3}},
                      .recordings = {"00000000000000ff", "0123456789abcdef"}}};
}

void expect_same(const std::optional<ParameterValue>& a, const std::optional<ParameterValue>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->value, b->value);
  EXPECT_EQ(a->std, b->std);
}

void expect_same(const ObjectParameters& a, const ObjectParameters& b) {
  expect_same(a.mass, b.mass);
  expect_same(a.inertial_mass, b.inertial_mass);
  expect_same(a.limiting_static_friction, b.limiting_static_friction);
  expect_same(a.sliding_friction_coefficient, b.sliding_friction_coefficient);
  expect_same(a.viscous_friction, b.viscous_friction);
  expect_same(a.contact_stiffness, b.contact_stiffness);
  expect_same(a.contact_damping, b.contact_damping);
  expect_same(a.contact_exponent, b.contact_exponent);
  expect_same(a.friction_radius, b.friction_radius);
  expect_same(a.tool_friction_coefficient, b.tool_friction_coefficient);
  expect_same(a.loading_rate, b.loading_rate);
  ASSERT_EQ(a.sliding_force.size(), b.sliding_force.size());
  for (std::size_t i = 0; i < a.sliding_force.size(); ++i) {
    EXPECT_EQ(a.sliding_force[i].speed, b.sliding_force[i].speed);
    EXPECT_EQ(a.sliding_force[i].force, b.sliding_force[i].force);
    EXPECT_EQ(a.sliding_force[i].std, b.sliding_force[i].std);
  }
  EXPECT_EQ(a.sources.given, b.sources.given);
  EXPECT_EQ(a.sources.correlated, b.sources.correlated);
  EXPECT_EQ(a.sources.correlation, b.sources.correlation);
  EXPECT_EQ(a.sources.pushes, b.sources.pushes);
  EXPECT_EQ(a.sources.recordings, b.sources.recordings);
  EXPECT_EQ(a.sources.presses, b.sources.presses);
  ASSERT_EQ(a.limit_surface.has_value(), b.limit_surface.has_value());
  if (!a.limit_surface) return;
  EXPECT_EQ(a.limit_surface->force, b.limit_surface->force);
  EXPECT_EQ(a.limit_surface->length, b.limit_surface->length);
  EXPECT_EQ(a.limit_surface->coefficients, b.limit_surface->coefficients);
}

TEST(ParametersFile, RoundTripIsLossless) {
  ParameterTable table;
  table["box"] = all_parameters();
  table["a thing: nothing known"] = {};
  table["12"] = {.mass = ParameterValue{0.1}};
  const auto again = parse_parameters(format_parameters(table, "by hand\n\nsecond"), "p.yaml");
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  ASSERT_EQ(again->size(), table.size());
  for (const auto& [name, parameters] : table) expect_same(again->at(name), parameters);
}

TEST(ParametersFile, OfNoObjectIsAnEmptyTable) {
  const auto table = parse_parameters(format_parameters({}), "p.yaml");
  ASSERT_TRUE(table.has_value()) << table.error().to_string();
  EXPECT_TRUE(table->empty());
}

TEST(ParametersFile, OmitsAStdThatIsNotFinite) {
  const ParameterTable table{
      {"box", {.mass = ParameterValue{1.0, std::numeric_limits<double>::infinity()}}}};
  EXPECT_EQ(format_parameters(table), "format: pcavr-parameters/2\nbox:\n  mass: 1\n");
}

TEST(ParametersFile, PutsItsCommentFirst) {
  EXPECT_EQ(format_parameters({{"box", {.mass = ParameterValue{2.0}}}}, "of a push\n\nby hand"),
            "# of a push\n#\n# by hand\nformat: pcavr-parameters/2\nbox:\n  mass: 2\n");
}

struct Refusal {
  const char* name;
  const char* text;
  int line;
  const char* place;
};

class RefusedParameters : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedParameters, NameTheirLineAndPlace) {
  const auto table = parse_parameters(GetParam().text, "p.yaml");
  ASSERT_FALSE(table.has_value());
  EXPECT_EQ(table.error().file, "p.yaml");
  EXPECT_EQ(table.error().line, GetParam().line) << table.error().to_string();
  EXPECT_EQ(table.error().place, GetParam().place) << table.error().to_string();
  EXPECT_FALSE(table.error().hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Each, RefusedParameters,
    testing::Values(
        Refusal{"NegativeMass", "box:\n  mass: -3\n", 2, "box.mass"},
        Refusal{"ZeroMass", "box:\n  mass: 0\n", 2, "box.mass"},
        Refusal{"MassOfAShip", "box:\n  mass: 3e7\n", 2, "box.mass"},
        Refusal{"NoNumber", "box:\n  mass: heavy\n", 2, "box.mass"},
        Refusal{"NotFinite", "box:\n  mass: .nan\n", 2, "box.mass"},
        Refusal{"NegativeStd", "box:\n  mass: 3\n  mass_std: -1\n", 3, "box.mass_std"},
        Refusal{"StdWithoutValue", "box:\n  mass_std: 0.1\n", 2, "box.mass_std"},
        Refusal{"UnknownKey", "box:\n  mas: 3\n", 2, "box"},
        Refusal{"DuplicateKey", "box:\n  mass: 3\n  mass: 4\n", 3, "box"},
        Refusal{"DuplicateObject", "box:\n  mass: 3\nbox:\n  mass: 4\n", 3, ""},
        Refusal{"ObjectThatIsAPath", "a/b:\n  mass: 3\n", 2, "a/b"},
        Refusal{"ExponentBelowOne", "box:\n  contact: {stiffness: 5,\n    exponent: 0.5}\n", 3,
                "box.contact.exponent"},
        Refusal{"ZeroStiffness", "box:\n  contact:\n    stiffness: 0\n", 3,
                "box.contact.stiffness"},
        Refusal{"OtherFormat", "format: pcavr-parameters/3\nbox:\n  mass: 3\n", 1, "format"},
        Refusal{"GivenThatIsNoParameter", "b:\n  mass: 3\n  given: [colour]\n", 3, "b.given[0]"},
        Refusal{"GivenTwice", "b:\n  given: [mass, mass]\n", 2, "b.given[1]"},
        Refusal{"PushesOfNoParameter", "b:\n  pushes: {weight: 3}\n", 2, "b.pushes.weight"},
        Refusal{"RecordingWithoutContent", "b:\n  recordings: [monday]\n", 2, "b.recordings[0]"},
        Refusal{"NegativePushes", "b:\n  pushes: {mass: -3}\n", 2, "b.pushes.mass"},
        Refusal{
            "NonSquareCorrelation",
            "b:\n  correlation: {parameters: [mass, viscous_friction],\n    matrix: [[1, 0]]}\n", 3,
            "b.correlation.matrix"},
        Refusal{"CorrelationAboveOne",
                "b:\n  correlation: {parameters: [mass],\n    matrix: [[1.5]]}\n", 3,
                "b.correlation.matrix[0][0]"},
        Refusal{"SlidingForceWithoutStd", "b:\n  sliding_force: [{speed: 1, force: 2}]\n", 2,
                "b.sliding_force[0]"},
        Refusal{"LawOfAnotherExponent",
                "box:\n  contact:\n    law: kelvin_voigt\n    stiffness: 5\n    exponent: 1.5\n", 3,
                "box.contact.law"},
        Refusal{"DampingUnitOfAnotherExponent",
                "box:\n  contact: {stiffness: 5, damping: 2,\n    damping_unit: N s/m, exponent: "
                "1.5}\n",
                3, "box.contact.damping_unit"},
        Refusal{"MassOfACurvedLaw",
                "box:\n  contact: {stiffness: 5, exponent: 1.5,\n    mass: 0.5}\n", 3,
                "box.contact.mass"},
        Refusal{"UnknownDampingLaw",
                "box:\n  contact: {stiffness: 5, damping: 2,\n    damping_law: hooke}\n", 3,
                "box.contact.damping_law"},
        Refusal{"FlatObject", "box: 3\n", 1, "box"}, Refusal{"List", "- box\n", 1, ""},
        Refusal{"ShortSurface",
                "b:\n  limit_surface: {force: 1, length: 1,\n    coefficients: "
                "[1, 2]}\n",
                3, "b.limit_surface.coefficients"},
        // x^4 + y^4 + z^4 - 3 x^2 y^2 is negative along x = y.
        Refusal{"IndefiniteSurface",
                "b:\n  limit_surface: {force: 1, length: 1,\n    coefficients: "
                "[1, 0, 0, -3, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1]}\n",
                3, "b.limit_surface.coefficients"},
        // x^4 + y^4 + z^4 + 12 x^2 y^2 is positive, but not convex: concave along x = y.
        Refusal{"NonConvexSurface",
                "b:\n  limit_surface: {force: 1, length: 1,\n    coefficients: "
                "[1, 0, 0, 12, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1]}\n",
                3, "b.limit_surface.coefficients"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ParametersFile, KeepsTheContactsMassAndTheDampingLaw) {
  ObjectParameters box{.contact_stiffness = ParameterValue{20000.0},
                       .contact_damping = ParameterValue{30.0},
                       .contact_exponent = ParameterValue{1.0},
                       .contact_mass = ParameterValue{0.5, 0.02}};
  const std::string linear = format_parameters({{"box", box}});
  EXPECT_NE(linear.find("law: mass_damper_spring"), std::string::npos) << linear;
  auto read = parse_parameters(linear, "p.yaml");
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(read->at("box").contact_mass->value, 0.5);
  EXPECT_EQ(read->at("box").contact_mass->std, 0.02);
  box.contact_mass.reset();
  box.contact_exponent = ParameterValue{1.5};
  box.contact_damping_law = DampingLaw::gonthier;
  const std::string curved = format_parameters({{"box", box}});
  EXPECT_NE(curved.find("damping_law: gonthier"), std::string::npos) << curved;
  read = parse_parameters(curved, "p.yaml");
  ASSERT_TRUE(read) << read.error().to_string();
  EXPECT_EQ(read->at("box").contact_damping_law, DampingLaw::gonthier);
}

TEST(ParametersFile, StatesTheLawAndItsDampingsUnit) {
  ObjectParameters box{.contact_stiffness = ParameterValue{20000.0},
                       .contact_damping = ParameterValue{30.0},
                       .contact_exponent = ParameterValue{1.0}};
  const std::string linear = format_parameters({{"box", box}});
  EXPECT_NE(linear.find("law: kelvin_voigt"), std::string::npos) << linear;
  EXPECT_NE(linear.find("damping_unit: N s/m\n"), std::string::npos) << linear;
  box.contact_exponent = ParameterValue{1.5};
  const std::string curved = format_parameters({{"box", box}});
  EXPECT_NE(curved.find("law: hunt_crossley"), std::string::npos) << curved;
  EXPECT_NE(curved.find("damping_unit: N s/m^2.5\n"), std::string::npos) << curved;
  EXPECT_TRUE(parse_parameters(curved, "p.yaml"));
}

TEST(ParametersFile, WithoutLawAndUnitIsReadAsBefore) {
  const auto table =
      parse_parameters("box:\n  contact: {stiffness: 5, damping: 2, exponent: 1.5}\n", "p.yaml");
  ASSERT_TRUE(table) << table.error().to_string();
  EXPECT_EQ(table->at("box").contact_damping->value, 2.0);
}

TEST(ParametersFile, ThatIsEmptyOrNoYamlIsRefused) {
  EXPECT_FALSE(parse_parameters("", "p.yaml").has_value());
  const auto broken = parse_parameters("box: {mass: 3\n", "p.yaml");
  ASSERT_FALSE(broken.has_value());
  EXPECT_GT(broken.error().line, 0);
}

TEST(ParametersFile, OfAnOlderVersionHasNoFormat) {
  const auto table = parse_parameters("box:\n  mass: 3\n", "p.yaml");
  ASSERT_TRUE(table.has_value()) << table.error().to_string();
  EXPECT_EQ(table->size(), 1U);
  EXPECT_TRUE(table->at("box").sources.given.empty());
}

TEST(ParametersFile, ThatIsMissingIsNamed) {
  const auto table = read_parameters("/nowhere/p.yaml");
  ASSERT_FALSE(table.has_value());
  EXPECT_NE(table.error().to_string().find("/nowhere/p.yaml"), std::string::npos);
}

TEST(ParametersFile, ReadsTheTruthOfARecording) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes");
  const auto table = read_parameters(shared_data("push_two_boxes") / "truth" / "parameters.yaml");
  ASSERT_TRUE(table.has_value()) << table.error().to_string();
  EXPECT_EQ(table->at("fp_box").limiting_static_friction->value, 9.57);
  EXPECT_EQ(table->at("r_box").contact_exponent->value, 1.5);
}

}  // namespace
}  // namespace pcavr
