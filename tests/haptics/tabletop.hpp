// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

#include "haptics/closed_paths.hpp"
#include "prediction/worlds.hpp"

namespace pcavr::test {

/// A table at height 0 as a scan has it: vertices `pitch` [m] apart, off by `noise` [m] upward or
/// downward.
inline TriangleMesh scanned_table(double noise, double pitch = 0.005,
                                  const Eigen::Vector2d& low = {-0.5, -0.4},
                                  const Eigen::Vector2d& high = {0.5, 0.4}) {
  Random random(1);
  TriangleMesh mesh;
  const auto columns = static_cast<std::uint32_t>(std::lround((high.x() - low.x()) / pitch));
  const auto rows = static_cast<std::uint32_t>(std::lround((high.y() - low.y()) / pitch));
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      mesh.vertices.emplace_back(
          Eigen::Vector3d(low.x() + pitch * i, low.y() + pitch * j, noise * random.normal())
              .cast<float>());
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i;
      const std::uint32_t b = a + columns + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

inline std::vector<Eigen::Vector3d> table_outline() {
  return {{-0.5, -0.4, 0.0}, {0.5, -0.4, 0.0}, {0.5, 0.4, 0.0}, {-0.5, 0.4, 0.0}};
}

/// The box of one_box() in the middle of that table.
inline HapticWorldModel one_box_on_a_table(double noise = 0.0) {
  HapticWorldModel model;
  model.world = one_box();
  model.world.static_mesh_base = scanned_table(noise);
  model.supports_base = {table_outline()};
  return model;
}

}  // namespace pcavr::test
