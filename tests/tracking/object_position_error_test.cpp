// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

/// Errors of one object against ground truth, with the camera's pose from ground truth too.
struct Errors {
  std::vector<double> position_at_start;  ///< in the first second [m]
  std::vector<double> rotation_at_start;  ///< [rad]
  double sum_squares = 0.0;               ///< of all position errors
  double max = 0.0;
  int frames = 0;
  int lost = 0;

  void add(double t, const ObjectObservation& observation, const Pose& truth) {
    if (observation.evidence == ObjectEvidence::none) {
      ++lost;
      return;
    }
    const double position = translation_distance(observation.T_base_object, truth);
    if (t < 1.0) {
      position_at_start.push_back(position);
      rotation_at_start.push_back(rotation_distance(observation.T_base_object, truth));
    }
    sum_squares += position * position;
    max = std::max(max, position);
    ++frames;
  }
  [[nodiscard]] double rmse() const { return std::sqrt(sum_squares / frames); }
};

struct TrackedObject {
  std::string name;
  ObjectTracker tracker;
  Trajectory truth;
  Errors errors;
};

/// Tracks every object of a recording; without tags from `tags_until` seconds on.
std::vector<TrackedObject> track_objects(const std::filesystem::path& folder, double tags_until) {
  const Recording recording = read_recording(folder).value();
  const Trajectory T_base_camera = read_trajectory(folder / "truth/camera.txt").value();
  TagDetector detector = TagDetector::create({"tag36h11"}).value();
  std::vector<TrackedObject> all;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    all.push_back({entry.name,
                   ObjectTracker(read_cad_model(folder / entry.mesh, entry.name).value(),
                                 object_placements(recording.manifest, entry.name),
                                 *recording.manifest.camera),
                   read_trajectory(folder / "truth/objects" / (entry.name + ".txt")).value(),
                   {}});
  }
  const Stamp start = recording.frames.front().depth_stamp;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const RgbdFrame frame = decode_frame(recording, i).value();
    const double t = to_seconds(frame.depth_stamp - start);
    std::vector<TagDetection> tags = detector.detect(to_gray(frame.color));
    if (t >= tags_until) tags.clear();
    for (TrackedObject& one : all) {
      const std::optional<Pose> truth = one.truth.at(frame.depth_stamp);
      const std::optional<Pose> camera = T_base_camera.at(frame.depth_stamp);
      if (!truth || !camera) continue;
      one.errors.add(t, one.tracker.track(frame, tags, *camera), *truth);
    }
  }
  return all;
}

void report(const TrackedObject& one) {
  const Errors& e = one.errors;
  ::testing::Test::RecordProperty(one.name + "_rmse_mm", std::to_string(1e3 * e.rmse()));
  std::printf("%s: first second median %.3f mm %.3f deg; rmse %.3f mm, max %.3f mm, lost %d\n",
              one.name.c_str(), 1e3 * median(e.position_at_start),
              57.29578 * median(e.rotation_at_start), 1e3 * e.rmse(), 1e3 * e.max, e.lost);
}

// The project's requirements: 0.5 mm and 0.2 degrees at rest, 0.7 mm over the whole push, which
// include the error of the camera's pose.
TEST(ObjectPositionError, IsBelowHalfAMillimetreOnThePushOfTwoBoxes) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes");
  for (const TrackedObject& one : track_objects(shared_data("push_two_boxes"), 1e9)) {
    report(one);
    EXPECT_LT(median(one.errors.position_at_start), 0.4e-3) << one.name;
    EXPECT_LT(median(one.errors.rotation_at_start), 0.1 / 57.29578) << one.name;
    EXPECT_LT(one.errors.rmse(), 0.3e-3) << one.name;
    EXPECT_EQ(one.errors.lost, 0) << one.name;
  }
}

// The whole push without tags: tracked by the faces and the contour alone.
TEST(ObjectPositionError, IsBelowTwoMillimetresWithoutTags) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes");
  for (const TrackedObject& one : track_objects(shared_data("push_two_boxes"), 0.3)) {
    report(one);
    EXPECT_LT(one.errors.rmse(), 2e-3) << one.name;
    EXPECT_EQ(one.errors.lost, 0) << one.name;
  }
}

TEST(ObjectPositionError, IsBelowHalfAMillimetreFromAHandHeldCamera) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  for (const TrackedObject& one : track_objects(shared_data("tabletop"), 1e9)) {
    report(one);
    EXPECT_LT(one.errors.rmse(), 0.5e-3) << one.name;
  }
}

}  // namespace
}  // namespace pcavr
