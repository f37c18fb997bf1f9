// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "cloud_camera.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/recordings/cloud/cloud_alignment.hpp"
#include "pcavr/recordings/cloud/range_image.hpp"

namespace pcavr {
namespace {

constexpr double kMillimetre = 1e-3;
/// Coordinates whose median distance from the sensor is larger are millimetres: no sensor for a
/// room measures 100 m, and 100 mm is nearer than any measures.
constexpr double kMaxMedianRange = 100.0;
constexpr Rgb8 kNoColor{128, 128, 128};

std::string pixels_text(double pixels) { return fmt::format("{:.2f} px", pixels); }

double median_range(const RecordedCloud& cloud) {
  const Eigen::Vector3f sensor = cloud.T_cloud_sensor.translation().cast<float>();
  std::vector<double> ranges;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (!std::isnan(p.x())) ranges.push_back(static_cast<double>((p - sensor).norm()));
  }
  return median(std::move(ranges));
}

std::vector<Eigen::Vector3f> in_frame(const Pose& T_a_b, std::vector<Eigen::Vector3f> points_b) {
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  for (Eigen::Vector3f& p : points_b) p = R * p + t;
  return points_b;
}

bool is_identity(const Pose& pose) {
  return translation_distance(pose, Pose()) < 1e-9 && rotation_distance(pose, Pose()) < 1e-9;
}

/// The first, the last and some clouds between: their indices, ascending.
std::set<std::size_t> probe_indices(std::size_t count) {
  return {0, count / 4, count / 2, count - 1 - count / 4, count - 1};
}

/// A cloud to decide from, and its file.
struct Probe {
  std::string file;
  RecordedCloud cloud;
};

Expected<std::vector<Probe>> read_probes(const std::vector<ListedCloud>& clouds,
                                         Parallelism parallelism) {
  const std::set<std::size_t> chosen = probe_indices(clouds.size());
  const std::vector<std::size_t> indices(chosen.begin(), chosen.end());
  std::vector<std::optional<Expected<RecordedCloud>>> read(indices.size());
  parallel_for(parallelism, indices.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) read[i] = read_cloud(clouds[indices[i]].file);
  });
  std::vector<Probe> probes;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!*read[i]) return read[i]->error();
    probes.push_back({clouds[indices[i]].file.string(), std::move(**read[i])});
  }
  return probes;
}

/// Finds the unit and converts the probes to it.
Expected<void> apply_unit(const CloudImportOptions& options, std::vector<Probe>& probes,
                          CloudCamera& camera) {
  std::vector<double> ranges;
  for (const Probe& probe : probes) {
    if (probe.cloud.measured_points() > 0) ranges.push_back(median_range(probe.cloud));
  }
  const double range = median(std::move(ranges));
  camera.is_unit_guessed = !options.unit && range > kMaxMedianRange;
  camera.unit = options.unit.value_or(camera.is_unit_guessed ? kMillimetre : 1.0);
  camera.median_range = range * camera.unit;
  if (camera.median_range > kMaxMedianRange) {
    return Error{.message = "its points are " + std::to_string(static_cast<long>(range)) +
                            " units from the sensor (median)",
                 .file = probes.front().file,
                 .hint = "give the unit of its coordinates by --unit"};
  }
  for (Probe& probe : probes) {
    Expected<MetricCloud> metric = to_metres(std::move(probe.cloud), camera.unit, probe.file);
    if (!metric) return metric.error();
    probe.cloud = std::move(metric->cloud);
  }
  return {};
}

/// Whether the viewpoints are poses of the sensor. One viewpoint for all is what a grabber writes,
/// such as the turn from its optical axes, wherever the camera is; a single cloud's may be its
/// pose.
bool are_poses(const std::vector<Probe>& probes) {
  const Pose& first = probes.front().cloud.T_cloud_sensor;
  if (probes.size() == 1) return !is_identity(first);
  return std::any_of(probes.begin(), probes.end(), [&](const Probe& probe) {
    constexpr double kRounding = 1e-6;  // [m, rad]
    const Pose& other = probe.cloud.T_cloud_sensor;
    return translation_distance(first, other) > kRounding ||
           rotation_distance(first, other) > kRounding;
  });
}

Error not_pinhole_error(const Probe& probe, const std::optional<PinholeFit>& fit) {
  if (!fit) {
    return {.message = "has too few points in front of the sensor to estimate a camera",
            .file = probe.file,
            .hint = "points must be in the sensor's frame, or VIEWPOINT its pose"};
  }
  if (fit->is_mirrored && fit->residual_rms <= kMaxPinholeResidual) {
    return {.message = "is mirrored: its coordinates are left-handed",
            .file = probe.file,
            .hint = "write x right, y down, z forward, or negate one axis"};
  }
  return {.message = "is organised, but no pinhole projection: the best camera leaves " +
                     pixels_text(fit->residual_rms) + " rms",
          .file = probe.file,
          .hint = "rectify the clouds, or give --unorganised to use their rays alone"};
}

/// Organised clouds: the camera of the first that has enough points for it.
Expected<void> fit_camera(const std::vector<Probe>& probes, CloudCamera& camera) {
  const Probe* fullest = &probes.front();
  for (const Probe& probe : probes) {
    if (probe.cloud.measured_points() > fullest->cloud.measured_points()) fullest = &probe;
  }
  const RecordedCloud& cloud = fullest->cloud;
  const auto is_camera = [](const std::optional<PinholeFit>& fit) {
    return fit && !fit->is_mirrored && fit->residual_rms <= kMaxPinholeResidual;
  };
  std::optional<PinholeFit> fit = fit_pinhole(cloud.width, cloud.height, cloud.points);
  if (!is_camera(fit) && !is_identity(cloud.T_cloud_sensor)) {
    auto seen = fit_pinhole(cloud.width, cloud.height,
                            in_frame(cloud.T_cloud_sensor.inverse(), cloud.points));
    if (is_camera(seen)) {
      camera.is_in_sensor_frame = false;
      fit = std::move(seen);
    }
  }
  if (!is_camera(fit)) return not_pinhole_error(*fullest, fit);
  camera.pinhole = *fit;
  camera.T_sensor_camera = {fit->T_sensor_camera};
  return {};
}

/// Unorganised clouds: the points are in the cloud's frame, seen from the viewpoint in it; or in
/// the sensor's at the viewpoint, where only so their rays are a camera's pixels.
Expected<void> choose_rays(const std::vector<Probe>& probes, CloudCamera& camera) {
  const auto points_by = [&](bool is_in_sensor_frame) {
    std::vector<std::vector<Eigen::Vector3f>> points_sensor;
    points_sensor.reserve(probes.size());
    for (const auto& [file, cloud] : probes) {
      points_sensor.push_back(is_in_sensor_frame
                                  ? cloud.points
                                  : in_frame(cloud.T_cloud_sensor.inverse(), cloud.points));
    }
    return points_sensor;
  };
  camera.is_in_sensor_frame = false;
  RangeCameras rays = choose_range_cameras(points_by(false));
  const bool has_viewpoint = std::any_of(probes.begin(), probes.end(), [](const Probe& probe) {
    return !is_identity(probe.cloud.T_cloud_sensor);
  });
  if (!rays.is_grid && has_viewpoint) {
    RangeCameras untransformed = choose_range_cameras(points_by(true));
    camera.is_in_sensor_frame = untransformed.is_grid;
    if (untransformed.is_grid) rays = std::move(untransformed);
  }
  if (rays.T_sensor_camera.empty()) {
    return Error{.message = "the clouds have too few points",
                 .file = probes.front().file,
                 .hint = "at least 100 points are needed"};
  }
  camera.pinhole.camera = rays.camera;
  camera.T_sensor_camera = std::move(rays.T_sensor_camera);
  camera.ray_spacing = rays.ray_spacing;
  return {};
}

ColorImage color_image(const RecordedCloud& cloud) {
  ColorImage image(cloud.width, cloud.height, kNoColor);
  std::copy(cloud.colors.begin(), cloud.colors.end(), image.pixels().begin());
  return image;
}

/// Depth along the optical axis of an organised cloud.
DepthImage depth_image(const RecordedCloud& cloud, const Eigen::RowVector3f& axis, float offset) {
  DepthImage image(cloud.width, cloud.height);
  const std::span<float> depth = image.pixels();
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float z = axis * cloud.points[i] + offset;
    // Written so that NaN becomes 0.
    depth[i] = z > 0.0F ? z : 0.0F;
  }
  return image;
}

/// The pose of the sensor in the frame of the cloud's points.
Pose sensor_pose(const RecordedCloud& cloud, const CloudCamera& camera) {
  return camera.is_in_sensor_frame ? Pose() : cloud.T_cloud_sensor;
}

Expected<void> convert_organised(const RecordedCloud& cloud, const std::string& file,
                                 const CloudCamera& camera, ConvertedCloud& converted) {
  const PinholeFit& pinhole = camera.pinhole;
  if (cloud.width != pinhole.camera.width || cloud.height != pinhole.camera.height) {
    return Error{.message = "is organised as " + std::to_string(cloud.width) + " x " +
                            std::to_string(cloud.height) + ", others as " +
                            std::to_string(pinhole.camera.width) + " x " +
                            std::to_string(pinhole.camera.height),
                 .file = file,
                 .hint = "import clouds of one size at a time, or give --unorganised"};
  }
  const Pose T_cloud_camera = sensor_pose(cloud, camera) * pinhole.T_sensor_camera;
  const Pose T_camera_cloud = T_cloud_camera.inverse();
  converted.residual =
      camera.is_in_sensor_frame
          ? projection_residual(pinhole, cloud.points)
          : projection_residual(pinhole, in_frame(cloud.T_cloud_sensor.inverse(), cloud.points));
  if (converted.residual > kMaxPinholeResidual) {
    return Error{.message = "does not have the camera of the other clouds: its points project " +
                            pixels_text(converted.residual) + " (rms) from their pixels",
                 .file = file,
                 .hint = "import the clouds of one camera at a time"};
  }
  const Eigen::RowVector3f axis = T_camera_cloud.rotation_matrix().row(2).cast<float>();
  converted.frames.push_back(
      {T_cloud_camera,
       depth_image(cloud, axis, static_cast<float>(T_camera_cloud.translation().z())),
       color_image(cloud)});
  converted.points_used = converted.points;
  return {};
}

void render_rays(const RecordedCloud& cloud, const CloudCamera& camera, ConvertedCloud& converted) {
  const Pose T_cloud_sensor = sensor_pose(cloud, camera);
  const auto points_sensor = in_frame(T_cloud_sensor.inverse(), cloud.points);
  for (const Pose& T_sensor_camera : camera.T_sensor_camera) {
    RangeImage image =
        render_range_image(points_sensor, cloud.colors, camera.pinhole.camera, T_sensor_camera);
    converted.points_used += image.points_used;
    converted.frames.push_back(
        {T_cloud_sensor * T_sensor_camera, std::move(image.depth), std::move(image.color)});
  }
}

}  // namespace

Expected<MetricCloud> to_metres(RecordedCloud cloud, double unit, const std::string& file) {
  MetricCloud metric{.cloud = std::move(cloud)};
  metric.points = metric.cloud.measured_points();
  if (metric.points == 0) {
    return Error{.message = "has no measured point",
                 .file = file,
                 .hint = "remove the file; its coordinates are all NaN or zero, or it is empty"};
  }
  if (unit == 1.0) return metric;
  for (Eigen::Vector3f& p : metric.cloud.points) p *= static_cast<float>(unit);
  const Pose& viewpoint = metric.cloud.T_cloud_sensor;
  metric.cloud.T_cloud_sensor = Pose(viewpoint.rotation(), viewpoint.translation() * unit);
  return metric;
}

Expected<CloudCamera> choose_cloud_camera(const std::vector<ListedCloud>& clouds,
                                          const CloudImportOptions& options) {
  Expected<std::vector<Probe>> probes = read_probes(clouds, options.parallelism);
  if (!probes) return probes.error();
  CloudCamera camera;
  if (auto done = apply_unit(options, *probes, camera); !done) return done.error();
  const std::vector<Probe>& all = *probes;
  camera.has_viewpoints = are_poses(all);
  camera.is_organised = !options.as_unorganised && all.front().cloud.is_organised();
  const Expected<void> chosen =
      camera.is_organised ? fit_camera(all, camera) : choose_rays(all, camera);
  if (!chosen) return chosen.error();
  return camera;
}

Expected<ConvertedCloud> convert_cloud(RecordedCloud cloud, const std::string& file,
                                       const CloudCamera& camera, double thin_voxel) {
  Expected<MetricCloud> metric = to_metres(std::move(cloud), camera.unit, file);
  if (!metric) return metric.error();
  ConvertedCloud converted;
  converted.points = metric->points;
  converted.T_cloud_sensor = metric->cloud.T_cloud_sensor;
  if (camera.is_organised) {
    if (auto done = convert_organised(metric->cloud, file, camera, converted); !done) {
      return done.error();
    }
  } else {
    render_rays(metric->cloud, camera, converted);
  }
  if (thin_voxel > 0.0) converted.thinned_cloud = thinned(metric->cloud.points, thin_voxel);
  return converted;
}

}  // namespace pcavr
