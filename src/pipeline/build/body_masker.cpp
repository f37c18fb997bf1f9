// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "body_masker.hpp"

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

namespace pcavr {

BodyMasker::BodyMasker(const std::vector<DeclaredBody>& bodies, const CameraModel& camera,
                       const PerceptionOptions& options, bool with_masks)
    : bodies_(bodies),
      camera_(camera),
      options_(options),
      with_masks_(with_masks),
      last_poses_(bodies.size()),
      first_detections_(bodies.size()) {
  for (const DeclaredBody& body : bodies) surfaces_.emplace_back(body.model.mesh_object);
}

void BodyMasker::ignore_tags(const std::set<MarkerId>& ids,
                             const std::vector<std::vector<TagDetection>>& seen) {
  for (const std::size_t i : bodies_with_tags(bodies_, ids)) {
    first_detections_[i].reset();
    for (std::size_t frame = 0; frame < seen.size() && !first_detections_[i]; ++frame) {
      const BodyPose body =
          solve_body_pose(bodies_[i].tags, seen[frame], camera_, {}, options_.body_pose);
      if (body.status != BodyPoseStatus::solved) continue;
      first_detections_[i] = {frame, body.pose.T_camera_body};
    }
  }
}

MaskImage BodyMasker::mask(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                           bool needs_poses) {
  if (bodies_.empty()) return {};
  const CameraModel depth_camera = on_grid(camera_, frame.depth.width(), frame.depth.height());
  MaskImage mask;
  if (with_masks_) mask = MaskImage(depth_camera.width, depth_camera.height);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!with_masks_ && !needs_poses && first_detections_[i]) {
      last_poses_[i].reset();
      continue;
    }
    const BodyPoseHints hints{.depth = &frame.depth,
                              .depth_noise = options_.depth_noise,
                              .T_camera_body = last_poses_[i]};
    const BodyPose body =
        solve_body_pose(bodies_[i].tags, detections, camera_, hints, options_.body_pose);
    last_poses_[i].reset();
    if (body.status != BodyPoseStatus::solved) continue;
    last_poses_[i] = body.pose.T_camera_body;
    if (!first_detections_[i]) first_detections_[i] = {frame.index, body.pose.T_camera_body};
    if (!with_masks_) continue;
    mask_body(surfaces_[i], body.pose.T_camera_body, depth_camera, frame.depth,
              options_.depth_noise, options_.masks.first_body_margin, mask);
  }
  return mask;
}

}  // namespace pcavr
