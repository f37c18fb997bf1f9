// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/scene/rasteriser.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/geometry/pixel.hpp"

namespace pcavr {
namespace {

constexpr float kNearPlane = 0.01F;                 ///< [m]
constexpr std::size_t kVerticesPerChunk = 1 << 16;  // amortises the scheduling of a task
constexpr std::size_t kRowsPerBand = 64;            // amortises the scheduling of a task

/// A projected vertex, with its inverse depth, which is linear in the image.
struct Projected {
  float x = 0.0F;
  float y = 0.0F;
  float inverse_depth = 0.0F;  ///< [1/m]; 0 behind the near plane
};

std::vector<Projected> project(const View& view, const std::vector<Eigen::Vector3f>& points,
                               Parallelism parallelism) {
  const Pose T_view_base = view.T_base_view.inverse();
  const Eigen::Matrix3f R = T_view_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_view_base.translation().cast<float>();
  const Eigen::Vector2f focal(float(view.camera.fx), float(view.camera.fy));
  const Eigen::Vector2f centre(float(view.camera.cx), float(view.camera.cy));
  std::vector<Projected> projected(points.size());
  parallel_for(parallelism, points.size(), kVerticesPerChunk,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const Eigen::Vector3f p = R * points[i] + t;
                   if (!(p.z() > kNearPlane)) continue;
                   projected[i] = {focal.x() * p.x() / p.z() + centre.x(),
                                   focal.y() * p.y() / p.z() + centre.y(), 1.0F / p.z()};
                 }
               });
  return projected;
}

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
  BandPainter(Canvas& canvas, const TriangleMesh& mesh, const std::vector<Projected>& projected,
              const Shader& shader, const MeshImage* on_mesh, std::uint8_t id, int first, int last)
      : canvas_(canvas),
        mesh_(mesh),
        projected_(projected),
        shader_(shader),
        on_mesh_(on_mesh),
        id_(id),
        first_(first),
        last_(last) {}

  void draw(const std::array<std::uint32_t, 3>& triangle) {
    const Projected& a = projected_[triangle[0]];
    const Projected& b = projected_[triangle[1]];
    const Projected& c = projected_[triangle[2]];
    if (a.inverse_depth == 0.0F || b.inverse_depth == 0.0F || c.inverse_depth == 0.0F) return;
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    const int from_y = std::max(first_, rounded_up(low_y));
    const int to_y = std::min(last_ - 1, rounded_down(high_y));
    if (from_y > to_y) return;
    // The image's y axis points down: counter-clockwise triangles have a negative area.
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(area < 0.0F)) return;
    const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
    const int from_x = std::max(0, rounded_up(low_x));
    const int to_x = std::min(canvas_.color.width() - 1, rounded_down(high_x));
    for (int y = from_y; y <= to_y; ++y) {
      for (int x = from_x; x <= to_x; ++x) {
        const float px = static_cast<float>(x);
        const float py = static_cast<float>(y);
        const float u = ((c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x)) / area;
        const float v = ((a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x)) / area;
        const float w = 1.0F - u - v;
        if (u < 0.0F || v < 0.0F || w < 0.0F) continue;
        set_pixel(x, y, triangle, {u * a.inverse_depth, v * b.inverse_depth, w * c.inverse_depth});
      }
    }
  }

 private:
  /// Outside any image [px]; coordinates are clamped to it.
  static constexpr int kFarOutside = 1'000'000;
  static int rounded_up(float value) {
    return clamp_to_int(std::ceil(value), -kFarOutside, kFarOutside);
  }
  static int rounded_down(float value) {
    return clamp_to_int(std::floor(value), -kFarOutside, kFarOutside);
  }

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
  const std::vector<Projected>& projected_;
  const Shader& shader_;
  const MeshImage* on_mesh_;
  std::uint8_t id_;
  int first_;
  int last_;
};

}  // namespace

void draw_mesh(Canvas& canvas, const View& view, const TriangleMesh& mesh_base, std::uint8_t id,
               const Shader& shader, Parallelism parallelism, const MeshImage* on_mesh) {
  PCAVR_REQUIRE(on_mesh == nullptr || on_mesh->coordinates.size() == mesh_base.vertices.size());
  PCAVR_REQUIRE(mesh_base.normals.size() == mesh_base.vertices.size());
  const std::vector<Projected> projected = project(view, mesh_base.vertices, parallelism);
  parallel_for(parallelism, static_cast<std::size_t>(canvas.color.height()), kRowsPerBand,
               [&](std::size_t begin, std::size_t end) {
                 BandPainter painter(canvas, mesh_base, projected, shader, on_mesh, id,
                                     static_cast<int>(begin), static_cast<int>(end));
                 for (const auto& triangle : mesh_base.triangles) painter.draw(triangle);
               });
}

}  // namespace pcavr
