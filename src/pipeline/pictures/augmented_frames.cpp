// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/augmented_frames.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/matched_poses.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "augmented_drawing.hpp"

namespace pcavr {
namespace {

/// A pose within this time belongs to the frame [half the format's pairing tolerance].
constexpr Duration kSameImage = std::chrono::milliseconds(10);

struct DrawnBody {
  SurfaceQuery surface;
  Trajectory predicted;
  Trajectory tracked;
};

Trajectory predicted_of(const Replay& replay, std::size_t object) {
  Trajectory predicted;
  if (!replay.teleop) return predicted;
  for (const ShownPose& pose : replay.teleop->shown[object]) {
    predicted.append(Stamp::from_seconds(pose.t), pose.T_base_object);
  }
  return predicted;
}

Trajectory tracked_of(const ReplayedObject& object) {
  Trajectory tracked;
  for (const TrackedPose& pose : object.tracked) {
    tracked.append(Stamp::from_seconds(pose.t), pose.T_base_object);
  }
  return tracked;
}

Expected<CadModel> model_of(const SceneManifest& scene, const std::string& name) {
  const auto entry =
      std::find_if(scene.objects.begin(), scene.objects.end(),
                   [&](const SceneObjectEntry& object) { return object.name == name; });
  PCAVR_REQUIRE(entry != scene.objects.end(), name);
  return read_object_model(scene, *entry);
}

}  // namespace

struct AugmentedFrames::Content {
  Recording recording;
  Trajectory camera;  ///< T_base_camera
  std::vector<DrawnBody> bodies;

  [[nodiscard]] std::optional<Pose> camera_at(std::size_t frame) const {
    const auto nearest = camera.nearest(recording.frames[frame].depth_stamp, kSameImage);
    if (!nearest) return std::nullopt;
    return camera.poses()[*nearest].pose;
  }
  [[nodiscard]] bool is_predicted() const {
    return std::any_of(bodies.begin(), bodies.end(),
                       [](const DrawnBody& body) { return !body.predicted.empty(); });
  }
  void draw(const FrameFiles& files, const Pose& T_base_camera, RgbdFrame& frame,
            Parallelism parallelism) const;
};

void AugmentedFrames::Content::draw(const FrameFiles& files, const Pose& T_base_camera,
                                    RgbdFrame& frame, Parallelism parallelism) const {
  const Pose T_camera_base = T_base_camera.inverse();
  std::vector<BodyInView> predicted;
  std::vector<BodyInView> tracked;
  for (const DrawnBody& body : bodies) {
    if (!body.predicted.empty()) {
      predicted.push_back(
          {&body.surface, T_camera_base * pose_near(body.predicted, files.color_stamp)});
    }
    if (const auto nearest = body.tracked.nearest(files.depth_stamp, kSameImage)) {
      tracked.push_back({&body.surface, T_camera_base * body.tracked.poses()[*nearest].pose});
    }
  }
  if (!is_predicted()) std::swap(predicted, tracked);
  const DepthImage depth =
      depth_on_color(std::move(frame.depth), frame.color.width(), frame.color.height());
  draw_bodies(frame.color, depth, *recording.manifest.camera, predicted, tracked, parallelism);
  draw_legend(frame.color, !predicted.empty(), !tracked.empty());
}

Expected<AugmentedFrames> AugmentedFrames::create(const Recording& recording,
                                                  const SceneManifest& scene,
                                                  const Replay& replay) {
  if (!recording.manifest.camera || recording.frames.empty()) {
    return Error{.message = "the recording has no images to draw over",
                 .file = recording.folder.string(),
                 .hint = "record colour and depth, or omit the augmented images"};
  }
  auto content = std::make_unique<Content>();
  content->recording = recording;
  content->camera = replay.camera_trajectory;
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    const Expected<CadModel> model = model_of(scene, replay.objects[i].name);
    if (!model) return model.error();
    content->bodies.push_back(
        {SurfaceQuery(model->mesh_object), predicted_of(replay, i), tracked_of(replay.objects[i])});
  }
  return AugmentedFrames(std::move(content));
}

AugmentedFrames::AugmentedFrames(std::unique_ptr<const Content> content)
    : content_(std::move(content)) {}
AugmentedFrames::AugmentedFrames(AugmentedFrames&&) noexcept = default;
AugmentedFrames& AugmentedFrames::operator=(AugmentedFrames&&) noexcept = default;
AugmentedFrames::~AugmentedFrames() = default;

std::size_t AugmentedFrames::size() const { return content_->recording.frames.size(); }

std::size_t AugmentedFrames::placed() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < size(); ++i) count += content_->camera_at(i) ? 1 : 0;
  return count;
}

double AugmentedFrames::rate() const {
  std::vector<double> intervals;
  const std::vector<FrameFiles>& frames = content_->recording.frames;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    intervals.push_back(to_seconds(frames[i].color_stamp - frames[i - 1].color_stamp));
  }
  const double interval = median(std::move(intervals));
  return interval > 0.0 ? 1.0 / interval : 1.0;
}

Expected<ColorImage> AugmentedFrames::render(std::size_t index, Parallelism parallelism) const {
  PCAVR_REQUIRE(index < size(), index, size());
  Expected<RgbdFrame> frame = decode_frame(content_->recording, index);
  if (!frame) return frame.error();
  if (const std::optional<Pose> T_base_camera = content_->camera_at(index)) {
    content_->draw(content_->recording.frames[index], *T_base_camera, *frame, parallelism);
  }
  return std::move(frame.value().color);
}

}  // namespace pcavr
