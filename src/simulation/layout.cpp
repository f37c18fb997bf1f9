// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/layout.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"

#include "simulation/box_grid.hpp"
#include "simulation/clutter.hpp"
#include "simulation/plant_bodies.hpp"

namespace pcavr::simulation {
namespace {

constexpr const char* kFamily = "tag36h11";
constexpr int kFirstObjectTag = 5;
constexpr double kPushClearance = 0.20;  ///< [m], in front of each body of a plant
constexpr double kGridBaseTagX = 0.91;   ///< [m]: the base tag in front of a grid of boxes

Material material_of(Texture texture, const Eigen::Vector3f& base, const Eigen::Vector3f& accent,
                     float scale, Random& random) {
  return {.texture = texture,
          .base = base,
          .accent = accent,
          .scale = scale,
          .seed = static_cast<std::uint32_t>(random.bits())};
}

void add_furniture(Body& room, bool has_side_wall, Random& random) {
  room.materials.push_back(
      material_of(Texture::wood, {0.80F, 0.57F, 0.36F}, {0.36F, 0.21F, 0.11F}, 0.15F, random));
  room.materials.push_back(
      material_of(Texture::plaster, {0.80F, 0.81F, 0.77F}, {0.44F, 0.48F, 0.50F}, 0.40F, random));
  room.materials.push_back(
      material_of(Texture::tiles, {0.50F, 0.44F, 0.38F}, {0.16F, 0.15F, 0.15F}, 0.30F, random));
  const auto block = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         std::uint16_t material) {
    add_box(room.surface, 0.5 * (high - low), Pose::from_translation(0.5 * (low + high)), material);
  };
  constexpr double kThickness = 0.03;
  constexpr double kLeg = 0.06;
  block({kTableNear, -kTableSide, -kThickness}, {kTableFar, kTableSide, 0.0}, 0);
  for (const double x : {kTableNear, kTableFar - kLeg}) {
    for (const double y : {-kTableSide, kTableSide - kLeg}) {
      block({x, y, kFloor}, {x + kLeg, y + kLeg, -kThickness}, 0);
    }
  }
  block({kWall - 0.1, -2.8, kFloor}, {kWall, 2.8, 2.2}, 1);
  block({kWall - 0.1, -2.8, kFloor - 0.1}, {3.5, 2.8, kFloor}, 2);
  if (has_side_wall) block({kWall, -1.6, kFloor}, {3.5, -1.5, 2.2}, 1);
}

Expected<void> add_decal(Body& body, int id, double size, const Pose& T_body_marker) {
  auto picture = tag_picture(kFamily, id);
  if (!picture) return picture.error();
  body.decals.push_back({.id = {kFamily, id},
                         .size = size,
                         .T_body_marker = T_body_marker,
                         .picture = std::move(picture).value()});
  return {};
}

/// Half the diagonal of the paper that a tag is printed on [m].
double paper_radius(const Decal& decal) {
  const double cell = decal.size / (decal.picture.cells - 2 * decal.picture.border);
  return std::numbers::sqrt2 * 0.5 * cell * (decal.picture.cells + 2);
}

Pose rotated_about_z(const Eigen::Vector3d& p, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), p};
}

/// An upright marker on a face with normal +x.
Pose facing_x(const Eigen::Vector3d& p) { return {Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), p}; }

Expected<void> add_base_tags(World& world, const SimulationCase& simulation, Random& random,
                             Occupancy& occupancy) {
  Body& room = world.bodies.front();
  if (simulation.base_tags >= 1) {
    // The tag is in front of the boxes for a fixed camera, or where they fill the table; else next
    // to them.
    Eigen::Vector3d position =
        simulation.task != ToolTask::none
            ? Eigen::Vector3d(random.uniform(0.93, 0.97), random.uniform(-0.05, 0.05), 0.0)
            : Eigen::Vector3d(random.uniform(0.70, 0.85), random.uniform(0.18, 0.32), 0.0);
    if (needs_grid(simulation.movable_boxes)) position = {kGridBaseTagX, 0.0, 0.0};
    const double yaw = simulation.task != ToolTask::none
                           ? 0.5 * std::numbers::pi
                           : random.uniform(0.0, 2.0 * std::numbers::pi);
    const auto added = add_decal(room, 0, 0.12, rotated_about_z(position, yaw));
    if (!added) return added;
    occupancy.occupy(position.head<2>(), paper_radius(room.decals.back()));
  }
  if (simulation.base_tags >= 2) {
    const Eigen::Vector3d position(kWall, random.uniform(-0.30, -0.10), random.uniform(0.10, 0.16));
    return add_decal(room, 1, 0.24, facing_x(position));
  }
  return {};
}

/// A cuboid with one tag on its top and one on its +x side.
Expected<Body> make_box(const std::string& name, const Eigen::Vector3d& half, int number,
                        bool has_random_yaw, Random& random) {
  Body body{.name = name, .surface = {}, .materials = {}, .decals = {}};
  constexpr Texture kTextures[] = {Texture::plaster, Texture::terrazzo, Texture::fabric};
  // All boxes of a world start from the same hue, and step from it by number.
  const Eigen::Vector3f tone =
      color_of_hue(random.fork(0).uniform() + kGoldenSection * number, 0.45, 0.75);
  body.materials.push_back(material_of(kTextures[random.below(3)], tone, 0.55F * tone,
                                       static_cast<float>(random.uniform(0.02, 0.05)), random));
  add_box(body.surface, half, Pose(), 0);
  // The paper, 10 cells wide for a tag of 8, must fit on the face.
  const double top = std::min(0.08, 0.72 * 2.0 * std::min(half.x(), half.y()));
  const double side = std::min(0.06, 0.72 * 2.0 * std::min(half.y(), half.z()));
  const double yaw = has_random_yaw ? random.uniform(0.0, 2.0 * std::numbers::pi) : 0.0;
  const int id = kFirstObjectTag + 2 * number;
  const double shrunk = top / (std::abs(std::sin(2.0 * yaw)) * 0.42 + 1.0);
  auto added = add_decal(body, id, shrunk, rotated_about_z({0.0, 0.0, half.z()}, yaw));
  if (added) added = add_decal(body, id + 1, side, facing_x({half.x(), 0.0, 0.0}));
  if (!added) return added.error();
  return body;
}

/// A block with a slot along its y, and a tag on its +x side: the top is too narrow for one.
Expected<Body> make_slotted_block(const PlantBody& plant, Random& random) {
  Body body{.name = plant.name, .surface = {}, .materials = {}, .decals = {}};
  const Eigen::Vector3f tone = color_of_hue(random.uniform(), 0.45, 0.75);
  body.materials.push_back(material_of(Texture::terrazzo, tone, 0.55F * tone, 0.03F, random));
  const Eigen::Vector3d half = half_extents_of(plant);
  const PlantCuboid& floor = plant.parts[0];
  const PlantCuboid& wall = plant.parts[2];
  add_slotted_block(body.surface, half, wall.centre.x() - wall.half_extents.x(),
                    floor.centre.z() + floor.half_extents.z(), 0);
  const double size = std::min(0.06, 0.72 * 2.0 * std::min(half.y(), half.z()));
  const auto added = add_decal(body, kFirstObjectTag, size, facing_x({half.x(), 0.0, 0.0}));
  if (!added) return added.error();
  return body;
}

/// A block with an oblique hole, and a tag on its +x side.
Expected<Body> make_block_with_hole(const PlantBody& plant, Random& random) {
  Body body{.name = plant.name, .surface = {}, .materials = {}, .decals = {}};
  const Eigen::Vector3f tone = color_of_hue(random.uniform(), 0.45, 0.75);
  body.materials.push_back(material_of(Texture::terrazzo, tone, 0.55F * tone, 0.03F, random));
  const Eigen::Vector3d half = half_extents_of(plant);
  add_block_with_hole(body.surface, half, hole_of(plant), 0);
  const double size = std::min(0.06, 0.72 * 2.0 * std::min(half.y(), half.z()));
  const auto added = add_decal(body, kFirstObjectTag, size, facing_x({half.x(), 0.0, 0.0}));
  if (!added) return added.error();
  return body;
}

Expected<Body> make_plant_body(const PlantBody& plant, int number, Random& random) {
  if (!plant.prisms.empty()) return make_block_with_hole(plant, random);
  if (plant.parts.size() > 1) return make_slotted_block(plant, random);
  return make_box(plant.name, half_extents_of(plant), number, false, random);
}

/// One of many boxes that stand in a grid, for a case without a tool.
Expected<void> add_grid_box(World& world, const SimulationCase& simulation, int number,
                            Random& random) {
  if (number >= PushOptions::kMaxBoxes) {
    return Error{.message = "there is no room on the table for box " + std::to_string(number + 1),
                 .hint = "use at most " + std::to_string(PushOptions::kMaxBoxes) + " boxes"};
  }
  Box box;
  box.half_extents = grid_half_extents(random);
  box.mass = random.uniform(0.5, 1.5);
  box.T_base_object = grid_pose(number, simulation.movable_boxes, box.half_extents.z(), random);
  auto body =
      make_box("box_" + std::to_string(number + 1), box.half_extents, number, false, random);
  if (!body) return body.error();
  world.bodies.push_back(std::move(body).value());
  world.boxes.push_back(box);
  return {};
}

/// A box somewhere on the table, for a case without a tool.
Expected<void> add_resting_box(World& world, const SimulationCase& simulation, int number,
                               Random& random, Occupancy& occupancy) {
  if (needs_grid(simulation.movable_boxes)) return add_grid_box(world, simulation, number, random);
  Box box;
  box.half_extents = {random.uniform(0.065, 0.085), random.uniform(0.065, 0.085),
                      random.uniform(0.045, 0.065)};
  box.mass = random.uniform(1.5, 3.5);
  const double radius = box.half_extents.head<2>().norm();
  const auto position = occupancy.find_free_position(radius, {0.50, -0.30}, {0.85, 0.12}, random);
  if (!position) {
    return Error{.message = "there is no room on the table for box " + std::to_string(number + 1),
                 .hint = "use fewer boxes or another seed"};
  }
  // Its tagged side roughly faces the camera.
  box.T_base_object = rotated_about_z({position->x(), position->y(), box.half_extents.z()},
                                      random.uniform(-0.6, 0.6));
  const std::string name =
      simulation.movable_boxes == 1 ? "box" : "box_" + std::to_string(number + 1);
  auto body = make_box(name, box.half_extents, number, true, random);
  if (!body) return body.error();
  world.bodies.push_back(std::move(body).value());
  world.boxes.push_back(box);
  return {};
}

/// A body of the plant at its initial pose, with free space to be pushed.
Expected<void> add_plant_body(World& world, const PlantBody& plant, int number, Random& random,
                              Occupancy& occupancy) {
  const Box box{.half_extents = half_extents_of(plant),
                .mass = plant.parameters.mass,
                .T_base_object = plant.T_base_object,
                .is_movable = plant.is_movable};
  const double radius = box.half_extents.head<2>().norm();
  const Eigen::Vector2d start = box.T_base_object.translation().head<2>();
  const Eigen::Vector2d push_direction =
      (box.T_base_object.rotation() * Eigen::Vector3d::UnitY()).head<2>();
  for (double along = -0.06; along <= kPushClearance; along += 0.02) {
    occupancy.occupy(start + along * push_direction, radius);
  }
  auto body = make_plant_body(plant, number, random);
  if (!body) return body.error();
  world.bodies.push_back(std::move(body).value());
  world.boxes.push_back(box);
  return {};
}

/// A sphere on a thin shaft under a handle; the tool's z points down, out of the tip.
Body make_tool(double radius, Random& random) {
  Body tool{.name = "tool", .surface = {}, .materials = {}, .decals = {}};
  tool.materials.push_back(
      material_of(Texture::plaster, {0.55F, 0.57F, 0.60F}, {0.38F, 0.40F, 0.43F}, 0.05F, random));
  tool.materials.back().gloss = 0.35F;
  tool.materials.push_back(
      material_of(Texture::fabric, {0.16F, 0.17F, 0.20F}, {0.30F, 0.31F, 0.34F}, 0.03F, random));
  const auto at = [](double z) {
    // Shapes stand upright, so they are flipped: their z is the tool's -z.
    return Pose(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {0.0, 0.0, -z});
  };
  constexpr int kRimSegments = 40;
  add_revolution(tool.surface, sphere_profile(radius), kRimSegments, at(-radius), 0);
  add_revolution(tool.surface, cylinder_profile(0.55 * radius, 0.10), kRimSegments, at(0.0), 0);
  add_revolution(tool.surface, cylinder_profile(0.014, 0.06), kRimSegments, at(0.10), 0);
  add_revolution(tool.surface, cylinder_profile(0.032, 0.17), kRimSegments, at(0.16), 1);
  return tool;
}

/// The links of an arm, each a body.
Expected<void> add_arm_links(World& world, const PlantArm& arm, Random& random) {
  const Expected<LinkMeshes> meshes = link_meshes(arm.described);
  if (!meshes) return meshes.error();
  for (std::size_t link = 0; link < meshes->of_link.size(); ++link) {
    if (meshes->of_link[link].triangles.empty()) continue;
    Body body{.name = "link_" + arm.described.links[link].name,
              .surface = {},
              .materials = {},
              .decals = {}};
    const bool is_painted = link < arm.tip && link > 0;
    const Eigen::Vector3f tone =
        is_painted ? Eigen::Vector3f(0.85F, 0.40F, 0.10F) : Eigen::Vector3f(0.40F, 0.42F, 0.45F);
    body.materials.push_back(material_of(Texture::plaster, tone, 0.8F * tone, 0.05F, random));
    body.materials.back().gloss = 0.2F;
    add_mesh(body.surface, meshes->of_link[link], 0);
    world.bodies.push_back(std::move(body));
    world.arm_links.push_back(link);
  }
  return {};
}

void add_lights(World& world, Random& random) {
  const auto jitter = [&] { return static_cast<float>(random.uniform(-0.15, 0.15)); };
  world.lights.push_back({.p_base = {1.3F + jitter(), -0.8F + jitter(), 1.7F + jitter()},
                          .color = {0.74F, 0.70F, 0.64F},
                          .reach = 1.9F,
                          .casts_shadow = true});
  world.lights.push_back({.p_base = {1.6F + jitter(), 1.5F + jitter(), 1.5F + jitter()},
                          .color = {0.26F, 0.29F, 0.34F},
                          .reach = 2.1F});
  world.ambient = {0.24F, 0.245F, 0.25F};
}

}  // namespace

Expected<World> make_world(const SimulationCase& simulation, const PlantCase& plant,
                           std::uint64_t seed, const Observer& observer) {
  const Random root(seed);
  Random furniture = root.fork(1);
  Random boxes = root.fork(2);
  Random clutter = root.fork(3);
  World world;
  world.bodies.push_back({.name = "room", .surface = {}, .materials = {}, .decals = {}});
  add_lights(world, furniture);
  add_furniture(world.bodies.front(), simulation.base_tags >= 2, furniture);
  Occupancy occupancy;
  Expected<void> added = add_base_tags(world, simulation, furniture, occupancy);
  const bool has_task = simulation.task != ToolTask::none;
  for (int i = 0; i < simulation.movable_boxes && !has_task && added; ++i) {
    added = add_resting_box(world, simulation, i, boxes, occupancy);
  }
  for (std::size_t i = 0; i < plant.bodies.size() && added; ++i) {
    added = add_plant_body(world, plant.bodies[i], static_cast<int>(i), boxes, occupancy);
  }
  if (!added) return added.error();
  if (plant.tool.arm) {
    constexpr double kArmFoot = 0.12;  // [m]: its base's radius, and room
    occupancy.occupy(plant.tool.arm->T_base_robot.translation().head<2>(), kArmFoot);
  }
  // Clutter must not occlude a fixed camera: keep it out of the strip in front of the boxes; a grid
  // of boxes needs that part of the table, too.
  if (simulation.is_camera_fixed || needs_grid(simulation.movable_boxes)) {
    occupancy.keep_out({0.55, -0.6}, {kTableFar, 0.6});
  }
  if (needs_grid(simulation.movable_boxes)) occupancy.keep_out({kTableNear, -0.55}, {0.55, 0.55});
  const int placed = add_clutter(world.bodies.front(), simulation.clutter, clutter, occupancy);
  if (placed < simulation.clutter) {
    observer.on_warning("the table has room for " + std::to_string(placed) + " of " +
                        std::to_string(simulation.clutter) + " pieces of clutter");
  }
  if (has_task) {
    world.has_tool = true;
    world.tool_radius = plant.tool.radius;
    if (plant.tool.arm) {
      added = add_arm_links(world, *plant.tool.arm, furniture);
      if (!added) return added.error();
    } else {
      world.bodies.push_back(make_tool(world.tool_radius, furniture));
    }
  }
  return world;
}

}  // namespace pcavr::simulation
