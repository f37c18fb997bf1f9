// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "follow_objects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/perception/scene/scene.hpp"

#include "prefetcher.hpp"
#include "tool_mask.hpp"

namespace pcavr {
namespace {

/// Rays for all bodies of a frame together, at each iteration of their fits. Up to six bodies get
/// their maximum; more bodies share them.
constexpr int kSamplesPerFrame = 10000;
/// The minimum for each. The noise of neighbouring pixels is correlated over some four pixels in
/// each direction: on a body of 70 x 70 pixels no more than 300 readings are independent.
constexpr int kMinSamplesPerBody = 300;

/// The camera pose's uncertainty, which may appear as object motion. A fixed camera has none.
CameraUncertainty uncertainty_of(const FramePlacement& placement, bool is_fixed_camera) {
  if (is_fixed_camera || !std::isfinite(placement.position_std)) return {};
  return {placement.position_std, placement.rotation_std};
}

/// A body's tracker, and the body's last known pose: initially that of its first detection, because
/// a body rests until it is touched.
struct TrackedBody {
  ObjectTracker tracker;
  std::optional<Pose> T_base_object;
};

std::vector<TrackedBody> start_tracking(const Recording& recording,
                                        const std::vector<DeclaredBody>& bodies,
                                        const Survey& survey, const PerceptionOptions& perception) {
  ObjectTrackerOptions options = object_options(perception);
  options.max_samples = samples_per_body(bodies.size(), options.max_samples);
  std::vector<TrackedBody> all;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::optional<Pose>& seen = survey.T_base_object_first[i];
    TrackedBody body{
        ObjectTracker(bodies[i].model, bodies[i].tags, *recording.manifest.camera, options),
        seen ? seen : bodies[i].entry.T_base_object};
    if (body.T_base_object) body.tracker.set_initial_pose(*body.T_base_object);
    all.push_back(std::move(body));
  }
  return all;
}

}  // namespace

int samples_per_body(std::size_t bodies, int max_samples) {
  const int share = kSamplesPerFrame / std::max(1, static_cast<int>(bodies));
  return std::min(std::max(share, kMinSamplesPerBody), max_samples);
}

const char* evidence_name(ObjectEvidence evidence) {
  switch (evidence) {
    case ObjectEvidence::tags_and_shape:
      return "tags_and_shape";
    case ObjectEvidence::tags:
      return "tags";
    case ObjectEvidence::shape:
      return "shape";
    case ObjectEvidence::none:
      break;
  }
  return kNotSeen;
}

Expected<void> follow_objects(const Recording& recording, const std::vector<DeclaredBody>& bodies,
                              const Survey& survey, const SurveyOptions& options,
                              const Observer& observer,
                              const std::function<void(const FollowedFrame&)>& use,
                              const RecordedArm* arm) {
  const CameraModel& camera = *recording.manifest.camera;
  std::vector<TrackedBody> all = start_tracking(recording, bodies, survey, options.perception);
  FrameReader reader(recording, {.skip_bad = options.skip_bad});
  ToolMask tool(recording, options.perception.masks);
  ArmMask arm_mask(arm, options.perception);
  std::size_t next_placement = 0;

  const auto follow_next = [&]() -> Expected<std::optional<FollowedFrame>> {
    while (true) {
      Expected<std::optional<RgbdFrame>> frame = reader.next();
      if (!frame) return frame.error();
      if (!*frame) return std::optional<FollowedFrame>();
      const FramePlacement& placement = survey.camera.frames[next_placement++];
      if (placement.status != PlacementStatus::placed) continue;
      FollowedFrame followed{.frame = std::move(**frame),
                             .T_base_camera = placement.T_base_camera,
                             .objects = {},
                             .is_dynamic = {}};
      const RgbdFrame& image = followed.frame;
      const CameraModel depth_camera = on_grid(camera, image.depth.width(), image.depth.height());
      followed.is_dynamic = MaskImage(depth_camera.width, depth_camera.height);
      const Pose T_camera_base = followed.T_base_camera.inverse();
      for (TrackedBody& body : all) {
        followed.objects.push_back(
            body.tracker.track(image, survey.detections[image.index], followed.T_base_camera,
                               uncertainty_of(placement, survey.camera.is_fixed_camera)));
        const ObjectObservation& seen = followed.objects.back();
        if (seen.evidence != ObjectEvidence::none) body.T_base_object = seen.T_base_object;
        if (!body.T_base_object) continue;
        mask_body(body.tracker.surface(), T_camera_base * *body.T_base_object, depth_camera,
                  image.depth, options.perception.depth_noise, options.perception.masks.body_margin,
                  followed.is_dynamic);
      }
      arm_mask.mark(image, depth_camera, followed.T_base_camera, followed.is_dynamic);
      tool.mark(image, followed.T_base_camera, followed.is_dynamic);
      return std::optional<FollowedFrame>(std::move(followed));
    }
  };
  const auto is_last = [](const Expected<std::optional<FollowedFrame>>& item) {
    return !item || !*item;
  };

  Prefetcher prefetcher(follow_next, options.parallelism);
  while (true) {
    const Expected<std::optional<FollowedFrame>> followed = prefetcher.take(is_last);
    if (!followed) return followed.error();
    if (!*followed) return {};
    use(**followed);
    observer.on_progress("tracking objects", (*followed)->frame.index + 1, recording.frames.size());
  }
}

}  // namespace pcavr
