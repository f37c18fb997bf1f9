// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr::test {

/// Adds a box, wound outward.
inline void add_box(TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(Eigen::Vector3d((i & 1) != 0 ? high.x() : low.x(),
                                               (i & 2) != 0 ? high.y() : low.y(),
                                               (i & 4) != 0 ? high.z() : low.z())
                                   .cast<float>());
  }
  const std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

inline CadModel box_model(const Eigen::Vector3d& sides, const std::string& name = "box") {
  TriangleMesh mesh;
  add_box(mesh, -0.5 * sides, 0.5 * sides);
  return make_cad_model(mesh, name, "test").value();
}

/// The foam-faced box of paper C, rounded: 0.175 x 0.175 x 0.125 m, 3 kg, 9.57 N.
inline BodyPhysics foam_physics() {
  BodyPhysics physics;
  physics.friction.mass = 3.0;
  physics.friction.limiting_force = 9.57;
  physics.friction.limiting_force_std = 0.5;
  physics.friction.coulomb_force = 8.5;
  physics.contact = {8000.0, 30.0, 1.0};
  physics.friction_radius = 0.067;
  return physics;
}

constexpr double kTipRadius = 0.01;
const Eigen::Vector3d kBoxSides(0.175, 0.175, 0.125);

/// A pose on the support z = 0, the centre above (x, y).
inline Pose standing_at(double x, double y, double yaw = 0.0, double height = 0.125) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {x, y, 0.5 * height}};
}

inline WorldModel one_box(const BodyPhysics& physics = foam_physics()) {
  WorldModel model;
  model.bodies.push_back({box_model(kBoxSides), standing_at(0.0, 0.0), physics});
  model.tool_radius = kTipRadius;
  return model;
}

/// Position at which the tip just touches the box of one_box() from the side of negative x.
inline Eigen::Vector3d touching_tip(double y = 0.0, double z = 0.06) {
  return {-0.5 * kBoxSides.x() - kTipRadius, y, z};
}

/// Boxes in a row along x, side by side with a gap [m] between them.
inline WorldModel row_of_boxes(int count, double gap) {
  WorldModel model;
  model.tool_radius = kTipRadius;
  BodyPhysics physics = foam_physics();
  physics.contact.damping = 500.0;  // so that oscillations of a row decay within a test
  for (int i = 0; i < count; ++i) {
    model.bodies.push_back({box_model(kBoxSides, "box" + std::to_string(i)),
                            standing_at((0.175 + gap) * i, 0.0), physics});
  }
  return model;
}

/// A wall across x, its face at `x`, of small triangles like a scan, wavy by `noise` [m].
inline TriangleMesh wall_at(double x, double noise = 0.0) {
  TriangleMesh mesh;
  constexpr int kCells = 40;
  constexpr double kSide = 0.01;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const double wave = noise * std::sin(1.7 * i) * std::cos(2.3 * j);
      mesh.vertices.emplace_back(
          Eigen::Vector3d(x + wave, kSide * (i - kCells / 2), kSide * (j - 5)).cast<float>());
    }
  }
  for (std::uint32_t i = 0; i < kCells; ++i) {
    for (std::uint32_t j = 0; j < kCells; ++j) {
      const std::uint32_t a = i * (kCells + 1) + j;
      const std::uint32_t b = a + kCells + 1;
      mesh.triangles.push_back({a, a + 1, b});  // facing -x
      mesh.triangles.push_back({b, a + 1, b + 1});
    }
  }
  return mesh;
}

/// Runs a world along a path of the tip, p(t), from 0 to `end` [s].
template <typename Path, typename After>
void run(PredictedWorld& world, const Path& path, double end, double dt, const After& after) {
  const auto steps = static_cast<long>(std::lround(end / dt));
  for (long i = 1; i <= steps; ++i) {
    const double t = static_cast<double>(i) * dt;
    world.step(path(t - dt), path(t), dt);
    after(t);
  }
}
template <typename Path>
void run(PredictedWorld& world, const Path& path, double end, double dt) {
  run(world, path, end, dt, [](double) {});
}

}  // namespace pcavr::test
