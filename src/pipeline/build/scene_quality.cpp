// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_quality.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {
namespace {

// Some ten thousand readings in all determine a median.
constexpr std::size_t kComparedFrames = 8;
constexpr int kPixelStride = 8;  ///< of the pixels that are compared with the mesh

/// Distances of a frame's readings from the mesh, along the mesh's normals [m].
void collect_distances(const SurfaceQuery& surface, const RgbdFrame& frame,
                       const CameraModel& color_camera, const Pose& T_base_camera,
                       double max_distance, std::vector<double>& distances) {
  const CameraModel camera = on_grid(color_camera, frame.depth.width(), frame.depth.height());
  for (int y = 0; y < camera.height; y += kPixelStride) {
    for (int x = 0; x < camera.width; x += kPixelStride) {
      const float z = frame.depth(x, y);
      if (z <= 0.0F) continue;
      const Eigen::Vector3f p_base =
          (T_base_camera * camera.unproject(Eigen::Vector2d(x, y), z)).cast<float>();
      const auto nearest = surface.closest(p_base, static_cast<float>(max_distance));
      if (nearest) distances.push_back(std::abs(nearest->normal.dot(p_base - nearest->point)));
    }
  }
}

/// Median distance of some frames' readings from the mesh that they were fused into [m].
double surface_distance(const Recording& recording, const Survey& survey, const Scene& scene,
                        double max_distance) {
  const SurfaceQuery surface(scene.mesh_base);
  const std::vector<FramePlacement>& frames = survey.camera.frames;
  const std::size_t stride = std::max<std::size_t>(1, frames.size() / kComparedFrames);
  std::vector<double> distances;
  for (std::size_t i = stride / 2; i < frames.size(); i += stride) {
    if (frames[i].status != PlacementStatus::placed) continue;
    const Expected<RgbdFrame> frame = decode_frame(recording, frames[i].frame);
    if (!frame) continue;
    collect_distances(surface, *frame, *recording.manifest.camera, frames[i].T_base_camera,
                      max_distance, distances);
  }
  return median(distances);
}

}  // namespace

InputWarning to_warning(const ConsistencyFinding& finding) {
  return {finding.input(), finding.message + "; " + finding.hint, finding.factor, finding.frames};
}

SceneQuality assess_quality(const Recording& recording, const Survey& survey, const Scene& scene,
                            double max_distance) {
  SceneQuality quality;
  quality.frames_recorded = recording.frames.size() + recording.unpaired_color;
  quality.frames_used = scene.camera_trajectory.size();
  quality.frames_dropped = dropped_frames(recording, survey);
  quality.left_out = recording.left_out;
  for (const MarkerEntry& marker : recording.manifest.markers) {
    const auto seen = survey.tags_seen.find(marker.id);
    quality.tags_seen.emplace_back(marker.id.to_string(),
                                   seen == survey.tags_seen.end() ? 0 : seen->second);
  }
  if (survey.camera.tag_corners_used > 0) {
    quality.tag_reprojection_rms = survey.camera.tag_reprojection_rms;
  }
  quality.tracking_rms = survey.camera.tracking_rms;
  quality.is_fixed_camera = survey.camera.is_fixed_camera;
  std::vector<double> position_stds;
  std::vector<double> rotation_stds;
  for (const FramePlacement& frame : survey.camera.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    position_stds.push_back(frame.position_std);
    rotation_stds.push_back(frame.rotation_std);
  }
  quality.camera_position_std = median(position_stds);
  quality.camera_rotation_std = median(rotation_stds);
  if (quality.frames_used > 0 && !scene.mesh_base.triangles.empty()) {
    quality.surface_rms = surface_distance(recording, survey, scene, max_distance);
  }
  for (const ConsistencyFinding& finding : survey.findings) {
    quality.input_warnings.push_back(to_warning(finding));
  }
  return quality;
}

}  // namespace pcavr
