// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "simulation/clutter.hpp"
#include "simulation/layout.hpp"

namespace pcavr::simulation {
namespace {

constexpr double kPi = std::numbers::pi;

Surface revolved(const std::vector<Eigen::Vector2d>& profile) {
  Surface surface;
  add_revolution(surface, profile, 96, Pose(), 0);
  return surface;
}

/// Whether a surface is closed: each edge is traversed once in each direction.
bool is_closed(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> forth;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> back;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      forth.emplace_back(t[k], t[(k + 1) % 3]);
      back.emplace_back(t[(k + 1) % 3], t[k]);
    }
  }
  std::sort(forth.begin(), forth.end());
  std::sort(back.begin(), back.end());
  return forth == back && std::adjacent_find(forth.begin(), forth.end()) == forth.end();
}

TEST(Shapes, AreClosedAndHaveTheVolumeOfTheirFormula) {
  const double r = 0.05;
  const Surface cylinder = revolved(cylinder_profile(r, 0.1));
  EXPECT_TRUE(is_closed(cylinder.mesh));
  // 96 segments take 0.07 % off a circle's area; the sphere's 20 steps take 0.6 % off its volume.
  EXPECT_NEAR(signed_volume(cylinder.mesh), kPi * r * r * 0.1, 1e-3 * kPi * r * r * 0.1);
  const Surface sphere = revolved(sphere_profile(r));
  EXPECT_TRUE(is_closed(sphere.mesh));
  EXPECT_NEAR(signed_volume(sphere.mesh), 4.0 / 3.0 * kPi * r * r * r, 0.01 * 4.2 * r * r * r);
  const Surface cup = revolved(cup_profile(r, 0.1, 0.005));
  EXPECT_TRUE(is_closed(cup.mesh));
  EXPECT_GT(signed_volume(cup.mesh), 0.0);
  EXPECT_LT(signed_volume(cup.mesh), 0.4 * signed_volume(cylinder.mesh));
  Surface box;
  add_box(box, {0.1, 0.2, 0.3}, Pose(), 0);
  EXPECT_TRUE(is_closed(box.mesh));
  EXPECT_NEAR(signed_volume(box.mesh), 0.048, 1e-7);
  Surface slotted;
  add_slotted_block(slotted, {0.05, 0.1, 0.04}, 0.012, -0.02, 0);
  EXPECT_TRUE(is_closed(slotted.mesh));
  EXPECT_NEAR(signed_volume(slotted.mesh), 0.1 * 0.2 * 0.08 - 0.024 * 0.2 * 0.06, 1e-7);
  Surface holed;
  add_block_with_hole(holed, {0.08, 0.09, 0.04},
                      {.half_extents = {0.012, 0.011},
                       .mouth = {-0.01, 0.03},
                       .bottom = {0.01, 0.03},
                       .floor = -0.02},
                      0);
  EXPECT_TRUE(is_closed(holed.mesh));
  // The hole has the volume of an upright one by Cavalieri's principle.
  EXPECT_NEAR(signed_volume(holed.mesh), 0.16 * 0.18 * 0.08 - 0.024 * 0.022 * 0.06, 1e-7);
}

TEST(Shapes, ShadingNormalsFollowTheSurface) {
  const Surface sphere = revolved(sphere_profile(0.05));
  for (std::size_t i = 0; i < sphere.mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f p = sphere.mesh.vertices[sphere.mesh.triangles[i][k]];
      const Eigen::Vector3f radial = (p - Eigen::Vector3f(0.0F, 0.0F, 0.05F)).normalized();
      // Next to the poles the normal is the last edge's own, half a step of 9 degrees off.
      EXPECT_GT(sphere.corner_normals[i][k].dot(radial), 0.99F);
    }
  }
}

TEST(Texture, StaysBetweenBlackAndWhiteAndFadesWithDistance) {
  Random random(3);
  for (const Texture texture : {Texture::wood, Texture::plaster, Texture::fabric, Texture::patches,
                                Texture::terrazzo, Texture::tiles}) {
    const Material material{
        .texture = texture, .base = {0.9F, 0.6F, 0.3F}, .accent = {0.3F, 0.2F, 0.1F}, .seed = 5};
    float near_spread = 0.0F;
    float far_spread = 0.0F;
    constexpr int kSamples = 400;
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Vector3d p(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.013);
      const TextureSample near = sample_texture(material, p.cast<float>(), 1e-4F);
      const TextureSample far = sample_texture(material, p.cast<float>(), 1.0F);
      EXPECT_GE(near.albedo.minCoeff(), 0.0F);
      EXPECT_LE(near.albedo.maxCoeff(), 1.0F);
      near_spread = std::max(near_spread, std::abs(near.albedo.x() - 0.6F));
      far_spread = std::max(far_spread, std::abs(far.albedo.x() - 0.6F));
    }
    EXPECT_GT(near_spread, 0.1F) << static_cast<int>(texture);
    EXPECT_LE(far_spread, near_spread + 1e-6F) << static_cast<int>(texture);
  }
}

TEST(Occupancy, FindsFreePositionsOnly) {
  Random random(4);
  Occupancy occupancy;
  std::vector<Eigen::Vector2d> positions;
  while (const auto position = occupancy.find_free_position(0.1, {0.0, 0.0}, {1.0, 1.0}, random)) {
    for (const Eigen::Vector2d& other : positions) EXPECT_GE((other - *position).norm(), 0.2);
    positions.push_back(*position);
  }
  // Discs of 0.22 m with their clearance: at least 10 always fit, at most 27.
  EXPECT_GE(positions.size(), 10U);
  EXPECT_LE(positions.size(), 27U);
}

TEST(Layout, NothingOverlapsAMovableBox) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulationCase simulation;
    simulation.movable_boxes = 2;
    simulation.clutter = 12;
    const World world = make_world(simulation, {}, seed, {}).value();
    for (const Box& box : world.boxes) {
      const Pose T_object_base = box.T_base_object.inverse();
      for (const Eigen::Vector3f& vertex : world.bodies[0].surface.mesh.vertices) {
        const Eigen::Vector3d p = T_object_base * vertex.cast<double>().eval();
        // 1 um: the box stands on the table.
        EXPECT_FALSE(((box.half_extents - p.cwiseAbs()).array() > 1e-6).all()) << "seed " << seed;
      }
    }
  }
}

TEST(Layout, NothingBlocksThePathOfPushedBodies) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SimulationCase simulation;
    simulation.task = ToolTask::push;
    simulation.is_camera_fixed = true;
    const PlantCase plant = make_plant_case(simulation.task, seed);
    const World world = make_world(simulation, plant, seed, {}).value();
    ASSERT_EQ(world.boxes.size(), plant.bodies.size());
    for (const Box& box : world.boxes) {
      const Pose T_object_base = box.T_base_object.inverse();
      for (const Eigen::Vector3f& vertex : world.bodies[0].surface.mesh.vertices) {
        // Anywhere from where it starts to 0.2 m ahead, which is along its y.
        Eigen::Vector3d p = T_object_base * vertex.cast<double>().eval();
        p.y() -= std::clamp(p.y(), 0.0, 0.2);
        EXPECT_FALSE(((box.half_extents - p.cwiseAbs()).array() > 1e-6).all()) << "seed " << seed;
      }
    }
  }
}

TEST(Layout, TagsFitTheFacesThatTheyAreOn) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const World world = make_world(SimulationCase{}, {}, seed, {}).value();
    for (const Decal& decal : world.bodies[1].decals) {
      const double paper = 0.5 * decal.size * (decal.picture.cells + 2.0) / decal.picture.cells;
      for (const double x : {-paper, paper}) {
        for (const double y : {-paper, paper}) {
          const Eigen::Vector3d corner = decal.T_body_marker * Eigen::Vector3d(x, y, 0.0);
          EXPECT_TRUE(
              (corner.cwiseAbs().array() <= world.boxes[0].half_extents.array() + 1e-9).all())
              << "seed " << seed << ", " << decal.id.to_string();
        }
      }
    }
  }
}

TEST(Layout, ClutterWithoutRoomIsOmittedWithAWarning) {
  SimulationCase crowded;
  crowded.clutter = 500;
  std::string warning;
  Observer observer;
  observer.warn = [&](std::string_view line) { warning = line; };
  ASSERT_TRUE(make_world(crowded, {}, 1, observer));
  EXPECT_NE(warning.find("of 500 pieces of clutter"), std::string::npos) << warning;
}

TEST(Layout, TooManyBoxesAreAnError) {
  SimulationCase crowded;
  crowded.movable_boxes = 40;
  const auto world = make_world(crowded, {}, 1, {});
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().to_string().find("no room on the table"), std::string::npos);
}

}  // namespace
}  // namespace pcavr::simulation
