// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/object_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace pcavr {
namespace {

/// Vertices are floats of some decimetres: exact to about a hundredth of a micrometre.
constexpr double kFloatRounding = 2e-8;

Pose rotated_about_z(double angle) {
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
              Eigen::Vector3d::Zero());
}

/// Still for a second, then 10 mm/s along x for a second, then still for another; 100 a second.
Trajectory a_short_push() {
  Trajectory path;
  for (int i = 0; i <= 300; ++i) {
    const double x = 0.01 * std::clamp(0.01 * i - 1.0, 0.0, 1.0);
    path.append(Stamp::from_seconds(0.01 * i), Pose::from_translation({x, 0, 0}));
  }
  return path;
}

std::vector<bool> moving_at(const Trajectory& path, const std::vector<double>& seconds) {
  std::vector<Stamp> stamps;
  for (const double t : seconds) stamps.push_back(Stamp::from_seconds(t));
  return is_moving(path, {}, stamps);
}

TEST(ModelError, OfATranslationIsItsLengthForMeanAndMax) {
  const TriangleMesh box = a_box({0.2F, 0.1F, 0.3F});
  const ModelError error =
      model_error(box.vertices, rotated_about_z(0.7),
                  Pose::from_translation({0, 0.003, 0.004}) * rotated_about_z(0.7));
  EXPECT_NEAR(error.add, 0.005, kFloatRounding);
  EXPECT_NEAR(error.mssd, 0.005, kFloatRounding);
}

TEST(ModelError, OfARotationIsTheChordAtEachVertex) {
  // One vertex on the axis, one at 0.1 m, one at 0.3 m: chords of 2 r sin(angle / 2).
  const std::vector<Eigen::Vector3f> vertices = {{0, 0, 1}, {0.1F, 0, 0}, {0, 0.3F, 0}};
  const double chord = 2.0 * std::sin(0.05);
  const ModelError error = model_error(vertices, Pose(), rotated_about_z(0.1));
  EXPECT_NEAR(error.add, chord * 0.4 / 3.0, kFloatRounding);
  EXPECT_NEAR(error.mssd, chord * 0.3, kFloatRounding);
}

TEST(ModelError, OfASymmetricBodyRotatedOntoItselfIsNotZero) {
  const TriangleMesh cube = a_box({0.1F, 0.1F, 0.1F});
  EXPECT_GT(model_error(cube.vertices, Pose(), rotated_about_z(std::acos(0.0))).add, 0.09);
}

TEST(ObjectErrors, HaveOneRowForEachEstimateWithAReference) {
  const Trajectory truth = a_short_push();
  Trajectory estimate;
  estimate.append(Stamp::from_seconds(-1.0), Pose());
  estimate.append(Stamp::from_seconds(0.505), Pose::from_translation({0, 0, 0.001}));
  estimate.append(Stamp::from_seconds(2.505), Pose::from_translation({0.01, 0.003, 0}));
  const ObjectErrors errors = object_errors(a_box({1, 1, 1}), truth, estimate);
  ASSERT_EQ(errors.poses.size(), 2U);
  EXPECT_NEAR(errors.add.mean, 0.002, kFloatRounding);
  EXPECT_NEAR(errors.mssd.max, 0.003, kFloatRounding);
  EXPECT_EQ(errors.poses[1].stamp, Stamp::from_seconds(2.505));
}

TEST(IsMoving, DistinguishesRestFromMotion) {
  const std::vector<bool> expected = {false, false, true, true, false, false};
  EXPECT_EQ(moving_at(a_short_push(), {0.0, 0.9, 1.1, 1.9, 2.1, 3.0}), expected);
}

TEST(IsMoving, HasHysteresisBetweenItsTwoSpeeds) {
  // Speeds by the second: 0.5, 2, 0.5, 0.1 mm/s. The first 0.5 is rest, the second still motion.
  Trajectory path;
  double x = 0.0;
  path.append(Stamp::from_seconds(0.0), Pose());
  for (int i = 1; i <= 400; ++i) {
    const double speeds[] = {0.5e-3, 2e-3, 0.5e-3, 0.1e-3};
    x += 0.01 * speeds[(i - 1) / 100];
    path.append(Stamp::from_seconds(0.01 * i), Pose::from_translation({x, 0, 0}));
  }
  const std::vector<bool> expected = {false, true, true, false};
  EXPECT_EQ(moving_at(path, {0.5, 1.5, 2.5, 3.5}), expected);
}

TEST(IsMoving, DetectsARotationInPlaceByTheVertices) {
  Trajectory path;
  for (int i = 0; i <= 100; ++i)
    path.append(Stamp::from_seconds(0.01 * i), rotated_about_z(0.001 * i));
  const std::vector<Stamp> stamps = {Stamp::from_seconds(0.5)};
  EXPECT_FALSE(is_moving(path, {}, stamps)[0]);
  EXPECT_TRUE(is_moving(path, a_box({0.1F, 0.1F, 0.1F}).vertices, stamps)[0]);
}

}  // namespace
}  // namespace pcavr
