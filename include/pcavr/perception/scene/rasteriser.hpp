// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// Camera and pose of a rendered image. The camera has no distortion.
struct View {
  CameraModel camera;
  Pose T_base_view;  ///< camera axes: x right, y down, z forward
};

/// Frame buffer: colour, depth and object id of each pixel.
struct Canvas {
  Canvas(int width, int height) : color(width, height), depth(width, height), id(width, height) {}

  ColorImage color;
  DepthImage depth;        ///< [m]; 0 where nothing was drawn yet
  Image<std::uint8_t> id;  ///< 0: background
};

/// Colour of a surface point from its vertex colour (white where the mesh has none) and its unit
/// normal in base; both interpolated linearly in the triangle. Channels from 0 to 1.
using Shader =
    std::function<Eigen::Vector3f(const Eigen::Vector3f& color, const Eigen::Vector3f& normal)>;

/// An image on a mesh instead of its vertices' colours.
struct MeshImage {
  const ColorImage& image;
  /// Coordinates by vertex in the unit square, with the origin at the image's upper left corner.
  const std::vector<Eigen::Vector2f>& coordinates;
};

/// Rasterises front faces (counter-clockwise) with a depth test and back-face culling. The mesh
/// needs normals. Triangles that intersect the near plane are not drawn. The image does not depend
/// on the number of threads.
void draw_mesh(Canvas& canvas, const View& view, const TriangleMesh& mesh_base, std::uint8_t id,
               const Shader& shader, Parallelism parallelism, const MeshImage* on_mesh = nullptr);

}  // namespace pcavr
