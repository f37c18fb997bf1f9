// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The fields of what the steps of a build by tiles write and read, in their order (step_file.hpp).
#pragma once

#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "step_file.hpp"
#include "survey.hpp"
#include "tile_fusion.hpp"

namespace pcavr {

template <>
inline constexpr bool kIsPlain<GridEdge> = true;

template <typename File, Of<Pose> T>
void transfer(File& file, T& pose) {
  Eigen::Vector4d rotation = pose.rotation().coeffs();
  Eigen::Vector3d translation = pose.translation();
  file(rotation);
  file(translation);
  if constexpr (File::kReads) {
    pose = Pose(Eigen::Quaterniond(rotation), translation);
    // The constructor normalises what has been normalised, which may change the last bit.
    const_cast<Eigen::Quaterniond&>(pose.rotation()).coeffs() = rotation;
  }
}

template <typename File, Of<Stamp> T>
void transfer(File& file, T& stamp) {
  file(stamp.nanoseconds);
}

template <typename File, Of<PackedMask> T>
void transfer(File& file, T& mask) {
  int width = mask.width();
  int height = mask.height();
  std::vector<std::uint32_t> runs = mask.runs();
  file(width);
  file(height);
  file(runs);
  if constexpr (File::kReads) {
    const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    if (std::accumulate(runs.begin(), runs.end(), std::uint64_t{0}) != pixels)
      throw std::out_of_range("has a mask of another size");
    mask = PackedMask(width, height, std::move(runs));
  }
}

template <typename File, Of<ObjectObservation> T>
void transfer(File& file, T& seen) {
  file(seen.stamp);
  file(seen.evidence);
  file(seen.T_base_object);
  file(seen.covariance);
  file(seen.tags_used);
  file(seen.refinement_translation);
  file(seen.refinement_rotation);
  file(seen.surface_rms);
  file(seen.inlier_ratio);
  file(seen.is_at_rest);
}

template <typename File, Of<PlacedFrame> T>
void transfer(File& file, T& frame) {
  file(frame.index);
  file(frame.T_base_camera);
  file(frame.objects);
  file(frame.is_dynamic);
  file(frame.reach.T_camera_base);
  file(frame.reach.patch_depths);
}

template <typename File, Of<TileFrames> T>
void transfer(File& file, T& frames) {
  file(frames.recording);
  file(frames.tile_size);
  file(frames.width);
  file(frames.height);
  file(frames.frames);
}

template <typename File, Of<MarkerId> T>
void transfer(File& file, T& id) {
  file(id.family);
  file(id.id);
}

template <typename File, Of<TagDetection> T>
void transfer(File& file, T& tag) {
  file(tag.id);
  file(tag.corners);
  file(tag.hamming);
  file(tag.decision_margin);
  file(tag.corner_std);
}

template <typename File, Of<FramePlacement> T>
void transfer(File& file, T& frame) {
  file(frame.frame);
  file(frame.stamp);
  file(frame.status);
  file(frame.T_base_camera);
  file(frame.position_std);
  file(frame.rotation_std);
  file(frame.base_tags);
  file(frame.segment);
  file(frame.T_segment_camera);
}

template <typename File, Of<CameraTrack> T>
void transfer(File& file, T& track) {
  file(track.frames);
  file(track.is_fixed_camera);
  file(track.tag_reprojection_rms);
  file(track.tag_corners_used);
  file(track.tag_corners_rejected);
  file(track.links_rejected);
  file(track.tracking_rms);
  file(track.failure_reason);
}

template <typename File, Of<DepthSummary> T>
void transfer(File& file, T& depth) {
  file(depth.frames);
  file(depth.pixels);
  file(depth.measured);
  file(depth.in_range);
  file(depth.medians);
}

template <typename File, Of<TagPairCheck> T>
void transfer(File& file, T& pair) {
  file(pair.first);
  file(pair.second);
  file(pair.T_first_second_stated);
  file(pair.T_first_second);
  file(pair.distance_std);
  file(pair.offset);
  file(pair.rotation);
  file(pair.excess);
  file(pair.is_significant);
  file(pair.frames);
}

template <typename File, Of<ConsistencyFinding> T>
void transfer(File& file, T& finding) {
  file(finding.severity);
  file(finding.file);
  file(finding.place);
  file(finding.message);
  file(finding.hint);
  file(finding.factor);
  file(finding.frames);
}

template <typename File, Of<Survey> T>
void transfer(File& file, T& survey) {
  file(survey.detections);
  file(survey.camera);
  file(survey.T_base_object_first);
  file(survey.tags_seen);
  file(survey.copied_tags);
  file(survey.undecoded);
  file(survey.depth);
  file(survey.camera_doubt.position);
  file(survey.camera_doubt.rotation);
  file(survey.pairs);
  file(survey.body_shifts);
  file(survey.findings);
}

template <typename File, Of<TriangleMesh> T>
void transfer(File& file, T& mesh) {
  file(mesh.vertices);
  file(mesh.normals);
  file(mesh.colors);
  file(mesh.triangles);
}

template <typename File, Of<SurfaceTile> T>
void transfer(File& file, T& tile) {
  file(tile.mesh);
  file(tile.borrowed);
  file(tile.lent);
}

template <typename File, Of<PointCloud> T>
void transfer(File& file, T& cloud) {
  file(cloud.points);
  file(cloud.normals);
  file(cloud.colors);
}

template <typename File, Of<FusedTile> T>
void transfer(File& file, T& tile) {
  file(tile.number);
  file(tile.surface);
  file(tile.strict);
  file(tile.points);
}

template <typename File, Of<TilePart> T>
void transfer(File& file, T& part) {
  file(part.number);
  file(part.count);
}

}  // namespace pcavr
