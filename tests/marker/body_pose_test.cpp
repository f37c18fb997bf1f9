// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/body_pose.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "marker/tag_rendering.hpp"

namespace pcavr {
namespace {

using test::a_camera;
using test::facing;

constexpr double kCornerStd = 0.1;  // [px]

TagPlacement a_placement(int id, double size, const Pose& T_body_marker) {
  return {{"tag36h11", id}, size, T_body_marker};
}

/// Three tags on three sides of a box.
std::vector<TagPlacement> a_box() {
  const Eigen::AngleAxisd quarter(M_PI / 2, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd side(M_PI / 2, Eigen::Vector3d::UnitY());
  return {a_placement(0, 0.08, Pose::from_translation({0, 0, 0.06})),
          a_placement(1, 0.06, Pose(Eigen::Quaterniond(quarter), {0, -0.08, 0})),
          a_placement(2, 0.06, Pose(Eigen::Quaterniond(side), {0.08, 0, 0}))};
}

BodyPoseOptions with_stds(double corner_std, double model_std) {
  BodyPoseOptions options;
  options.corner_std = corner_std;
  options.model_std = model_std;
  return options;
}

std::vector<TagDetection> detect(const std::vector<TagPlacement>& placements,
                                 const Pose& T_camera_body, const CameraModel& camera,
                                 double corner_std, Random& random) {
  std::vector<TagDetection> detections;
  for (const TagPlacement& placement : placements) {
    TagDetection detection;
    detection.id = placement.id;
    detection.corner_std = corner_std;
    const auto corners = tag_corners(placement.size);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p_camera = T_camera_body * (placement.T_body_marker * corners[i]);
      const Eigen::Vector2d noise(random.normal(), random.normal());
      detection.corners[i] = camera.project(p_camera) + corner_std * noise;
    }
    detections.push_back(detection);
  }
  return detections;
}

/// Depth image of a tag's plane from a depth camera with this bias and independent noise.
DepthImage plane_depth(const Pose& T_camera_marker, const CameraModel& camera, double bias,
                       Random& random) {
  DepthImage depth(camera.width, camera.height);
  const Eigen::Vector3d normal = T_camera_marker.rotation() * Eigen::Vector3d::UnitZ();
  const double distance = normal.dot(T_camera_marker.translation());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d at = camera.normalise({x, y});
      const double z = distance / normal.dot(Eigen::Vector3d(at.x(), at.y(), 1.0));
      if (z < 0.3 || z > 5.0) continue;
      depth(x, y) = static_cast<float>(z + bias + DepthNoise{}.depth_std(z) * random.normal());
    }
  }
  return depth;
}

Pose a_box_pose() {
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(-0.7, Eigen::Vector3d(1, 0.6, 0).normalized()));
  return Pose(tilted, {0.05, -0.03, 0.8});
}

TEST(SolveBodyPose, IsExactForExactCornersWithLensDistortion) {
  const CameraModel camera = a_camera(-0.2);
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose truth =
        facing({random.uniform(-0.2, 0.2), random.uniform(-0.1, 0.1), 0.6},
               random.uniform(0.1, 1.2), random.uniform(0, 6.3), random.uniform(0, 6.3));
    const std::vector<TagPlacement> one{a_placement(3, 0.1, Pose())};
    auto detections = detect(one, truth, camera, 0.0, random);
    detections[0].corner_std = 1e-3;
    const BodyPose found = solve_body_pose(one, detections, camera, {}, with_stds(1e-3, 0.0));
    ASSERT_EQ(found.status, BodyPoseStatus::solved) << i;
    EXPECT_LT(translation_distance(found.pose.T_camera_body, truth), 1e-6) << i;
    EXPECT_LT(rotation_distance(found.pose.T_camera_body, truth), 1e-5) << i;
    EXPECT_EQ(found.tags_used, 1);
  }
}

TEST(SolveBodyPose, ComputesAConsistentCovariance) {
  const CameraModel camera = a_camera(-0.1);
  Random random(2);
  double sum = 0.0;
  const int count = 300;
  for (int i = 0; i < count; ++i) {
    const auto detections = detect(a_box(), a_box_pose(), camera, kCornerStd, random);
    const BodyPose found = solve_body_pose(a_box(), detections, camera, {}, with_stds(0.15, 0.0));
    ASSERT_EQ(found.status, BodyPoseStatus::solved);
    ASSERT_EQ(found.tags_used, 3);
    const Vector6d error = (a_box_pose().inverse() * found.pose.T_camera_body).log();
    sum += error.dot(found.covariance.ldlt().solve(error));
  }
  // The mean of chi-square with 6 degrees is 6, that of 300 draws 6 +- 0.2; scaling by each draw's
  // own residuals (never down) lowers it to about 5.3.
  EXPECT_GT(sum / count, 4.5);
  EXPECT_LT(sum / count, 6.6);
}

TEST(SolveBodyPose, RejectsAnOutlierTag) {
  const CameraModel camera = a_camera();
  Random random(3);
  auto detections = detect(a_box(), a_box_pose(), camera, kCornerStd, random);
  for (Eigen::Vector2d& corner : detections[2].corners) corner.x() += 25.0;
  const BodyPose found = solve_body_pose(a_box(), detections, camera);
  EXPECT_EQ(found.status, BodyPoseStatus::solved);
  EXPECT_EQ(found.tags_used, 2);
  EXPECT_EQ(found.tags_rejected, 1);
  EXPECT_LT(translation_distance(found.pose.T_camera_body, a_box_pose()), 0.003);
}

/// Results of resolving the planar ambiguity of distant, small tags.
TEST(SolveBodyPose, TrustsATagTheLessTheLessCertainItsPlaceIs) {
  const CameraModel camera = a_camera();
  const Pose T_camera_body = a_box_pose();
  Random random(4);
  std::vector<TagPlacement> placements = a_box();
  const auto detections = detect(placements, T_camera_body, camera, 0.02, random);
  placements[0].T_body_marker = placements[0].T_body_marker * Pose::from_translation({2e-3, 0, 0});
  const auto error = [&] {
    const BodyPose found =
        solve_body_pose(placements, detections, camera, {}, with_stds(0.02, 0.02));
    EXPECT_EQ(found.status, BodyPoseStatus::solved);
    return (found.pose.T_camera_body.translation() - T_camera_body.translation()).norm();
  };
  const double alike = error();
  placements[0].covariance.topLeftCorner<3, 3>() = 4e-6 * Eigen::Matrix3d::Identity();
  EXPECT_LT(error(), 0.4 * alike);
}

struct FlipCount {
  int wrong = 0;  ///< solved, but with the wrong solution
  int ambiguous = 0;
  double range_error = 0.0;  ///< [m], root mean square over correct solutions
};

template <typename MakeHints>
FlipCount count_flips(int count, MakeHints&& make_hints) {
  const CameraModel camera = a_camera();
  const std::vector<TagPlacement> one{a_placement(0, 0.08, Pose())};
  Random random(4);
  FlipCount flips;
  int right = 0;
  for (int i = 0; i < count; ++i) {
    const Pose truth =
        facing({random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), random.uniform(0.5, 2.0)},
               random.uniform(0.0, 1.2), random.uniform(0, 6.3), random.uniform(0, 6.3));
    const auto detections = detect(one, truth, camera, kCornerStd, random);
    DepthImage depth;
    const BodyPose found =
        solve_body_pose(one, detections, camera, make_hints(truth, camera, random, depth));
    const Pose& pose = found.pose.T_camera_body;
    if (found.status == BodyPoseStatus::ambiguous) {
      ++flips.ambiguous;
    } else if (rotation_distance(pose, truth) > 0.3) {  // the other planar solution, not noise
      ++flips.wrong;
    } else {
      ++right;
      const double error = pose.translation().norm() - truth.translation().norm();
      flips.range_error += error * error;
    }
  }
  flips.range_error = std::sqrt(flips.range_error / std::max(1, right));
  return flips;
}

TEST(SolveBodyPose, ReportsPlanarAmbiguityFromCornersAlone) {
  const FlipCount flips = count_flips(
      300, [](const Pose&, const CameraModel&, Random&, DepthImage&) { return BodyPoseHints{}; });
  RecordProperty("ambiguous", flips.ambiguous);
  EXPECT_LE(flips.wrong, 1);  // the threshold is a likelihood ratio of 1000
  EXPECT_GT(flips.ambiguous, 30);
}

TEST(SolveBodyPose, ResolvesTheAmbiguityByDepthInsideTheTag) {
  const FlipCount flips = count_flips(
      60, [](const Pose& truth, const CameraModel& camera, Random& random, DepthImage& depth) {
        depth = plane_depth(truth, camera, 0.0, random);
        BodyPoseHints hints;
        hints.depth = &depth;
        return hints;
      });
  RecordProperty("ambiguous", flips.ambiguous);
  RecordProperty("range_error_mm", std::to_string(1e3 * flips.range_error));
  EXPECT_EQ(flips.wrong, 0);
  EXPECT_LE(flips.ambiguous, 20);
  EXPECT_LT(flips.range_error, 0.005);  // [m]; corners alone: 2 m * 0.1 px / 20 px = 10 mm
}

TEST(SolveBodyPose, ResolvesTheAmbiguityByContinuity) {
  const FlipCount flips =
      count_flips(300, [](const Pose& truth, const CameraModel&, Random& random, DepthImage&) {
        Vector6d moved;
        for (int i = 0; i < 6; ++i) moved(i) = 0.03 * random.normal();
        BodyPoseHints hints;
        hints.T_camera_body = truth * Pose::exp(moved);
        return hints;
      });
  EXPECT_LE(flips.wrong, 1);
}

TEST(SolveBodyPose, IsNotBiasedByABiasedDepthCamera) {
  const CameraModel camera = a_camera();
  Random random(5);
  const std::vector<TagPlacement> board{
      a_placement(0, 0.1, Pose::from_translation({-0.2, -0.15, 0})),
      a_placement(1, 0.1, Pose::from_translation({0.2, -0.15, 0})),
      a_placement(2, 0.1, Pose::from_translation({0.2, 0.15, 0})),
      a_placement(3, 0.1, Pose::from_translation({-0.2, 0.15, 0}))};
  const Pose truth = facing({0, 0, 1.0}, 0.5, 0.3, 0.2);
  const auto detections = detect(board, truth, camera, 0.03, random);
  const DepthImage depth = plane_depth(truth, camera, 0.010, random);  // 1 % of the range
  BodyPoseHints hints;
  hints.depth = &depth;
  const BodyPose found = solve_body_pose(board, detections, camera, hints);
  EXPECT_EQ(found.status, BodyPoseStatus::solved);
  EXPECT_LT(translation_distance(found.pose.T_camera_body, truth), 0.001);
}

TEST(SolveBodyPose, ReportsMissingAndInvalidDetections) {
  const CameraModel camera = a_camera();
  Random random(6);
  EXPECT_EQ(solve_body_pose(a_box(), {}, camera).status, BodyPoseStatus::not_seen);
  EXPECT_EQ(solve_body_pose({}, detect(a_box(), a_box_pose(), camera, 0, random), camera).status,
            BodyPoseStatus::not_seen);
  TagDetection point;
  point.id = {"tag36h11", 0};
  point.corners.fill({100, 100});
  EXPECT_EQ(solve_body_pose(a_box(), {point}, camera).status, BodyPoseStatus::failed);
  point.corners.fill({std::nan(""), 100});
  EXPECT_EQ(solve_body_pose(a_box(), {point}, camera).status, BodyPoseStatus::not_seen);
  // Seen from behind, the corners have the opposite orientation: not a valid tag.
  auto mirrored = detect({a_box()[0]}, a_box_pose(), camera, 0, random);
  std::swap(mirrored[0].corners[1], mirrored[0].corners[3]);
  EXPECT_EQ(solve_body_pose(a_box(), mirrored, camera).status, BodyPoseStatus::failed);
}

TEST(SolveBodyPose, DoesNotDependOnTheOrderOfPlacements) {
  const CameraModel camera = a_camera();
  Random random(7);
  const auto detections = detect(a_box(), a_box_pose(), camera, kCornerStd, random);
  std::vector<TagPlacement> reversed = a_box();
  std::reverse(reversed.begin(), reversed.end());
  const BodyPose one = solve_body_pose(a_box(), detections, camera);
  const BodyPose other = solve_body_pose(reversed, detections, camera);
  EXPECT_EQ(one.pose.T_camera_body.translation(), other.pose.T_camera_body.translation());
}

TEST(SolveBodyPose, RejectsAZeroStandardDeviation) {
  EXPECT_THROW((void)solve_body_pose(a_box(), {}, a_camera(), {}, with_stds(0.0, 0.03)),
               ContractError);
}

}  // namespace
}  // namespace pcavr
