// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>

#include "pipeline/consistency_case.hpp"

namespace pcavr {
namespace {

/// Four base tags around the table of a_consistency_case, as a camera with an error measures them:
/// `seen` are the normalised coordinates that its file makes of the true ones.
ConsistencyCase four_base_tags(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& seen) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers = {a_tag(0, 0.12, Pose::from_translation({0.7, 0.35, 0.0})),
                           a_tag(1, 0.12, Pose::from_translation({0.4, -0.35, 0.0})),
                           a_tag(2, 0.12, Pose::from_translation({0.9, -0.2, 0.0})),
                           a_tag(3, 0.12, Pose::from_translation({0.35, 0.1, 0.0}))};
  made.tags.clear();
  Random random(5);
  for (const TimedPose& camera : made.camera.poses()) {
    const auto frame = static_cast<std::size_t>(&camera - made.camera.poses().data());
    for (std::size_t m = 0; m < made.manifest.markers.size(); ++m) {
      const MarkerEntry& marker = made.manifest.markers[m];
      TagMeasurement tag{.frame = frame, .marker = m, .corners_camera = tag_corners(marker.size)};
      for (Eigen::Vector3d& corner : tag.corners_camera) {
        const Eigen::Vector3d p = camera.pose.inverse() * marker.T_parent_marker * corner;
        corner = p.z() * seen(p.head<2>() / p.z()).homogeneous();
        for (double& coordinate : corner) coordinate += 1e-3 * random.normal();
      }
      made.tags.push_back(tag);
    }
  }
  return made;
}

std::optional<ConsistencyFinding> check(const ConsistencyCase& made) {
  return check_principal_point(made.manifest, made.tags, kMinFindingFrames);
}

TEST(ConsistencyOfTheCamera, FindsNothingWhereInputsAgree) {
  const auto found = check(four_base_tags([](const Eigen::Vector2d& ray) { return ray; }));
  EXPECT_FALSE(found) << found->to_string();
}

TEST(ConsistencyOfTheCamera, NamesAPrincipalPointThatIsOff) {
  constexpr double kOff = 40.0;  // [px]
  const auto found = check(four_base_tags(
      [](const Eigen::Vector2d& ray) { return Eigen::Vector2d(ray.x() - kOff / 525.0, ray.y()); }));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->place, "camera.cx, camera.cy");
  EXPECT_EQ(found->severity, FindingSeverity::contradiction);
  // 319.5 px are given; the images were taken with 40 px less.
  const std::size_t at = found->message.find(" with ");
  ASSERT_NE(at, std::string::npos) << found->message;
  double cx = 0.0, cy = 0.0;
  ASSERT_EQ(std::sscanf(found->message.c_str() + at, " with %lf and %lf px", &cx, &cy), 2);
  EXPECT_NEAR(cx, 319.5 - kOff, 3.0);
  EXPECT_NEAR(cy, 239.5, 3.0);
}

TEST(ConsistencyOfTheCamera, NamesADistortionThatIsMissing) {
  const auto found = check(four_base_tags(
      [](const Eigen::Vector2d& ray) { return ray * (1.0 - 0.25 * ray.squaredNorm()); }));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->place, "camera.distortion") << found->message;
}

TEST(ConsistencyOfTheCamera, IsNotBlamedForATagInAnotherPlace) {
  for (std::size_t marker = 0; marker < 4; ++marker) {
    ConsistencyCase made = four_base_tags([](const Eigen::Vector2d& ray) { return ray; });
    Pose& pose = made.manifest.markers[marker].T_parent_marker;
    pose = Pose::from_translation({0.01, -0.015, 0.005}) * pose;
    const auto found = check(made);
    EXPECT_FALSE(found) << found->to_string();
  }
}

/// Makes the camera stand still: all frames are the first.
void stand_still(ConsistencyCase& made) {
  const std::size_t count = made.manifest.markers.size();
  for (std::size_t i = count; i < made.tags.size(); ++i) {
    made.tags[i].corners_camera = made.tags[i % count].corners_camera;
  }
}

TEST(ConsistencyOfTheCamera, TwoTagsShowItToACameraThatMoves) {
  ConsistencyCase made = four_base_tags(
      [](const Eigen::Vector2d& ray) { return Eigen::Vector2d(ray.x() - 0.08, ray.y()); });
  made.manifest.markers.resize(2);
  std::erase_if(made.tags, [](const TagMeasurement& tag) { return tag.marker > 1; });
  EXPECT_TRUE(check(made));
  stand_still(made);
  EXPECT_FALSE(check(made));
  const auto unchecked = unchecked_camera(made.manifest);
  ASSERT_TRUE(unchecked);
  EXPECT_NE(unchecked->find("19 mm at 1 m"), std::string::npos) << *unchecked;
}

TEST(ConsistencyOfTheCamera, NamesTheTagsToACameraThatStandsStill) {
  ConsistencyCase made = four_base_tags(
      [](const Eigen::Vector2d& ray) { return Eigen::Vector2d(ray.x() - 0.08, ray.y()); });
  stand_still(made);
  const auto found = check(made);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->severity, FindingSeverity::warning);
  EXPECT_NE(found->hint.find("poses of the base markers"), std::string::npos) << found->hint;
}

/// A table seen from 0.8 m: at a fifth of its size the tracked camera moves by 16 mm where it moved
/// by 80.
TEST(ConsistencyOfDepth, NamesAScaleThatIsFarTooSmall) {
  for (const double scale : {0.5, 0.2, 0.1}) {
    ConsistencyCase made = a_consistency_case();
    for (FramePlacement& frame : made.track.frames) {
      frame.T_segment_camera =
          Pose(frame.T_segment_camera.rotation(), scale * frame.T_segment_camera.translation());
    }
    const auto ratio = motion_ratio(made.track, made.camera);
    ASSERT_TRUE(ratio) << scale;
    EXPECT_NEAR(ratio->by_depth / ratio->stated, scale, 0.01);
  }
}

}  // namespace
}  // namespace pcavr
