// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/export_world.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "export/exported_box.hpp"
#include "support/meshes.hpp"

namespace pcavr {
namespace {

TEST(ExportedWorld, HasMassAndInertiaOfAUniformBox) {
  const ExportedBox box;
  const auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  const ExportedBody& body = world->bodies.front();
  Eigen::AlignedBox3f bounds_object;
  for (const Eigen::Vector3f& v : body.mesh_object.vertices) bounds_object.extend(v);
  const Eigen::Vector3d s = bounds_object.sizes().cast<double>();
  const double expected = kBoxMass / 12.0 * (s.x() * s.x() + s.y() * s.y());
  EXPECT_NEAR(body.inertia.inertia_object(2, 2), expected, 1e-6 * expected);
  EXPECT_DOUBLE_EQ(body.inertia.mass, kBoxMass);
  EXPECT_TRUE(body.is_convex);
}

TEST(ExportedWorld, StandsOnFeetThatTouchTheSupport) {
  const ExportedBox box;
  const auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  const ExportedSupport& support = world->supports.front();
  const double top = support.T_base_box.translation().z() + support.size.z() / 2.0;
  for (const SupportFoot& foot : world->bodies.front().feet) {
    const Eigen::Vector3d centre = world->bodies.front().T_base_object * foot.centre_object;
    EXPECT_NEAR(centre.z() - foot.radius, top, 1e-9);
  }
}

TEST(ExportedWorld, StandsOnItsFeetWhereTheContactHasItsSurfaceLowerThanItsCad) {
  const ExportedBox box;
  ObjectParameters known = identified_box();
  known.contact_surface_offset = Eigen::Vector3d(0.0, 0.0, -9e-5);
  const auto world = box.world({{"box", known}});
  ASSERT_TRUE(world) << world.error().to_string();
  const ExportedBody& body = world->bodies.front();
  const ExportedSupport& support = world->supports.front();
  const double top = support.T_base_box.translation().z() + support.size.z() / 2.0;
  for (const Eigen::Vector3f& vertex : body.mesh_object.vertices) {
    const Eigen::Vector3d p = vertex.cast<double>() + body.surface_offset_object;
    EXPECT_GT((body.T_base_object * p).z(), top + 0.9e-4);
  }
  for (const SupportFoot& foot : body.feet) {
    EXPECT_NEAR((body.T_base_object * foot.centre_object).z() - foot.radius, top, 1e-9);
  }
}

TEST(ExportedWorld, HasTheFrictionOfTheReferenceSpeed) {
  const ExportedBox box;
  const auto world = box.world({{"box", identified_box()}}, {.speed = 0.1});
  ASSERT_TRUE(world);
  const double weight = kBoxMass * kStandardGravity;
  EXPECT_NEAR(world->bodies.front().friction, 0.3 + 5.0 * 0.1 / weight, 1e-12);
  EXPECT_NEAR(world->bodies.front().static_friction, 5.0 / weight, 1e-12);
}

TEST(ExportedWorld, HasTheFrictionThatPushesAtTheReferenceSpeedHaveShown) {
  const ExportedBox box;
  ObjectParameters known = identified_box();
  known.sliding_force = {{0.002, 5.0, 0.1}, {0.004, 4.6, 0.1}};  // Coulomb: 4.413 N
  const double weight = kBoxMass * kStandardGravity;
  const auto friction_at = [&](double speed) {
    return box.world({{"box", known}}, {.speed = speed}).value().bodies.front().friction;
  };
  EXPECT_NEAR(friction_at(0.002), 5.0 / weight, 1e-12);
  EXPECT_NEAR(friction_at(0.0035), 4.7 / weight, 1e-12);
  EXPECT_NEAR(friction_at(0.001), 0.3 + 5.0 * 0.001 / weight, 1e-12);  // no push was as slow
  EXPECT_NEAR(friction_at(0.1), 0.3 + 5.0 * 0.1 / weight, 1e-12);
}

TEST(ExportedWorld, RefusesABodyWithoutIdentifiedFriction) {
  const ExportedBox box;
  ObjectParameters known;
  known.mass = ParameterValue{kBoxMass};
  const auto refused = box.world({{"box", known}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().to_string().find("--assume"), std::string::npos);
  const auto assumed = box.world({{"box", known}}, {.assumes = true});
  ASSERT_TRUE(assumed);
  const auto& numbers = assumed->numbers;
  EXPECT_TRUE(std::any_of(numbers.begin(), numbers.end(), [](const ExportedNumber& number) {
    return number.key == "sliding_friction_coefficient" && number.origin == "assumed";
  }));
}

TEST(ExportedWorld, RefusesParametersOfABodyOfAnotherMass) {
  const ExportedBox box;
  ObjectParameters known = identified_box();
  known.mass = ParameterValue{0.7 * kBoxMass, 0.01};
  const auto refused = box.world({{"box", known}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("another object"), std::string::npos);
}

TEST(ExportedWorld, StatesWhereEachNumberComesFrom) {
  const ExportedBox box;
  ObjectParameters known = identified_box();
  known.sources.given = {"contact.exponent"};
  const auto world = box.world({{"box", known}});
  ASSERT_TRUE(world);
  for (const ExportedNumber& number : world->numbers) {
    if (number.key == "contact_exponent") {
      EXPECT_EQ(number.origin, "given");
    }
    if (number.key == "mass") {
      EXPECT_EQ(number.origin, "measured");
      EXPECT_EQ(number.std, 0.01);
      EXPECT_EQ(number.unit, "kg");
    }
  }
}

TEST(ExportedWorld, GivesTheToolANameOfItsOwn) {
  const ExportedBox box("tool");
  const auto world = box.world({{"tool", identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  EXPECT_EQ(world->tool.name, "tool_");
}

TEST(ExportedWorld, TurnsByUniformPressureWhereNoTurningWasIdentified) {
  const ExportedBox box;
  ObjectParameters known = identified_box();
  known.friction_radius.reset();
  const auto world = box.world({{"box", known}});
  ASSERT_TRUE(world) << world.error().to_string();
  const ExportedBody& body = world->bodies.front();
  Eigen::AlignedBox3f bounds_object;
  for (const Eigen::Vector3f& v : body.mesh_object.vertices) bounds_object.extend(v);
  const Eigen::Vector2d half = 0.5 * bounds_object.sizes().head<2>().cast<double>();
  constexpr int kCells = 200;  // the mean distance from the centre, by a sum over the base
  double sum = 0.0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      sum += std::hypot((2.0 * i + 1.0) / kCells * half.x() - half.x(),
                        (2.0 * j + 1.0) / kCells * half.y() - half.y());
    }
  }
  const double mean = sum / (kCells * kCells);
  EXPECT_NEAR(body.friction_radius, mean, 0.01 * mean);
  double turning = 0.0;
  const Eigen::Vector2d centre = body.inertia.centre_of_mass_object.head<2>();
  for (const SupportFoot& foot : body.feet) {
    turning += foot.load * foot.friction * (foot.centre_object.head<2>() - centre).norm();
  }
  EXPECT_NEAR(turning, body.friction * mean, 0.01 * body.friction * mean);
}

TEST(ExportedWorld, RefusesABodyWhoseSurfaceIsOpen) {
  Scene scene = a_box_on_a_table();
  scene.objects.front().model.mesh_object.triangles.pop_back();
  const ExportedBox box(scene);
  const auto refused = box.world({{"box", identified_box()}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("edges are open"), std::string::npos)
      << refused.error().to_string();
}

TEST(ExportedWorld, ReducesTwoHundredThousandTrianglesToWhatEnginesCollideWith) {
  const double radius = 0.04;
  Scene scene = a_box_on_a_table();
  scene.objects.front().model.mesh_object = test::sphere_mesh(static_cast<float>(radius), 225);
  ASSERT_GT(scene.objects.front().model.mesh_object.triangles.size(), 200'000U);
  const ExportedBox ball(scene);
  const auto world = ball.world({{"box", identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  const ExportedBody& body = world->bodies.front();
  EXPECT_LE(body.mesh_object.triangles.size(), ExportOptions().max_body_triangles);
  for (const Eigen::Vector3f& v : body.mesh_object.vertices) {
    EXPECT_NEAR(v.norm(), radius, 5e-4);
  }
  const double expected = 0.4 * kBoxMass * radius * radius;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(body.inertia.inertia_object(i, i), expected, 0.01 * expected);
  }
}

/// Number of times that a text occurs in another.
int occurrences(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(ExportedWorld, GivesScanSupportAndBaseNamesThatNoBodyHas) {
  for (const std::string name : {"scan", "support_0", "base", "tool_tip"}) {
    const ExportedBox box(name);
    auto world = box.world({{name, identified_box()}});
    ASSERT_TRUE(world) << world.error().to_string();
    ASSERT_TRUE(write_mjcf(*world, box.target()));
    EXPECT_EQ(occurrences(*read_file(box.target() / kMjcfFile),
                          "<geom class=\"solid\" name=\"" + name + "\"") +
                  occurrences(*read_file(box.target() / kMjcfFile),
                              "<geom class=\"visual\" name=\"" + name + "\""),
              1);
    ASSERT_TRUE(write_urdf(*world, box.target()));
    EXPECT_EQ(occurrences(*read_file(box.target() / kUrdfFile), "<link name=\"" + name + "\""), 1);
    EXPECT_TRUE(urdf::parseURDF(*read_file(box.target() / kUrdfFile)));
    ASSERT_TRUE(write_sdf(*world, box.target()));
    EXPECT_EQ(occurrences(*read_file(box.target() / kSdfFile), "<model name=\"" + name + "\""), 1);
  }
}

TEST(ExportedWorld, RefusesANameThatTheFormatReserves) {
  const ExportedBox box("world");
  auto world = box.world({{"world", identified_box()}});
  ASSERT_TRUE(world);
  for (const auto& written : {write_mjcf(*world, box.target()), write_sdf(*world, box.target())}) {
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("'world'"), std::string::npos);
  }
  EXPECT_TRUE(write_urdf(*world, box.target()));
}

TEST(ExportedWorld, RefusesTheScopesOfSdfAlone) {
  for (const std::string name : {"left::box", "__box__"}) {
    const ExportedBox box(name);
    auto world = box.world({{name, identified_box()}});
    ASSERT_TRUE(world) << world.error().to_string();
    const auto written = write_sdf(*world, box.target());
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find(name), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(box.target()));
    EXPECT_TRUE(write_mjcf(*world, box.target()));
    EXPECT_TRUE(write_usd(*world, box.target()));
  }
}

// They are within the scan's noise: both together flicker.
TEST(ExportedWorld, DrawsSupportsWhereNoScanShowsThem) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  struct Drawn {
    Expected<void> (*write)(ExportedWorld& world, const std::filesystem::path& folder);
    const char* file;
    const char* text;  ///< of a support that is drawn, or hidden
    bool is_hidden;
  };
  const Drawn formats[] = {{&write_urdf, kUrdfFile, "<visual><geometry><box", false},
                           {&write_sdf, kSdfFile, "<visual name=\"body\"><geometry><box", false},
                           {&write_mjcf, kMjcfFile, "rgba=\"0.6 0.6 0.6 1\" group=\"3\"", true},
                           {&write_usd, kUsdFile,
                            "Cube \"box\" (prepend apiSchemas = "
                            "[\"PhysicsCollisionAPI\", "
                            "\"MaterialBindingAPI\"]) {\n      uniform token "
                            "purpose = \"guide\"",
                            true}};
  for (const auto& [write, file, text, is_hidden] : formats) {
    for (const bool has_scan : {true, false}) {
      ExportedWorld drawn = *world;
      if (!has_scan) drawn.scan_base = {};
      ASSERT_TRUE(write(drawn, box.target()));
      EXPECT_EQ(occurrences(*read_file(box.target() / file), text), has_scan == is_hidden ? 1 : 0)
          << file << has_scan;
    }
  }
}

TEST(ExportedWorld, HasTheColoursOfTheScan) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  const TriangleMesh& scan = world->scan_base;
  ASSERT_EQ(scan.colors.size(), scan.vertices.size());
  ASSERT_TRUE(write_usd(*world, box.target()));
  EXPECT_EQ(occurrences(*read_file(box.target() / kUsdFile), "primvars:displayColor"), 1);
  ASSERT_TRUE(write_urdf(*world, box.target()));
  const auto read = read_mesh(box.target() / "meshes/scan.obj");
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->colors.size(), scan.colors.size());
  for (std::size_t i = 0; i < scan.colors.size(); ++i) {
    EXPECT_EQ(read->colors[i].r, scan.colors[i].r);
    EXPECT_EQ(read->colors[i].b, scan.colors[i].b);
  }
}

TEST(ExportedUsd, StatesAStaticFrictionThatPhysxDoesNotTake) {
  const ExportedBox box;
  // Sliding at 0.2 m/s has 0.3 * 14.7 N + 1 N of viscous friction, more than the 5 N at rest.
  for (const auto& [speed, is_stated] : {std::pair(0.2, true), std::pair(0.01, false)}) {
    auto world = box.world({{"box", identified_box()}}, {.speed = speed});
    ASSERT_TRUE(world);
    ASSERT_TRUE(write_usd(*world, box.target()));
    EXPECT_EQ(std::any_of(world->residuals.begin(), world->residuals.end(),
                          [](const ExportResidual& residual) {
                            return residual.what == "limiting static friction" &&
                                   residual.written > residual.wanted;
                          }),
              is_stated);
  }
}

TEST(ExportedWorld, StatesWhatUrdfAndSdfCannotHave) {
  const ExportedBox box;
  for (const auto write : {&write_urdf, &write_sdf}) {
    auto world = box.world({{"box", identified_box(1.5)}});
    ASSERT_TRUE(world);
    ASSERT_TRUE(write(*world, box.target()));
    const auto residual = [&](const std::string& what) {
      return std::find_if(world->residuals.begin(), world->residuals.end(),
                          [&](const ExportResidual& each) { return each.what.starts_with(what); });
    };
    ASSERT_NE(residual("limiting static friction"), world->residuals.end());
    EXPECT_NEAR(residual("limiting static friction")->wanted, 5.0, 1e-9);
    ASSERT_NE(residual("penetration at"), world->residuals.end());
    // The slope of x^n is n times the secant's.
    EXPECT_NEAR(residual("penetration at")->relative(), 1.0 / 1.5 - 1.0, 1e-9);
  }
}

/// The numbers between `<tag>` and `</tag>`, in their order.
std::vector<double> numbers_in(const std::string& text, const std::string& tag) {
  const std::string open = "<" + tag + ">";
  std::vector<double> numbers;
  for (auto at = text.find(open); at != std::string::npos; at = text.find(open, at + 1)) {
    numbers.push_back(std::stod(text.substr(at + open.size(), 32)));
  }
  return numbers;
}

TEST(ExportedSdf, HasTheSameCoefficientByTheRulesOfOdeAndDrake) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_sdf(*world, box.target()));
  const std::string text = *read_file(box.target() / kSdfFile);
  const std::vector<double> ode = numbers_in(text, "mu");
  const std::vector<double> drake = numbers_in(text, "drake:mu_dynamic");
  ASSERT_EQ(ode.size(), world->bodies.front().feet.size() + 3);  // support, body, feet, tip
  ASSERT_EQ(ode.size(), drake.size());
  for (std::size_t i = 1; i + 1 < ode.size(); ++i) {
    const double smaller = std::min(ode[i], ode.front());
    const double combined = 2.0 * drake[i] * drake.front() / (drake[i] + drake.front());
    EXPECT_NEAR(combined, smaller, 1e-12);
  }
  EXPECT_EQ(ode.front(), ode.back());
  EXPECT_EQ(drake.front(), drake.back());
}

TEST(ExportedUrdf, HasTheCoefficientsAsProductsOfTwoLinks) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_urdf(*world, box.target()));
  const std::string text = *read_file(box.target() / kUrdfFile);
  std::vector<double> coefficients;  // of the support, the body and the tip
  const std::string key = "<lateral_friction value=\"";
  for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    coefficients.push_back(std::stod(text.substr(at + key.size(), 32)));
  }
  ASSERT_EQ(coefficients.size(), 3U);
  EXPECT_NEAR(coefficients[0] * coefficients[1], world->bodies.front().friction, 1e-12);
  EXPECT_NEAR(coefficients[2] * coefficients[1], world->bodies.front().tool_friction, 1e-12);
}

TEST(ExportedUsd, SeparatesMetadataAndCombinesTheSmallerCoefficient) {
  const ExportedBox box("a box");
  auto world = box.world({{"a box", identified_box()}});
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_usd(*world, box.target()));
  const std::string text = *read_file(box.target() / kUsdFile);
  EXPECT_EQ(occurrences(text, "displayName = \"a box\"; prepend apiSchemas = ["), 1);
  EXPECT_EQ(occurrences(text, "def Material "), occurrences(text, "frictionCombineMode = \"min\""));
  EXPECT_EQ(occurrences(text, "{"), occurrences(text, "}"));
}

TEST(ExportedUrdf, IsReadBackWithItsMassesAndFrames) {
  const ExportedBox box("a box & <\xC3\xA9t\xC3\xA9>");
  const std::string name = box.manifest().objects.front().name;
  auto world = box.world({{name, identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_TRUE(write_urdf(*world, box.target()));
  const auto model = urdf::parseURDF(*read_file(box.target() / kUrdfFile));
  ASSERT_TRUE(model);
  const auto link = model->getLink(name);
  ASSERT_TRUE(link);
  EXPECT_NEAR(link->inertial->mass, kBoxMass, 1e-6 * kBoxMass);
  const urdf::Vector3& position = link->parent_joint->parent_to_joint_origin_transform.position;
  const Eigen::Vector3d& expected = world->bodies.front().T_base_object.translation();
  EXPECT_NEAR((Eigen::Vector3d(position.x, position.y, position.z) - expected).norm(), 0.0, 1e-6);
}

}  // namespace
}  // namespace pcavr
