// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "widen_stds.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "pcavr/base/core/median.hpp"

#include "follow_objects.hpp"

namespace pcavr {
namespace {

void widen(double position, double rotation, SceneObject& object) {
  object.position_std = std::hypot(object.position_std, position);
  object.rotation_std = std::hypot(object.rotation_std, rotation);
}

/// Median distance of the camera from the object [m].
double view_distance(const Trajectory& camera, const SceneObject& object) {
  std::vector<double> distances;
  for (const TimedPose& view : camera.poses()) {
    distances.push_back(translation_distance(view.pose, object.T_base_object));
  }
  return median(std::move(distances));
}

}  // namespace

void widen_by_doubts(const Manifest& manifest, const Survey& survey, std::size_t body,
                     const Trajectory& camera, SceneObject& object) {
  if (object.evidence == kNotSeen || object.evidence == kByManifest) return;
  widen(survey.camera_doubt.position, survey.camera_doubt.rotation, object);
  widen(survey.body_shifts[body], 0.0, object);
  const LayoutDoubt tags = layout_doubt(manifest, survey.pairs, object.model.name);
  widen(tags.offset, tags.rotation, object);
  // Where depth does not correct it, a body whose tags disagree is off along the line of sight.
  if (object.evidence == evidence_name(ObjectEvidence::tags)) {
    widen(tags.rotation * view_distance(camera, object), 0.0, object);
  }
}

}  // namespace pcavr
