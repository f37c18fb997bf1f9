// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_world.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "scene/scene_builder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class SceneWorldTest : public testing::Test {
 protected:
  Expected<SceneWorld> world_of(const Scene& scene, const SceneWorldOptions& options = {}) {
    EXPECT_TRUE(write_scene(scene, folder_.path(), {1}));
    const auto manifest = read_scene_manifest(folder_.path());
    if (!manifest) return manifest.error();
    return make_scene_world(*manifest, options);
  }
  const TemporaryFolder folder_;
};

TEST_F(SceneWorldTest, TheBoxIsMovableAtItsPoseAndTheToolStartsBesideIt) {
  SceneWorldOptions options;
  options.tool_radius = 0.02;
  options.force.max_force = 7.0;
  const auto world = world_of(a_box_on_a_table(), options);
  ASSERT_TRUE(world) << world.error().to_string();
  const WorldModel& model = world->model.world;
  ASSERT_EQ(model.bodies.size(), 1U);
  EXPECT_EQ(model.bodies[0].model.name, "box");
  EXPECT_LT((model.bodies[0].T_base_object.translation() - Eigen::Vector3d(0.6, 0.05, 0.04)).norm(),
            1e-8);  // scene.yaml rounds coordinates to a nanometre
  EXPECT_EQ(model.tool_radius, 0.02);
  EXPECT_EQ(world->model.force.max_force, 7.0);
  EXPECT_EQ(world->model.supports_base.size(), 1U);
  EXPECT_EQ(world->triangles, 5000U);
  EXPECT_EQ(model.static_mesh_base.triangles.size(), 5000U);
  EXPECT_NEAR(world->p_base_tool_start.z(), 0.04, 1e-6);  // the box's mid-height
  const Eigen::Vector2d to_tool = world->p_base_tool_start.head<2>() - Eigen::Vector2d(0.6, 0.05);
  EXPECT_LT(to_tool.dot(Eigen::Vector2d(0.6, 0.05)), 0.0);  // on the base's side
  EXPECT_GT(to_tool.norm(), 0.02 + options.start_clearance);
  EXPECT_TRUE(world->notes.empty());
}

TEST_F(SceneWorldTest, WithoutBodiesTheToolStartsBetweenTheFirstCameraAndTheScan) {
  Scene scene = a_box_on_a_table();
  scene.objects.clear();
  scene.tags.clear();
  scene.support_planes[0].objects.clear();
  const auto world = world_of(scene);
  ASSERT_TRUE(world) << world.error().to_string();
  // The camera looks straight down from a metre above the table.
  EXPECT_LT((world->p_base_tool_start - Eigen::Vector3d(0.5, 0.0, 0.5)).norm(), 1e-6);
}

TEST_F(SceneWorldTest, ACoarserLevelOfDetailIsInTheSameFrame) {
  SceneWorldOptions options;
  options.max_triangles = 100;
  const auto world = world_of(a_box_on_a_table(), options);
  ASSERT_TRUE(world) << world.error().to_string();
  EXPECT_EQ(world->triangles, 50U);
  const Eigen::AlignedBox3f box = bounds(world->model.world.static_mesh_base.vertices);
  EXPECT_LT((box.min() - Eigen::Vector3f(0.0F, -0.5F, 0.0F)).norm(), 1e-3F);
  EXPECT_LT((box.max() - Eigen::Vector3f(1.0F, 0.5F, 0.0F)).norm(), 1e-3F);
}

/// The scene with guards written at its end, as by a user.
Expected<SceneWorld> guarded_world(const std::filesystem::path& folder, const std::string& guards) {
  EXPECT_TRUE(write_scene(a_box_on_a_table(), folder, {1}));
  const auto text = read_file(folder / "scene.yaml");
  EXPECT_TRUE(write_file(folder / "scene.yaml", *text + "guards:\n" + guards));
  const auto manifest = read_scene_manifest(folder);
  if (!manifest) return manifest.error();
  return make_scene_world(*manifest, {});
}

TEST_F(SceneWorldTest, TheToolNeverPassesAGuardAtAnySpeed) {
  const auto world = guarded_world(
      folder_.path(),
      "- {name: shelf, plane: {point: [0.6, 0.05, 0.15], normal: [0, 0, 1], size: 0.8}}\n"
      "- {name: press, box: {size: [0.1, 0.1, 0.3], pose: {t: [0.9, 0.05, 0.3], q: [0, 0, 0, "
      "1]}}}\n");
  ASSERT_TRUE(world) << world.error().to_string();
  auto haptic = HapticWorld::create(world->model);
  ASSERT_TRUE(haptic);
  haptic->reset(world->p_base_tool_start);
  const double radius = world->model.world.tool_radius;
  Eigen::Vector3d tip = world->p_base_tool_start;
  for (const double speed : {0.05, 0.5, 20.0}) {
    for (int i = 0; i < 1000; ++i) {
      tip.z() = std::max(tip.z() - speed * 1e-3, 0.04);
      haptic->step({tip, true}, 1e-3);
      ASSERT_GT(haptic->state().p_base_proxy.z(), 0.15 + radius - 1e-6) << speed;
    }
    EXPECT_GT(haptic->state().force_base.z(), 1.0) << speed;
    EXPECT_NEAR(haptic->state().bodies[0].T_base_object.translation().z(), 0.04, 1e-6);
    tip = world->p_base_tool_start;
    for (int i = 0; i < 500; ++i) haptic->step({tip, true}, 1e-3);
  }
}

TEST_F(SceneWorldTest, AGuardAroundTheToolsStartIsOneLine) {
  const auto world = guarded_world(
      folder_.path(),
      "- {name: cage, box: {size: [2, 2, 2], pose: {t: [0.6, 0, 0], q: [0, 0, 0, 1]}}}\n");
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().to_string().find("guard cage encloses the tool's start"),
            std::string::npos);
}

TEST_F(SceneWorldTest, AGuardHasOneShapeInItsRange) {
  for (const char* guard :
       {"- {name: a}\n", "- {name: a, scan: {margin: 0}}\n",
        "- {name: a, scan: {margin: 0.1}, plane: "
        "{point: [0, 0, 0], normal: [0, 0, 1]}}\n",
        "- {name: a, plane: {point: [0, 0, 0], normal: [0, 0, 2]}}\n",
        "- {name: a, box: {size: [0.1, 0.1, -1], pose: {t: [0, 0, 0], q: [0, 0, 0, 1]}}}\n"}) {
    EXPECT_FALSE(guarded_world(folder_.path(), guard)) << guard;
  }
}

TEST_F(SceneWorldTest, AddsImmovableObjectsInPlaceOfTheirScanAndIgnoresUnseenOnesWithANote) {
  Scene scene = a_box_on_a_table();
  scene.objects.push_back(an_object("rail", {0.2, 0.2, 0.04}));
  scene.objects.back().is_movable = false;
  const std::size_t scanned = scene.mesh_base.triangles.size();
  const TriangleMesh rail_base =
      transformed(scene.objects.back().T_base_object, scene.objects.back().model.mesh_object);
  const auto first = static_cast<std::uint32_t>(scene.mesh_base.vertices.size());
  for (const Eigen::Vector3f& vertex : rail_base.vertices) {
    scene.mesh_base.vertices.push_back(vertex + Eigen::Vector3f(0.003F, 0.0F, 0.002F));
    scene.mesh_base.normals.push_back(Eigen::Vector3f::UnitZ());
    scene.mesh_base.colors.push_back({90, 90, 90});
  }
  for (const auto& [a, b, c] : rail_base.triangles) {
    scene.mesh_base.triangles.push_back({first + a, first + b, first + c});
  }
  scene.objects.push_back(an_object("lost", {0.0, 0.0, 0.0}));
  scene.objects.back().evidence = kNotSeen;
  SceneWorldOptions options;
  options.parameters = ParameterTable{{"rail", {}}};
  options.parameters->at("rail").contact_stiffness = ParameterValue{12345.0};
  const auto world = world_of(scene, options);
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_EQ(world->model.world.bodies.size(), 2U);
  const WorldBody& rail = world->model.world.bodies[1];
  EXPECT_FALSE(rail.is_movable);
  EXPECT_EQ(rail.physics.contact.stiffness, 12345.0);
  // The rail's scan, 3.6 mm off, is gone, and with it the table within 10 mm of the rail.
  EXPECT_LE(world->triangles, scanned);
  EXPECT_GT(world->triangles, scanned - 500U);
  for (const std::string& name : world->assumed[1].names) EXPECT_NE(name, "mass");
  ASSERT_EQ(world->notes.size(), 1U);
  EXPECT_NE(world->notes[0].find("lost"), std::string::npos);
  EXPECT_LT((rail.T_base_object.translation() - Eigen::Vector3d(0.2, 0.2, 0.04)).norm(), 1e-8);
}

TEST_F(SceneWorldTest, UsesGivenParametersAndListsDefaultedOnes) {
  ObjectParameters known;
  known.mass = ParameterValue{2.5, 0.1};
  known.contact_stiffness = ParameterValue{20000.0};
  SceneWorldOptions options;
  options.parameters = ParameterTable{{"box", known}};
  const auto world = world_of(a_box_on_a_table(), options);
  ASSERT_TRUE(world) << world.error().to_string();
  ASSERT_EQ(world->assumed.size(), 1U);
  EXPECT_EQ(world->assumed[0].object, "box");
  EXPECT_FALSE(world->assumed[0].names.empty());
  for (const std::string& name : world->assumed[0].names) {
    EXPECT_NE(name, "mass");
    EXPECT_NE(name, "contact_stiffness");
  }
  EXPECT_EQ(world->model.world.bodies[0].physics.contact.stiffness, 20000.0);
}

TEST_F(SceneWorldTest, ParametersOfAnUnknownObjectAreAnErrorWithTheirFile) {
  SceneWorldOptions options;
  options.parameters = ParameterTable{{"bx", {}}};
  options.parameters_file = "given.yaml";
  const auto world = world_of(a_box_on_a_table(), options);
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().to_string().find("given.yaml"), std::string::npos);
  EXPECT_NE(world.error().to_string().find("bx"), std::string::npos);
}

TEST_F(SceneWorldTest, NamesAMissingFile) {
  for (const char* file : {"mesh.ply", "objects/box.glb"}) {
    EXPECT_TRUE(write_scene(a_box_on_a_table(), folder_.path(), {1}));
    const auto manifest = read_scene_manifest(folder_.path());
    ASSERT_TRUE(manifest);
    std::filesystem::remove(folder_.path() / file);
    const auto world = make_scene_world(*manifest, {});
    ASSERT_FALSE(world) << file;
    EXPECT_NE(world.error().to_string().find(file), std::string::npos) << world.error().to_string();
  }
}

}  // namespace
}  // namespace pcavr
