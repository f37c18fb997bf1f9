// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/rasteriser.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/geometry/rasterise.hpp"

namespace pcavr {
namespace {

constexpr float kNearPlane = 0.01F;       ///< [m]
constexpr std::size_t kRowsPerBand = 64;  // amortises the scheduling of a task

Eigen::Vector3f color_of(const TriangleMesh& mesh, std::uint32_t vertex) {
  if (mesh.colors.empty()) return Eigen::Vector3f::Ones();
  const Rgb8& c = mesh.colors[vertex];
  return Eigen::Vector3f(c.r, c.g, c.b) / 255.0F;
}

/// Bilinear, at a point of the unit square.
Eigen::Vector3f color_of(const ColorImage& image, const Eigen::Vector2f& at) {
  const auto clamped = [](float position, int size) {
    return std::clamp(position * static_cast<float>(size) - 0.5F, 0.0F,
                      static_cast<float>(size - 1));
  };
  const float u = clamped(at.x(), image.width());
  const float v = clamped(at.y(), image.height());
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  const auto color = [&](int right, int down) -> Eigen::Vector3f {
    const Rgb8& c =
        image(std::min(x + right, image.width() - 1), std::min(y + down, image.height() - 1));
    return Eigen::Vector3f(c.r, c.g, c.b) / 255.0F;
  };
  const float fx = u - static_cast<float>(x);
  const float fy = v - static_cast<float>(y);
  return (1.0F - fy) * ((1.0F - fx) * color(0, 0) + fx * color(1, 0)) +
         fy * ((1.0F - fx) * color(0, 1) + fx * color(1, 1));
}

std::uint8_t to_byte(float channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0F, 1.0F) * 255.0F));
}

/// Draws one mesh in the rows [first, last).
class BandPainter {
 public:
  BandPainter(Canvas& canvas, const TriangleMesh& mesh,
              const std::vector<ProjectedVertex>& projected, const Shader& shader,
              const MeshImage* on_mesh, std::uint8_t id, int first, int last)
      : canvas_(canvas),
        mesh_(mesh),
        projected_(projected),
        shader_(shader),
        on_mesh_(on_mesh),
        id_(id),
        window_{0, first, canvas.color.width(), last} {}

  void draw(const std::array<std::uint32_t, 3>& triangle) {
    const ProjectedVertex& a = projected_[triangle[0]];
    const ProjectedVertex& b = projected_[triangle[1]];
    const ProjectedVertex& c = projected_[triangle[2]];
    if (!(a.is_in_front() && b.is_in_front() && c.is_in_front())) return;
    // Front faces are counter-clockwise. NaN, of a vertex too far away for a float, draws nothing.
    if (!(doubled_area(a.pixel, b.pixel, c.pixel) < 0.0F)) return;
    rasterise_triangle(
        a.pixel, b.pixel, c.pixel, window_, [&](int x, int y, float of_a, float of_b, float of_c) {
          set_pixel(x, y, triangle,
                    {of_a * a.inverse_depth, of_b * b.inverse_depth, of_c * c.inverse_depth});
        });
  }

 private:
  /// `weights`: barycentric coordinates, each divided by its corner's depth (perspective-correct
  /// interpolation).
  void set_pixel(int x, int y, const std::array<std::uint32_t, 3>& triangle,
                 const Eigen::Vector3f& weights) {
    const float depth = 1.0F / weights.sum();
    float& z_buffer = canvas_.depth(x, y);
    if (z_buffer != 0.0F && z_buffer <= depth) return;
    z_buffer = depth;
    canvas_.id(x, y) = id_;
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    Eigen::Vector2f in_image = Eigen::Vector2f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = triangle[static_cast<std::size_t>(corner)];
      const float weight = weights[corner] * depth;
      if (on_mesh_ != nullptr) {
        in_image += weight * on_mesh_->coordinates[vertex];
      } else {
        color += weight * color_of(mesh_, vertex);
      }
      normal += weights[corner] * mesh_.normals[vertex];
    }
    if (on_mesh_ != nullptr) color = color_of(on_mesh_->image, in_image);
    const Eigen::Vector3f shaded = shader_(color, normal.normalized());
    canvas_.color(x, y) = {to_byte(shaded.x()), to_byte(shaded.y()), to_byte(shaded.z())};
  }

  Canvas& canvas_;
  const TriangleMesh& mesh_;
  const std::vector<ProjectedVertex>& projected_;
  const Shader& shader_;
  const MeshImage* on_mesh_;
  std::uint8_t id_;
  RasterWindow window_;
};

}  // namespace

void draw_mesh(Canvas& canvas, const View& view, const TriangleMesh& mesh_base, std::uint8_t id,
               const Shader& shader, Parallelism parallelism, const MeshImage* on_mesh) {
  PCAVR_REQUIRE(on_mesh == nullptr || on_mesh->coordinates.size() == mesh_base.vertices.size());
  PCAVR_REQUIRE(mesh_base.normals.size() == mesh_base.vertices.size());
  const std::vector<ProjectedVertex> projected = project_vertices(
      mesh_base.vertices, view.camera, view.T_base_view.inverse(), kNearPlane, parallelism);
  parallel_for(parallelism, static_cast<std::size_t>(canvas.color.height()), kRowsPerBand,
               [&](std::size_t begin, std::size_t end) {
                 BandPainter painter(canvas, mesh_base, projected, shader, on_mesh, id,
                                     static_cast<int>(begin), static_cast<int>(end));
                 for (const auto& triangle : mesh_base.triangles) painter.draw(triangle);
               });
}

}  // namespace pcavr
