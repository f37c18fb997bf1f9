// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/depth_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "simulation/hashed_noise.hpp"
#include "simulation/smoothing.hpp"

namespace pcavr::simulation {
namespace {

/// Independent random streams of one seed, one per effect.
enum Stream : std::uint64_t { kAxial = 1, kAcross, kDown, kEdge, kLost, kOutlier, kOutlierDepth };

/// A Gaussian random field: unit variance at each pixel, correlated over `sigma` pixels.
Image<float> gaussian_field(int width, int height, double sigma, std::uint64_t seed) {
  Image<float> field(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      field(x, y) =
          normal_of(hash(seed, static_cast<std::uint64_t>(y) << 32, static_cast<std::uint64_t>(x)));
    }
  }
  const std::vector<float> kernel = gaussian_kernel(sigma);
  float power = 0.0F;
  for (const float weight : kernel) power += weight * weight;
  smooth(field, kernel);
  // Smoothing along rows and columns leaves the variance power^2.
  for (float& value : field.pixels()) value /= power;
  return field;
}

/// Stereo shadow: the projector's light reaches a point unless another one occludes it. Projector
/// and camera see a point at normalised abscissae x + b/z and x, so along a row the points have the
/// same order for both, except where one is occluded [ordering constraint of rectified stereo].
MaskImage projector_shadow(const DepthSensor& sensor, const CameraModel& camera,
                           const DepthImage& depth) {
  MaskImage shadow(depth.width(), depth.height());
  for (int y = 0; y < depth.height(); ++y) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (int x = 0; x < depth.width(); ++x) {
      const double z = depth(x, y);
      if (z <= 0.0) continue;
      const double seen_at = camera.normalise({x, y}).x() + sensor.baseline / z;
      if (seen_at < farthest) shadow(x, y) = 1;
      farthest = std::max(farthest, seen_at);
    }
  }
  return shadow;
}

bool is_depth_edge(const DepthSensor& sensor, const DepthImage& depth, int x, int y) {
  const float z = depth(x, y);
  const float jump = static_cast<float>(sensor.edge_depth_ratio) * z;
  for (const auto& [u, v] : {std::pair(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
    if (depth.contains(u, v) && std::abs(depth(u, v) - z) > jump) return true;
  }
  return false;
}

/// Angle between ray and normal [rad].
double incidence_angle(const Eigen::Vector3d& direction, const Eigen::Vector3f& normal) {
  const double cosine = -direction.dot(normal.cast<double>()) / direction.norm();
  return std::acos(std::clamp(cosine, 0.0, 1.0));
}

double quantise(const DepthSensor& sensor, double z) {
  const double product = sensor.focal_length * sensor.baseline;
  const auto steps = static_cast<int>(product / z * sensor.disparity_steps + 0.5);
  return steps > 0 ? product * sensor.disparity_steps / steps : 0.0;
}

class Measurement {
 public:
  Measurement(const DepthSensor& sensor, const CameraModel& camera, const IdealFrame& frame,
              std::uint64_t seed)
      : sensor_(sensor),
        camera_(camera),
        frame_(frame),
        seed_(seed),
        shadow_(projector_shadow(sensor, camera, frame.depth)),
        axial_(field(kAxial)),
        across_(field(kAcross)),
        down_(field(kDown)) {}

  [[nodiscard]] float at(int x, int y) const {
    if (sample_uniform(kOutlier, x, y) < sensor_.outlier_probability) {
      const double span = sensor_.noise.max_depth - sensor_.noise.min_depth;
      return static_cast<float>(sensor_.noise.min_depth +
                                span * sample_uniform(kOutlierDepth, x, y));
    }
    const Eigen::Vector3d direction = camera_.unproject(Eigen::Vector2d(x, y), 1.0);
    const auto [u, v] = seen_pixel(x, y, direction);
    const double z = plane_depth(u, v, direction);
    if (z <= 0.0 || shadow_(u, v) != 0) return 0.0F;
    if (sample_uniform(kLost, x, y) < sensor_.loss_probability) return 0.0F;
    if (is_depth_edge(sensor_, frame_.depth, x, y) &&
        sample_uniform(kEdge, x, y) < sensor_.edge_loss_probability) {
      return 0.0F;
    }
    const double incidence = incidence_angle(direction, frame_.normal_camera(u, v));
    if (incidence > sensor_.max_incidence * std::numbers::pi / 180.0) return 0.0F;
    const double noisy = z + sensor_.noise.depth_std(z, incidence) * axial_(x, y);
    if (noisy < sensor_.noise.min_depth || noisy > sensor_.noise.max_depth) return 0.0F;
    return static_cast<float>(quantise(sensor_, noisy));
  }

 private:
  [[nodiscard]] Image<float> field(Stream stream) const {
    return gaussian_field(frame_.depth.width(), frame_.depth.height(), sensor_.correlation,
                          hash(seed_, stream));
  }

  [[nodiscard]] double sample_uniform(Stream stream, int x, int y) const {
    const auto pixel = static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x);
    return uniform_of(hash(seed_, stream, pixel));
  }

  [[nodiscard]] std::pair<int, int> seen_pixel(int x, int y, const Eigen::Vector3d& ray) const {
    if (frame_.depth(x, y) <= 0.0F) return {x, y};
    const double lateral =
        DepthSensor::lateral_std(incidence_angle(ray, frame_.normal_camera(x, y)));
    const int u = x + static_cast<int>(std::lround(lateral * across_(x, y)));
    const int v = y + static_cast<int>(std::lround(lateral * down_(x, y)));
    return {std::clamp(u, 0, frame_.depth.width() - 1),
            std::clamp(v, 0, frame_.depth.height() - 1)};
  }

  /// Depth at which the ray meets the plane of the surface that pixel (u, v) sees [m]; 0 if it sees
  /// none.
  [[nodiscard]] double plane_depth(int u, int v, const Eigen::Vector3d& ray) const {
    const double z = frame_.depth(u, v);
    if (z <= 0.0) return 0.0;
    const Eigen::Vector3d normal = frame_.normal_camera(u, v).cast<double>();
    const double facing = normal.dot(ray);
    // Seen edge-on, the intersection is ill-conditioned: keep the depth itself.
    if (facing > -0.2 * ray.norm()) return z;
    return normal.dot(camera_.unproject(Eigen::Vector2d(u, v), z)) / facing;
  }

  const DepthSensor& sensor_;
  const CameraModel& camera_;
  const IdealFrame& frame_;
  std::uint64_t seed_;
  MaskImage shadow_;
  Image<float> axial_;
  Image<float> across_;
  Image<float> down_;
};

}  // namespace

double DepthSensor::lateral_std(double incidence) {
  // Beyond 80 degrees the formula diverges; nothing is measured there anyway.
  const double angle = std::min(incidence, 80.0 * std::numbers::pi / 180.0);
  return 0.8 + 0.035 * angle / (0.5 * std::numbers::pi - angle);
}

DepthImage measure_depth(const DepthSensor& sensor, const CameraModel& camera,
                         const IdealFrame& frame, std::uint64_t seed) {
  const Measurement measurement(sensor, camera, frame, seed);
  DepthImage depth(frame.depth.width(), frame.depth.height());
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) depth(x, y) = measurement.at(x, y);
  }
  return depth;
}

}  // namespace pcavr::simulation
