// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/range_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

/// Relative difference of inverse depth up to which neighbouring rays see one surface: at a pixel's
/// width of 2 mm per metre it is a slope of 86 degrees.
constexpr float kSameSurface = 0.03F;
constexpr Rgb8 kNoColor{128, 128, 128};

/// Sums over the rays of a pixel.
struct RaySum {
  float du = 0, dv = 0;  ///< from the pixel's centre
  float inverse = 0;     ///< 1 / z
  float r = 0, g = 0, b = 0;
  float count = 0;
};

/// The mean of a pixel's rays.
struct Ray {
  float u = 0, v = 0;  ///< [px]
  float inverse = 0;   ///< 0: none
  std::array<float, 3> color{};
};

/// A point's place in the image.
struct Projection {
  float du, dv, z;
  std::int32_t pixel;  ///< -1: outside
};

std::vector<Projection> project_all(const std::vector<Eigen::Vector3f>& points,
                                    const CameraModel& camera, const Pose& T_sensor_camera) {
  const Eigen::Matrix3f R = T_sensor_camera.rotation_matrix().transpose().cast<float>();
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx);
  const auto cy = static_cast<float>(camera.cy);
  std::vector<Projection> projections;
  projections.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = R * point;
    Projection to{0.0F, 0.0F, p.z(), -1};
    if (p.z() > 0.0F) {
      const float u = fx * p.x() / p.z() + cx;
      const float v = fy * p.y() / p.z() + cy;
      // Written so that NaN is outside.
      if (u >= -0.5F && v >= -0.5F && u < static_cast<float>(camera.width) - 0.5F &&
          v < static_cast<float>(camera.height) - 0.5F) {
        const int column = static_cast<int>(u + 0.5F);
        const int row = static_cast<int>(v + 0.5F);
        to = {u - static_cast<float>(column), v - static_cast<float>(row), p.z(),
              row * camera.width + column};
      }
    }
    projections.push_back(to);
  }
  return projections;
}

/// The mean ray of each pixel's nearest surface, with a border of one pixel without rays.
Image<Ray> mean_rays(const std::vector<Projection>& projections, const std::vector<Rgb8>& colors,
                     const CameraModel& camera, std::size_t& points_used) {
  const auto pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<float> nearest(pixels, 1e30F);
  for (const Projection& to : projections) {
    if (to.pixel < 0) continue;
    float& z = nearest[static_cast<std::size_t>(to.pixel)];
    z = std::min(z, to.z);
  }
  std::vector<RaySum> sums(pixels);
  for (std::size_t i = 0; i < projections.size(); ++i) {
    const Projection& to = projections[i];
    if (to.pixel < 0) continue;
    const auto pixel = static_cast<std::size_t>(to.pixel);
    if (to.z > nearest[pixel] * (1.0F + kSameSurface)) continue;
    const Rgb8 color = colors.empty() ? kNoColor : colors[i];
    RaySum& sum = sums[pixel];
    sum.du += to.du;
    sum.dv += to.dv;
    sum.inverse += 1.0F / to.z;
    sum.r += static_cast<float>(color.r);
    sum.g += static_cast<float>(color.g);
    sum.b += static_cast<float>(color.b);
    ++sum.count;
    ++points_used;
  }
  Image<Ray> rays(camera.width + 2, camera.height + 2);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const RaySum& sum = sums[static_cast<std::size_t>(v * camera.width + u)];
      if (sum.count == 0.0F) continue;
      const float scale = 1.0F / sum.count;
      rays(u + 1, v + 1) = {static_cast<float>(u) + sum.du * scale,
                            static_cast<float>(v) + sum.dv * scale,
                            sum.inverse * scale,
                            {sum.r * scale, sum.g * scale, sum.b * scale}};
    }
  }
  return rays;
}

/// Least squares of a plane in inverse depth around a pixel's centre.
struct InversePlane {
  float n = 0, u = 0, v = 0, w = 0, uu = 0, uv = 0, vv = 0, uw = 0, vw = 0;

  void add(float du, float dv, float dw) {
    ++n;
    u += du;
    v += dv;
    w += dw;
    uu += du * du;
    uv += du * dv;
    vv += dv * dv;
    uw += du * dw;
    vw += dv * dw;
  }
  /// The slopes along u and v; zero where the rays lie on a line.
  [[nodiscard]] std::array<float, 2> slopes() const {
    const float a = uu - u * u / n;
    const float b = uv - u * v / n;
    const float c = vv - v * v / n;
    const float determinant = a * c - b * b;
    if (!(determinant > 0.1F)) return {0.0F, 0.0F};
    const float p = uw - u * w / n;
    const float q = vw - v * w / n;
    return {(c * p - b * q) / determinant, (a * q - b * p) / determinant};
  }
};

/// The 3 x 3 rays around a pixel; `at` points to the middle one.
struct Neighbourhood {
  const Ray* at;
  int stride;

  [[nodiscard]] const Ray& operator()(int du, int dv) const { return at[dv * stride + du]; }
};

/// The inverse depth whose surface a pixel shows: its own; without a ray that of the nearest of two
/// opposite neighbours on one surface; 0 for none.
float surface_at(const Neighbourhood& rays) {
  if (rays.at->inverse > 0.0F) return rays.at->inverse;
  float found = 0.0F;
  for (const auto& [du, dv] : {std::array{1, 0}, std::array{0, 1}}) {
    const float a = rays(-du, -dv).inverse;
    const float b = rays(du, dv).inverse;
    const float near = std::max(a, b);
    if (std::min(a, b) > (1.0F - kSameSurface) * near) found = std::max(found, near);
  }
  return found;
}

std::uint8_t rounded(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

/// Depth and colour at the centre of pixel (u, v).
void resample(const Neighbourhood& rays, int u, int v, RangeImage& image) {
  const float surface = surface_at(rays);
  if (surface == 0.0F) return;
  const auto centre_u = static_cast<float>(u);
  const auto centre_v = static_cast<float>(v);
  InversePlane plane;
  std::array<float, 3> color{};
  float weight_sum = 0.0F;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const Ray& ray = rays(du, dv);
      if (!(std::abs(ray.inverse - surface) <= kSameSurface * surface)) continue;
      const float x = ray.u - centre_u;
      const float y = ray.v - centre_v;
      plane.add(x, y, ray.inverse - surface);
      // Bilinear, and never all zero.
      const float weight =
          std::max(0.0F, 1.0F - std::abs(x)) * std::max(0.0F, 1.0F - std::abs(y)) + 1e-6F;
      for (std::size_t c = 0; c < 3; ++c) color[c] += weight * ray.color[c];
      weight_sum += weight;
    }
  }
  const auto [slope_u, slope_v] = plane.slopes();
  // The correction starts from the pixel's own ray, so that its noise stays independent of its
  // neighbours'.
  const bool has_ray = rays.at->inverse > 0.0F;
  const float from_u = has_ray ? rays.at->u - centre_u : plane.u / plane.n;
  const float from_v = has_ray ? rays.at->v - centre_v : plane.v / plane.n;
  const float from = has_ray ? 0.0F : plane.w / plane.n;
  const float correction = from - slope_u * from_u - slope_v * from_v;
  const float limit = kSameSurface * surface;
  image.depth(u, v) = 1.0F / (surface + std::clamp(correction, -limit, limit));
  image.color(u, v) = {rounded(color[0] / weight_sum), rounded(color[1] / weight_sum),
                       rounded(color[2] / weight_sum)};
}

}  // namespace

RangeImage render_range_image(const std::vector<Eigen::Vector3f>& points_sensor,
                              const std::vector<Rgb8>& colors, const CameraModel& camera,
                              const Pose& T_sensor_camera) {
  PCAVR_REQUIRE(colors.empty() || colors.size() == points_sensor.size(), colors.size(),
                points_sensor.size());
  PCAVR_REQUIRE(!camera.has_distortion());
  RangeImage image{.depth = DepthImage(camera.width, camera.height),
                   .color = ColorImage(camera.width, camera.height, kNoColor)};
  const std::vector<Projection> projections = project_all(points_sensor, camera, T_sensor_camera);
  const Image<Ray> rays = mean_rays(projections, colors, camera, image.points_used);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      resample({&rays(u + 1, v + 1), rays.width()}, u, v, image);
    }
  }
  return image;
}

}  // namespace pcavr
