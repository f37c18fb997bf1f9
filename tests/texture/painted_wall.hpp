// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "pcavr/perception/texture/mesh_texture.hpp"

namespace pcavr::test {

/// A wall at z = 0 of base, 0.6 m x 0.4 m, seen from z > 0, whose colours are a function of x and
/// y.
using WallColor = std::function<Eigen::Vector3d(double x, double y)>;

inline constexpr double kWallWidth = 0.6;
inline constexpr double kWallHeight = 0.4;

inline TriangleMesh wall_mesh(int columns, int rows, const Rgb8& color = {90, 90, 90}) {
  TriangleMesh mesh;
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= columns; ++x) {
      mesh.vertices.emplace_back(float(kWallWidth * (double(x) / columns - 0.5)),
                                 float(kWallHeight * (double(y) / rows - 0.5)), 0.0F);
      mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
      mesh.colors.push_back(color);
    }
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x);
      const auto c = static_cast<std::uint32_t>(a + static_cast<std::uint32_t>(columns) + 2U);
      mesh.triangles.push_back({a, a + 1, c});
      mesh.triangles.push_back({a, c, c - 1});
    }
  }
  return mesh;
}

/// Fine, coarse and two triangles.
inline std::vector<TriangleMesh> wall_levels() {
  return {wall_mesh(120, 80), wall_mesh(30, 20), wall_mesh(1, 1)};
}

inline CameraModel wall_camera() {
  return {.width = 320, .height = 240, .fx = 300, .fy = 300, .cx = 159.5, .cy = 119.5};
}

/// Looks from `eye` at the wall's middle; image axes: x right along base x.
inline Pose wall_view(const Eigen::Vector3d& eye) {
  const Eigen::Vector3d z = (-eye).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitY().cross(-z).normalized();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.block<3, 1>(0, 0) = x;
  matrix.block<3, 1>(0, 1) = z.cross(x);
  matrix.block<3, 1>(0, 2) = z;
  matrix.block<3, 1>(0, 3) = eye;
  return Pose::from_matrix(matrix);
}

/// An ideal image; each pixel the mean of 3 x 3 rays. `color_camera` and `T_color_depth`: the
/// camera that takes the colours.
inline TextureView take_view(const Pose& T_base_camera, const WallColor& color,
                             const CameraModel& color_camera = wall_camera(),
                             const Pose& T_color_depth = {}) {
  const CameraModel camera = wall_camera();
  TextureView view{.color = ColorImage(camera.width, camera.height),
                   .depth = DepthImage(camera.width, camera.height),
                   .is_dynamic = {},
                   .T_base_camera = T_base_camera,
                   .sharpness = 1.0};
  const auto on_wall = [](const Pose& T, const CameraModel& model, double u, double v) {
    const Eigen::Vector3d ray = T.rotation() * model.unproject({u, v}, 1.0);
    return std::pair(-T.translation().z() / ray.z(), ray);
  };
  const Pose T_base_color = T_base_camera * T_color_depth.inverse();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      view.depth(x, y) = static_cast<float>(on_wall(T_base_camera, camera, x, y).first);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const double du : {-0.33, 0.0, 0.33}) {
        for (const double dv : {-0.33, 0.0, 0.33}) {
          const auto [z, ray] = on_wall(T_base_color, color_camera, x + du, y + dv);
          const Eigen::Vector3d p = T_base_color.translation() + z * ray;
          sum += color(p.x(), p.y()) / 9.0;
        }
      }
      const auto byte = [](double c) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0, 255.0)));
      };
      view.color(x, y) = {byte(sum.x()), byte(sum.y()), byte(sum.z())};
    }
  }
  return view;
}

/// Views from seven places around.
inline std::vector<Pose> wall_views() {
  std::vector<Pose> views;
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(0.0, 0.0, 0.6), Eigen::Vector3d(0.15, 0.05, 0.55),
        Eigen::Vector3d(-0.2, 0.1, 0.6), Eigen::Vector3d(0.1, -0.2, 0.7),
        Eigen::Vector3d(-0.1, -0.15, 0.5), Eigen::Vector3d(0.3, 0.2, 0.65),
        Eigen::Vector3d(-0.3, -0.1, 0.75)}) {
    views.push_back(wall_view(eye));
  }
  return views;
}

inline std::vector<TextureView> take_views(const WallColor& color) {
  std::vector<TextureView> views;
  for (const Pose& pose : wall_views()) views.push_back(take_view(pose, color));
  return views;
}

/// The texture's colour at a point of the wall, through the texture coordinates of a level.
inline Eigen::Vector3d texture_at(const MeshTexture& texture, const TriangleMesh& mesh,
                                  std::size_t level, double x, double y) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::uint32_t v) {
      return mesh.vertices[v].head<2>().cast<double>().eval();
    };
    Eigen::Matrix2d sides;
    sides << at(b) - at(a), at(c) - at(a);
    const Eigen::Vector2d w = sides.inverse() * (Eigen::Vector2d(x, y) - at(a));
    if (w.minCoeff() < -1e-6 || w.sum() > 1.0 + 1e-6) continue;
    const TextureCoordinates& uv = texture.coordinates[level];
    const Eigen::Vector2d in_texture =
        ((1.0 - w.sum()) * uv[a].cast<double>() + w.x() * uv[b].cast<double>() +
         w.y() * uv[c].cast<double>())
            .cwiseProduct(Eigen::Vector2d(texture.image.width(), texture.image.height())) -
        Eigen::Vector2d::Constant(0.5);
    const int u = static_cast<int>(std::floor(in_texture.x()));
    const int v = static_cast<int>(std::floor(in_texture.y()));
    const auto pixel = [&](int du, int dv) {
      const Rgb8& rgb = texture.image(std::clamp(u + du, 0, texture.image.width() - 1),
                                      std::clamp(v + dv, 0, texture.image.height() - 1));
      return Eigen::Vector3d(rgb.r, rgb.g, rgb.b);
    };
    const double fu = in_texture.x() - u;
    const double fv = in_texture.y() - v;
    return (1.0 - fv) * ((1.0 - fu) * pixel(0, 0) + fu * pixel(1, 0)) +
           fv * ((1.0 - fu) * pixel(0, 1) + fu * pixel(1, 1));
  }
  return Eigen::Vector3d::Constant(-1.0);
}

}  // namespace pcavr::test
