// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/pinhole_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

/// Points used for a fit: every n-th pixel, for at most about this many.
constexpr std::size_t kFitPoints = 40'000;
constexpr std::size_t kMinFitPoints = 100;

/// Least squares of a line y = slope * x + offset.
struct LineFit {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;

  void add(double at, double value) {
    ++n;
    x += at;
    y += value;
    xx += at * at;
    xy += at * value;
  }
  [[nodiscard]] double slope() const {
    const double spread = n * xx - x * x;
    return spread > 0.0 ? (n * xy - x * y) / spread : 0.0;
  }
  [[nodiscard]] double offset() const { return n > 0.0 ? (y - slope() * x) / n : 0.0; }
};

/// A pixel and the direction of its point.
struct PixelRay {
  double u, v;  ///< [px]
  double x, y;  ///< x / z, y / z in camera axes
};

std::vector<PixelRay> rays_of(int width, const std::vector<Eigen::Vector3f>& points,
                              const Pose& T_sensor_camera) {
  const Eigen::Matrix3f R = T_sensor_camera.rotation_matrix().transpose().cast<float>();
  // Coprime to usual widths, so that all columns are used.
  const std::size_t step = points.size() / kFitPoints * 2 + 1;
  std::vector<PixelRay> rays;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector3f p = R * points[i];
    if (!(p.z() > 0.0F)) continue;
    const auto columns = static_cast<std::size_t>(width);
    rays.push_back({static_cast<double>(i % columns), static_cast<double>(i / columns),
                    static_cast<double>(p.x() / p.z()), static_cast<double>(p.y() / p.z())});
  }
  return rays;
}

PinholeFit fit_rays(int width, int height, const std::vector<PixelRay>& rays) {
  LineFit u;
  LineFit v;
  for (const PixelRay& ray : rays) {
    u.add(ray.x, ray.u);
    v.add(ray.y, ray.v);
  }
  PinholeFit fit{.camera = {.width = width,
                            .height = height,
                            .fx = u.slope(),
                            .fy = v.slope(),
                            .cx = u.offset(),
                            .cy = v.offset()},
                 .T_sensor_camera = {}};
  double sum = 0.0;
  for (const PixelRay& ray : rays) {
    const double du = fit.camera.fx * ray.x + fit.camera.cx - ray.u;
    const double dv = fit.camera.fy * ray.y + fit.camera.cy - ray.v;
    const double square = du * du + dv * dv;
    sum += square;
    fit.residual_max = std::max(fit.residual_max, std::sqrt(square));
  }
  fit.residual_rms = std::sqrt(sum / static_cast<double>(rays.size()));
  fit.is_mirrored = fit.camera.fx * fit.camera.fy < 0.0;
  return fit;
}

/// Turns the camera by half a turn about its optical axis where x points left and y up.
void turn_upright(PinholeFit& fit) {
  if (fit.camera.fx > 0.0 || fit.camera.fy > 0.0) return;
  fit.camera.fx = -fit.camera.fx;
  fit.camera.fy = -fit.camera.fy;
  const Eigen::Quaterniond half_turn(0.0, 0.0, 0.0, 1.0);
  fit.T_sensor_camera = fit.T_sensor_camera * Pose(half_turn, Eigen::Vector3d::Zero());
}

}  // namespace

Pose sensor_camera_pose(SensorAxes axes) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  // Columns: the camera's axes in the sensor's.
  if (axes == SensorAxes::robot) R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  if (axes == SensorAxes::graphics) R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return Pose(Eigen::Quaterniond(R), Eigen::Vector3d::Zero());
}

std::optional<PinholeFit> fit_pinhole(int width, int height,
                                      const std::vector<Eigen::Vector3f>& points) {
  PCAVR_REQUIRE(width > 0 && static_cast<std::size_t>(width) * static_cast<std::size_t>(height) ==
                                 points.size(),
                width, height, points.size());
  std::optional<PinholeFit> best;
  for (const SensorAxes axes : {SensorAxes::optical, SensorAxes::robot, SensorAxes::graphics}) {
    const Pose T_sensor_camera = sensor_camera_pose(axes);
    const std::vector<PixelRay> rays = rays_of(width, points, T_sensor_camera);
    if (rays.size() < kMinFitPoints) continue;
    PinholeFit fit = fit_rays(width, height, rays);
    fit.T_sensor_camera = T_sensor_camera;
    turn_upright(fit);
    const auto rank = [](const PinholeFit& f) {
      const bool is_camera = !f.is_mirrored && f.residual_rms <= kMaxPinholeResidual;
      return std::pair(!is_camera, f.residual_rms);
    };
    if (!best || rank(fit) < rank(*best)) best = fit;
  }
  return best;
}

double projection_residual(const PinholeFit& fit, const std::vector<Eigen::Vector3f>& points) {
  double sum = 0.0;
  const std::vector<PixelRay> rays = rays_of(fit.camera.width, points, fit.T_sensor_camera);
  for (const PixelRay& ray : rays) {
    const double du = fit.camera.fx * ray.x + fit.camera.cx - ray.u;
    const double dv = fit.camera.fy * ray.y + fit.camera.cy - ray.v;
    sum += du * du + dv * dv;
  }
  return rays.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(rays.size()));
}

}  // namespace pcavr
