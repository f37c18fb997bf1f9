// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "export/exported_box.hpp"
#include "export/identified_two_joints.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

// With the version of bench/engines/package.json, and without the other engines there.
constexpr char kInstall[] =
    "npm install --no-audit --no-fund --no-package-lock @mujoco/mujoco@3.14.0 --prefix '";
constexpr char kNoEngine[] = "needs npm's @mujoco/mujoco, which could not be installed";

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

/// MuJoCo's account of a world, by a script of this folder; null: the caller skips the test.
nlohmann::json judged(const std::string& script, const std::filesystem::path& world,
                      const std::filesystem::path& tools) {
  if (!run(kInstall + tools.string() + "' > /dev/null 2>&1")) return nullptr;
  const std::string report = (tools / "report.json").string();
  const bool is_done = run("node '" + (source_folder() / "tests/export" / script).string() + "' '" +
                           tools.string() + "' '" + world.string() + "' > '" + report + "' 2>&1");
  EXPECT_TRUE(is_done) << *read_file(report);
  return nlohmann::json::parse(*read_file(report));
}

Trajectory a_motion() {
  Trajectory tool;
  for (int i = 0; i < 3; ++i) tool.append({i * 10'000'000}, Pose::from_translation({0, 0, 1}));
  return tool;
}

TEST(MujocoWorld, HasTheIdentifiedMassFrictionAndContact) {
  const TemporaryFolder tools;
  const std::string name = "a box & <\xC3\xA9t\xC3\xA9>";
  const ExportedBox box(name);
  const double exponent = 1.5;
  auto world = box.world({{name, identified_box(exponent)}});
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_TRUE(write_mjcf(*world, box.target()));
  ASSERT_TRUE(write_export_manifest(*world, {}, "mjcf", box.target()));
  const nlohmann::json report = judged("judge_mujoco.mjs", box.target(), tools.path());
  if (report.is_null()) GTEST_SKIP() << kNoEngine;

  const nlohmann::json& seen = report["bodies"][0];
  const ExportedBody& body = world->bodies.front();
  EXPECT_EQ(seen["name"], name);
  EXPECT_NEAR(seen["mass"], kBoxMass, 1e-6 * kBoxMass);
  std::vector<double> moments = seen["inertia"].get<std::vector<double>>();
  std::sort(moments.begin(), moments.end());
  const Eigen::Vector3d expected_moments =
      body.inertia.inertia_object.selfadjointView<Eigen::Lower>().eigenvalues();  // ascending
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(moments[static_cast<std::size_t>(i)], expected_moments[i],
                1e-6 * expected_moments[i]);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(seen["position"][static_cast<std::size_t>(i)], body.T_base_object.translation()[i],
                1e-6);
  }
  const double force = body.friction * kBoxMass * kStandardGravity;
  EXPECT_NEAR(-seen["turning"].get<double>(), force * body.friction_radius,
              0.07 * force * body.friction_radius);
  for (const double sliding : seen["sliding"]) EXPECT_NEAR(sliding, force, 0.02 * force);
  for (const nlohmann::json& press : seen["presses"]) {
    const double expected = elastic_force(body.contact, press["depth"]);
    EXPECT_NEAR(press["force"], expected, 0.05 * expected) << press["depth"];
  }
}

// Two boxes whose scanned places overlap by 0.2 mm, 4 N of their contact's stiffness.
TEST(MujocoWorld, LeavesBodiesThatTouchFromTheStartWhereTheyAre) {
  Scene scene = a_box_on_a_table();
  SceneObject second = scene.objects.front();
  second.model.name = "second";
  second.T_base_object =
      second.T_base_object * Pose::from_translation(Eigen::Vector3d(0.0998, 0.0, 0.0));
  scene.objects.push_back(second);
  scene.support_planes.front().objects = {"box", "second"};
  const ExportedBox boxes(scene);
  auto world = boxes.world({{"box", identified_box()}, {"second", identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_TRUE(write_mjcf(*world, boxes.target()));
  ASSERT_TRUE(write_export_manifest(*world, {}, "mjcf", boxes.target()));
  const TemporaryFolder tools;
  const nlohmann::json report = judged("judge_rest.mjs", boxes.target(), tools.path());
  if (report.is_null()) GTEST_SKIP() << kNoEngine;
  ASSERT_EQ(report.size(), 2U);
  for (const nlohmann::json& body : report) {
    EXPECT_LT(body["farthest"], 5e-4) << report.dump(1);
    EXPECT_LT(body["speed"], 1e-3) << report.dump(1);
  }
}

// A later version of the engine may call an attribute otherwise.
TEST(MujocoWorld, ShowsTheEnginesOwnErrorOfAnAttributeThatItDoesNotKnow) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_TRUE(write_mjcf(*world, box.target()));
  ASSERT_TRUE(write_export_manifest(*world, {}, "mjcf", box.target()));
  ASSERT_TRUE(write_motion(a_motion(), box.target()));
  ASSERT_TRUE(write_mujoco_runners(box.target()));
  std::string text = *read_file(box.target() / kMjcfFile);
  const std::string known = " solref=", renamed = " solreference=";
  text.replace(text.find(known), known.size(), renamed);
  ASSERT_TRUE(write_file(box.target() / kMjcfFile, text));
  if (!run(kInstall + box.target().string() + "' > /dev/null 2>&1")) GTEST_SKIP() << kNoEngine;
  const std::string said = (box.target() / "said.txt").string();
  EXPECT_FALSE(run("cd '" + box.target().string() + "' && node run.mjs > '" + said + "' 2>&1"));
  EXPECT_NE(read_file(said)->find("solreference"), std::string::npos) << *read_file(said);
}

TEST(MujocoRobot, HasTheIdentifiedFrictionAndBodies) {
  const TemporaryFolder tools, folder;
  const auto robot = two_joint_robot();
  ASSERT_TRUE(robot) << robot.error().to_string();
  ASSERT_TRUE(write_robot_mjcf(*robot, folder.path()));
  const nlohmann::json report = judged("judge_robot.mjs", folder.path(), tools.path());
  if (report.is_null()) GTEST_SKIP() << kNoEngine;

  ASSERT_EQ(report["joints"].size(), 2U);
  for (std::size_t j = 0; j < 2; ++j) {
    const nlohmann::json& seen = report["joints"][j];
    const RobotJoint& joint = robot->model.joints[j];
    EXPECT_EQ(seen["name"], "robot/" + joint.name);
    EXPECT_NEAR(seen["damping"], robot->joints[j].damping, 1e-6);
    EXPECT_NEAR(seen["friction"], robot->joints[j].friction, 1e-6);
    EXPECT_NEAR(seen["armature"], joint.armature, 1e-6);
    EXPECT_NEAR(seen["mass"], joint.body.mass, 1e-6);
    std::vector<double> moments = seen["inertia"].get<std::vector<double>>();
    std::sort(moments.begin(), moments.end());
    const Eigen::Vector3d expected =
        joint.body.inertia_at_com.selfadjointView<Eigen::Lower>().eigenvalues();
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(moments[static_cast<std::size_t>(i)], expected[i], 1e-6);
      EXPECT_NEAR(seen["centre"][static_cast<std::size_t>(i)], joint.body.centre_of_mass[i], 1e-6);
    }
  }
  EXPECT_EQ(report["motors"], 2);
  EXPECT_EQ(report["shapes"], 1);
  const auto flange = std::find_if(report["sites"].begin(), report["sites"].end(),
                                   [](const auto& site) { return site["name"] == "robot/flange"; });
  ASSERT_NE(flange, report["sites"].end());
  EXPECT_NEAR((*flange)["position"][2], 1.0 + 0.5 + 0.2, 1e-9);
}

}  // namespace
}  // namespace pcavr
