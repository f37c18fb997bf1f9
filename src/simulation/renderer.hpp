// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"

#include "simulation/ray_scene.hpp"
#include "simulation/world.hpp"

namespace pcavr::simulation {

/// The image of an ideal camera: no blur, no noise.
struct IdealFrame {
  Image<Eigen::Vector3f> radiance;       ///< linear RGB; white paper lit head-on is about 1
  DepthImage depth;                      ///< at pixel centres [m]; 0 where no surface is
  Image<Eigen::Vector3f> normal_camera;  ///< of the triangle seen at the centre, toward the camera
};

/// Renders images of a world by ray casting. Keeps references to its arguments, which must outlive
/// it. Thread-safe.
class Renderer {
 public:
  Renderer(const World& world, const RayBodies& bodies, const CameraModel& camera);

  /// One sample at each pixel's centre; adaptive supersampling (antialiasing): the mean of 16
  /// samples over the pixel where neighbours differ in surface, print, colour cell or shadow.
  [[nodiscard]] IdealFrame render(const Pose& T_base_camera,
                                  std::span<const Pose> T_base_body) const;

 private:
  const World& world_;
  const RayBodies& bodies_;
  CameraModel camera_;
  Image<Eigen::Vector3f> directions_;  ///< through pixel centres, in camera axes, z = 1
};

}  // namespace pcavr::simulation
