// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/world.hpp"

namespace pcavr::simulation {

Manifest manifest_of(const World& world) {
  Manifest manifest;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    for (const Decal& decal : body.decals) {
      manifest.markers.push_back({.id = decal.id,
                                  .size = decal.size,
                                  .role = i == 0 ? MarkerRole::base : MarkerRole::object,
                                  .object = i == 0 ? "" : body.name,
                                  .T_parent_marker = decal.T_body_marker});
    }
  }
  for (std::size_t i = 0; i < world.boxes.size(); ++i) {
    const std::string& name = world.bodies[1 + i].name;
    manifest.objects.push_back({.name = name,
                                .mesh = "objects/" + name + ".obj",
                                .mass = world.boxes[i].mass,
                                .is_movable = world.boxes[i].is_movable});
  }
  if (world.has_tool) manifest.tool_radius = world.tool_radius;
  return manifest;
}

}  // namespace pcavr::simulation
