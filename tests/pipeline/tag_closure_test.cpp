// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Base tags where image, depth and the camera's poses put them, and what the camera's stds say.
#include "pipeline/checks/tag_closure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/consistency_case.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kViews = 10;
constexpr double kPositionStd = 0.002;  // [m] as stated

/// A base tag that a camera passes. The poses are off by `error`, and depth by a factor.
struct ClosureCase {
  Manifest manifest;
  std::vector<TagMeasurement> measurements;
  CameraTrack track;
};

ClosureCase a_case(const Eigen::Vector3d& error, double depth_factor) {
  ClosureCase made;
  made.manifest.markers = {a_tag(0, 0.12, Pose::from_translation({0.3, 0.1, 0.0}))};
  const MarkerEntry& marker = made.manifest.markers[0];
  for (std::size_t i = 0; i < kViews; ++i) {
    const double angle = 0.1 * static_cast<double>(i);
    const Pose T_base_camera =
        looking_at({0.3 + std::cos(angle), std::sin(angle), 0.8}, {0.3, 0.1, 0.0});
    TagMeasurement tag{.frame = i, .marker = 0, .corners_camera = {}};
    const auto corners = tag_corners(marker.size);
    for (std::size_t k = 0; k < 4; ++k) {
      tag.corners_camera[k] =
          depth_factor * (T_base_camera.inverse() * (marker.T_parent_marker * corners[k]));
    }
    made.measurements.push_back(tag);
    FramePlacement frame;
    frame.frame = i;
    frame.status = PlacementStatus::placed;
    frame.T_base_camera = Pose(T_base_camera.rotation(), T_base_camera.translation() + error);
    frame.position_std = kPositionStd;
    frame.rotation_std = 0.001;
    made.track.frames.push_back(frame);
  }
  return made;
}

std::optional<TagClosure> closure_of(const ClosureCase& made) {
  return close_tags(made.manifest, made.measurements, made.track, DepthNoise{}, 3);
}

TEST(TagClosure, IsUsualWhereDepthIsOffByAPerCent) {
  const ClosureCase made = a_case({0.001, -0.001, 0.0}, 1.01);
  const auto closure = closure_of(made);
  ASSERT_TRUE(closure.has_value());
  EXPECT_FALSE(closure->is_significant()) << closure->offset << " of " << closure->expected;
  EXPECT_LT(doubt_of(*closure, {}).position, 0.002);
  ConsistencyFinding lens;
  lens.place = "camera.cx, camera.cy";
  lens.factor = 1.04;
  const double doubt = std::hypot(closure->doubted(), 0.04 * closure->distance);
  EXPECT_NEAR(doubt_of(*closure, {lens}).position, doubt, 1e-9);
  EXPECT_NEAR(doubt_of(*closure, {lens}).rotation, doubt / closure->distance, 1e-9);
}

TEST(TagClosure, PutsIntoTheStdsWhatThePosesLeaveOpen) {
  for (const double off : {0.03, 0.06, 0.2}) {
    const ClosureCase made = a_case({0.0, off, 0.0}, 1.0);
    const auto closure = closure_of(made);
    ASSERT_TRUE(closure && closure->is_significant()) << off;
    EXPECT_NEAR(closure->offset, off, 1e-9);
    EXPECT_EQ(finding_of(*closure).severity, FindingSeverity::warning);
    CameraTrack track = made.track;
    widen_by(doubt_of(*closure, {}), track);
    EXPECT_LT(off, 2.0 * track.frames[0].position_std);
    EXPECT_GT(track.frames[0].rotation_std, made.track.frames[0].rotation_std);
  }
}

TEST(TagClosure, OfHardlyUsualSizeIsDoubtedInPart) {
  const auto usual = closure_of(a_case({0.001, -0.001, 0.0}, 1.01));
  ASSERT_TRUE(usual.has_value());
  TagClosure closure = *usual;
  closure.offset = 2.25 * closure.expected;
  EXPECT_FALSE(closure.is_significant());
  EXPECT_NEAR(doubt_of(closure, {}).position, 0.5 * closure.offset, 1e-12);
}

TEST(TagClosure, ContradictsWhereTheSceneWouldBeElsewhere) {
  const auto closure = closure_of(a_case(Eigen::Vector3d::Zero(), 1.4));
  ASSERT_TRUE(closure && closure->is_significant());
  EXPECT_EQ(finding_of(*closure).severity, FindingSeverity::contradiction);
}

TEST(TagClosure, NeedsPlacedFramesWithBaseTags) {
  ClosureCase made = a_case({0.1, 0.0, 0.0}, 1.0);
  for (std::size_t i = 2; i < kViews; ++i) {
    made.track.frames[i].status = PlacementStatus::not_anchored;
  }
  EXPECT_FALSE(closure_of(made).has_value());
  made = a_case({0.1, 0.0, 0.0}, 1.0);
  made.manifest.markers[0].role = MarkerRole::object;
  EXPECT_FALSE(closure_of(made).has_value());
}

}  // namespace
}  // namespace pcavr
