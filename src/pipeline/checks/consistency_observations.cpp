// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "consistency_observations.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"

namespace pcavr {
namespace {

/// Depth nearer to the tag's edge [share of its half width] may belong to the background.
constexpr double kInnerShare = 0.8;
/// Rows and columns of a grid of readings inside a tag: more do not improve the fit.
constexpr int kGridSize = 14;
/// Fewer readings than this [a fifth of the grid] do not determine the tag's slope.
constexpr std::size_t kMinReadings = kGridSize * kGridSize / 5;
/// Readings with larger residuals than this are outliers of the first fit [multiples of the median
/// absolute residual, which is two thirds of a normal distribution's std].
constexpr double kMaxResidual = 4.0;
/// Lower bound of the threshold [share of the distance]: no sensor is more precise.
constexpr double kMinRelativeResidual = 1e-4;

/// A reading for a plane's fit. 1/z is linear in the ray (x, y, 1): the fit is linear least
/// squares.
struct DepthReading {
  Eigen::Vector3d ray;
  double inverse_depth = 0.0;  ///< [1/m]
};

std::vector<DepthReading> readings_inside(const DepthImage& depth, const CameraModel& camera,
                                          const std::array<Eigen::Vector2d, 4>& corners) {
  std::vector<DepthReading> readings;
  for (int row = 0; row < kGridSize; ++row) {
    for (int column = 0; column < kGridSize; ++column) {
      const double u = 0.5 + kInnerShare * ((column + 0.5) / kGridSize - 0.5);
      const double v = 0.5 + kInnerShare * ((row + 0.5) / kGridSize - 0.5);
      const Eigen::Vector2d pixel = (1.0 - v) * ((1.0 - u) * corners[0] + u * corners[1]) +
                                    v * ((1.0 - u) * corners[3] + u * corners[2]);
      if (!camera.contains(pixel)) continue;
      const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, depth.width() - 1);
      const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, depth.height() - 1);
      const double z = static_cast<double>(depth(x, y));
      if (!(z > 0.0)) continue;
      readings.push_back({camera.normalise({x, y}).homogeneous(), 1.0 / z});
    }
  }
  return readings;
}

Eigen::Vector3d fit_plane(const std::vector<DepthReading>& readings) {
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const DepthReading& reading : readings) {
    left += reading.ray * reading.ray.transpose();
    right += reading.inverse_depth * reading.ray;
  }
  return left.ldlt().solve(right);
}

/// The inliers of the plane.
std::vector<DepthReading> inliers_of(const std::vector<DepthReading>& readings,
                                     const Eigen::Vector3d& plane) {
  std::vector<double> residuals;
  residuals.reserve(readings.size());
  for (const DepthReading& reading : readings) {
    residuals.push_back(std::abs(reading.ray.dot(plane) - reading.inverse_depth));
  }
  const double threshold = std::max(kMaxResidual * median(residuals),
                                    kMinRelativeResidual * readings.front().inverse_depth);
  std::vector<DepthReading> inliers;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (residuals[i] <= threshold) inliers.push_back(readings[i]);
  }
  return inliers;
}

/// Rays through a body's outline: some hundreds determine a scale to a few per cent.
constexpr double kOutlineRays = 400.0;
/// Tolerance of depth on the body's surface, besides the noise [m]: the pose's error.
constexpr double kOnSurface = 0.01;
/// Outlines of a body that are evaluated: more are redundant.
constexpr std::size_t kOutlineFrames = 12;

/// Readings in a body's outline [pixels with depth].
struct OutlineCounts {
  double outline = 0.0;
  double explained = 0.0;  ///< on the body
  double behind = 0.0;     ///< seen through it

  [[nodiscard]] double score() const { return explained - behind; }
};

/// A body in one depth image.
struct OutlineView {
  const SurfaceQuery& surface_object;
  const CameraModel& camera;
  const DepthImage& depth;
  const DepthNoise& noise;

  /// With the body scaled about its frame's origin.
  [[nodiscard]] OutlineCounts count(const Pose& T_camera_object, double scale) const;
};

OutlineCounts OutlineView::count(const Pose& T_camera_object, double scale) const {
  OutlineCounts counts;
  const Pose T_object_camera = T_camera_object.inverse();
  // Scaling the body is equivalent to scaling the camera's distance inversely.
  const Pose T_scaled_camera(T_object_camera.rotation(), T_object_camera.translation() / scale);
  const PixelRectangle box = visible_rectangle(surface_object.bounds(), camera, T_scaled_camera);
  if (box.empty()) return counts;
  const double pixels =
      static_cast<double>(box.x_end - box.x_begin) * static_cast<double>(box.y_end - box.y_begin);
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kOutlineRays))));
  const double weight = static_cast<double>(stride) * stride;
  const Eigen::Vector3f origin = T_scaled_camera.translation().cast<float>();
  for (int y = box.y_begin + stride / 2; y < box.y_end; y += stride) {
    for (int x = box.x_begin + stride / 2; x < box.x_end; x += stride) {
      const double z = static_cast<double>(depth(x, y));
      if (!(z > 0.0)) continue;
      const Eigen::Vector3d ray = camera.normalise({x, y}).homogeneous();
      const auto hit =
          surface_object.cast(origin, (T_scaled_camera.rotation() * ray).cast<float>());
      if (!hit) continue;
      const double z_body = scale * static_cast<double>(hit->distance) / ray.norm();
      const double tolerance = kOnSurface + 3.0 * noise.depth_std(z_body);
      counts.outline += weight;
      if (std::abs(z - z_body) <= tolerance) {
        counts.explained += weight;
      } else if (z > z_body) {
        counts.behind += weight;
      }
    }
  }
  return counts;
}

/// A body fits where no more than this share of its outline is seen through it: flying pixels at
/// its edges, and half a stride.
constexpr double kMaxBehind = 0.12;
/// Another place is one where it fits, and explains this factor more.
constexpr double kShiftFactor = 1.1;
// Search of another place: steps [m] from the first to the last, and the farthest one.
constexpr double kFirstStep = 0.032;
constexpr double kLastStep = 0.004;
constexpr double kMaxShift = 0.1;

bool is_fitting(const OutlineCounts& counts) {
  return counts.behind <= kMaxBehind * counts.outline;
}

/// Where depth has the body, relative to this pose with its counts, in its own axes: a pattern
/// search over translations [Hooke & Jeeves 1961]. Zero where it fits here, or nowhere near.
Eigen::Vector3d shift_of(const OutlineView& view, const Pose& T_camera_object,
                         const OutlineCounts& given) {
  const auto at = [&](const Eigen::Vector3d& shift) {
    return view.count(T_camera_object * Pose::from_translation(shift), 1.0);
  };
  if (is_fitting(given)) return Eigen::Vector3d::Zero();
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  OutlineCounts best_counts = given;
  for (double step = kFirstStep; step >= kLastStep;) {
    const Eigen::Vector3d from = best;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d shift =
          from + (k % 2 == 0 ? step : -step) * Eigen::Vector3d::Unit(k / 2);
      if (shift.norm() > kMaxShift) continue;
      const OutlineCounts counts = at(shift);
      if (counts.score() > best_counts.score()) best = shift, best_counts = counts;
    }
    if (best == from) step *= 0.5;
  }
  const bool is_decisive =
      is_fitting(best_counts) && best_counts.explained > kShiftFactor * given.explained;
  return is_decisive ? best : Eigen::Vector3d::Zero();
}

}  // namespace

Eigen::Vector3d TagMeasurement::centre_camera() const {
  return 0.25 * (corners_camera[0] + corners_camera[1] + corners_camera[2] + corners_camera[3]);
}

std::optional<TagMeasurement> measure_tag(const DepthImage& depth, const CameraModel& camera,
                                          const TagDetection& detection) {
  if (!std::all_of(detection.corners.begin(), detection.corners.end(),
                   [](const Eigen::Vector2d& corner) { return corner.allFinite(); })) {
    return std::nullopt;
  }
  std::vector<DepthReading> readings = readings_inside(depth, camera, detection.corners);
  if (readings.size() < kMinReadings) return std::nullopt;
  readings = inliers_of(readings, fit_plane(readings));
  if (readings.size() < kMinReadings) return std::nullopt;
  const Eigen::Vector3d plane = fit_plane(readings);
  TagMeasurement tag;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d ray = camera.normalise(detection.corners[i]).homogeneous();
    const double inverse_depth = ray.dot(plane);
    if (!std::isfinite(inverse_depth) || inverse_depth <= 0.0) return std::nullopt;
    tag.corners_camera[i] = ray / inverse_depth;
  }
  return tag;
}

void add_outline(const SurfaceQuery& surface_object, const Pose& T_camera_object,
                 const CameraModel& camera, const DepthImage& depth, const DepthNoise& noise,
                 OutlineFit& fit) {
  const OutlineView view{surface_object, camera, depth, noise};
  for (std::size_t i = 0; i < kOutlineScales.size(); ++i) {
    const OutlineCounts counts = view.count(T_camera_object, kOutlineScales[i]);
    fit.outline[i] += counts.outline;
    fit.explained[i] += counts.explained;
    fit.score[i] += counts.score();
    if (i == kUnscaled) fit.shifts.push_back(shift_of(view, T_camera_object, counts));
  }
  ++fit.frames;
}

Eigen::Vector3d OutlineFit::shift() const {
  Eigen::Vector3d typical = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3 && !shifts.empty(); ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& one : shifts) values.push_back(one[k]);
    typical[k] = median(std::move(values));
  }
  return typical;
}

ConsistencyCollector::ConsistencyCollector(const Manifest& manifest, const DepthNoise& noise,
                                           const std::vector<SurfaceQuery>& surfaces_object,
                                           std::size_t frames)
    : manifest_(manifest),
      noise_(noise),
      surfaces_object_(surfaces_object),
      outline_stride_(std::max<std::size_t>(1, frames / kOutlineFrames)) {
  observations_.outlines.resize(surfaces_object.size());
}

void ConsistencyCollector::add(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                               const std::vector<std::optional<Pose>>& T_camera_body) {
  // All on the depth image's grid, which may be coarser than the colour image's.
  const CameraModel camera = on_grid(*manifest_.camera, frame.depth.width(), frame.depth.height());
  observations_.depth.add(frame.depth, noise_);
  for (std::size_t marker = 0; marker < manifest_.markers.size(); ++marker) {
    for (const TagDetection& detection : detections) {
      if (detection.id != manifest_.markers[marker].id) continue;
      TagDetection on_depth = detection;
      for (Eigen::Vector2d& corner : on_depth.corners) {
        corner = to_grid(corner, *manifest_.camera, camera);
      }
      std::optional<TagMeasurement> tag = measure_tag(frame.depth, camera, on_depth);
      if (!tag) continue;
      tag->frame = frame.index;
      tag->marker = marker;
      observations_.tags.push_back(*tag);
    }
  }
  const bool uses_body_poses = needs_body_poses_next();
  ++frames_seen_;
  if (!uses_body_poses) return;
  for (std::size_t i = 0; i < surfaces_object_.size(); ++i) {
    if (!T_camera_body[i]) continue;
    add_outline(surfaces_object_[i], *T_camera_body[i], camera, frame.depth, noise_,
                observations_.outlines[i]);
  }
}

void ConsistencyCollector::ignore_tags(const std::set<MarkerId>& ids,
                                       const std::vector<std::size_t>& bodies) {
  std::erase_if(observations_.tags, [&](const TagMeasurement& tag) {
    return ids.contains(manifest_.markers[tag.marker].id);
  });
  for (const std::size_t body : bodies) observations_.outlines[body] = {};
}

void DepthSummary::add(const DepthImage& depth, const DepthNoise& noise) {
  constexpr int kStride = 16;  // [px]: a thousand pixels of a usual image
  std::vector<double> readings;
  for (int y = kStride / 2; y < depth.height(); y += kStride) {
    for (int x = kStride / 2; x < depth.width(); x += kStride) {
      ++pixels;
      const double z = static_cast<double>(depth(x, y));
      if (!(z > 0.0)) continue;
      readings.push_back(z);
      if (z >= noise.min_depth && z <= noise.max_depth) ++in_range;
    }
  }
  ++frames;
  measured += readings.size();
  if (!readings.empty()) medians.push_back(median(std::move(readings)));
}

}  // namespace pcavr
