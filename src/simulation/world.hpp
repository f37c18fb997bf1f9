// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

#include "simulation/shapes.hpp"
#include "simulation/texture.hpp"

namespace pcavr::simulation {

/// A printed tag on a flat face: the picture, and paper of one cell's width around it.
struct Decal {
  MarkerId id;
  double size = 0.0;  ///< edge of the square through the detection corners [m]
  Pose T_body_marker;
  TagPicture picture;
};

/// A rigid body with its appearance, in its own frame.
struct Body {
  std::string name;
  Surface surface;
  std::vector<Material> materials;
  std::vector<Decal> decals;
};

/// A body with a CAD model that may be movable; its shape is inside this bounding box.
struct Box {
  Eigen::Vector3d half_extents;  ///< [m]
  double mass = 0.0;             ///< [kg]
  Pose T_base_object;            ///< initial pose
  bool is_movable = true;
};

/// A small area light, which makes the edges of its shadows soft.
struct Light {
  Eigen::Vector3f p_base;
  Eigen::Vector3f color;  ///< radiance of a white surface lit head-on at `reach`
  float reach = 1.5F;     ///< [m]
  bool casts_shadow = false;
};

/// Everything that is visible. bodies[0] is the static environment, in base; then the boxes; then
/// the tool, if there is one: one body, or the links of an arm.
struct World {
  std::vector<Body> bodies;
  std::vector<Box> boxes;  ///< boxes[i] belongs to bodies[1 + i]
  bool has_tool = false;
  std::vector<std::size_t> arm_links;  ///< by body of the arm: index as in RobotModel::links
  double tool_radius = 0.0;            ///< of its spherical tip [m]
  std::vector<Light> lights;
  Eigen::Vector3f ambient = Eigen::Vector3f::Zero();
};

/// Pose of the tool without an arm: its z points down, a half turn about x.
[[nodiscard]] inline Pose tool_pose(const Eigen::Vector3d& p_base_tip) {
  return {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), p_base_tip};
}

/// The manifest that describes the world, without the camera.
[[nodiscard]] Manifest manifest_of(const World& world);

}  // namespace pcavr::simulation
