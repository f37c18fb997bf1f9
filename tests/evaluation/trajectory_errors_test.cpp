// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// Rounding of sums of doubles of order one, and of their square roots.
constexpr double kRounding = 1e-12;
/// Angles come from unit quaternions: an angle near 0 has about half of the digits.
constexpr double kAngleRounding = 1e-7;

Stamp at_second(double seconds) { return Stamp::from_seconds(seconds); }

Pose rotated_about_z(double angle, const Eigen::Vector3d& p) {
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())), p);
}

/// A helical path that spans all directions, 10 poses a second.
Trajectory a_winding_path(std::size_t count = 51) {
  Trajectory path;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    path.append(at_second(t), rotated_about_z(0.3 * t, {std::cos(t), std::sin(t), 0.1 * t * t}));
  }
  return path;
}

template <typename Change>
Trajectory changed(const Trajectory& trajectory, Change change) {
  Trajectory result;
  for (const TimedPose& timed : trajectory.poses()) {
    result.append(timed.stamp, change(to_seconds(timed.stamp - Stamp{}), timed.pose));
  }
  return result;
}

TEST(Statistics, AgreeWithValuesComputedByHand) {
  const ErrorStatistics stats = statistics({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(stats.count, 4U);
  EXPECT_DOUBLE_EQ(stats.sse, 30.0);
  EXPECT_DOUBLE_EQ(stats.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(stats.mean, 2.5);
  EXPECT_DOUBLE_EQ(stats.median, 2.5);
  EXPECT_DOUBLE_EQ(stats.std, std::sqrt(1.25));  // of the population, as numpy.std
  EXPECT_DOUBLE_EQ(stats.min, 1.0);
  EXPECT_DOUBLE_EQ(stats.max, 4.0);
  EXPECT_DOUBLE_EQ(stats.p95, 3.85);  // 1 + 0.95 * 3, as numpy.percentile
}

TEST(Statistics, OfAnOddCountHaveTheMiddleValueAsMedian) {
  EXPECT_DOUBLE_EQ(statistics({7.0, 1.0, 2.0}).median, 2.0);
}

TEST(Statistics, OfNoErrorsAreZero) {
  const ErrorStatistics stats = statistics({});
  EXPECT_EQ(stats.count, 0U);
  EXPECT_EQ(stats.rmse, 0.0);
}

TEST(TrajectoryErrors, OfATrajectoryAgainstItselfAreZero) {
  const Trajectory path = a_winding_path();
  const TrajectoryErrors errors = trajectory_errors(path, path);
  ASSERT_EQ(errors.absolute.size(), path.size());
  ASSERT_EQ(errors.absolute_aligned.size(), path.size());
  EXPECT_EQ(errors.unmatched, 0U);
  for (const auto* list : {&errors.absolute, &errors.absolute_aligned, &errors.relative}) {
    EXPECT_LT(statistics(translations(*list)).max, kRounding);
    EXPECT_LT(statistics(rotations(*list)).max, kAngleRounding);
  }
}

TEST(TrajectoryErrors, OfAConstantOffsetAreThatOffset) {
  const Trajectory truth = a_winding_path();
  const Trajectory estimate = changed(truth, [](double, const Pose& pose) {
    return Pose(pose.rotation(), pose.translation() + Eigen::Vector3d(0.003, 0.0, 0.004));
  });
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  const ErrorStatistics stats = statistics(translations(errors.absolute));
  EXPECT_NEAR(stats.rmse, 0.005, kRounding);
  EXPECT_NEAR(stats.std, 0.0, kRounding);
  EXPECT_NEAR(stats.sse, 51 * 25e-6, kRounding);
  EXPECT_LT(statistics(translations(errors.absolute_aligned)).max, kRounding);
}

TEST(TrajectoryErrors, OfAConstantRotationAreItsAngle) {
  const Trajectory truth = a_winding_path();
  const Pose rotation(Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 2) / 3.0)),
                      Eigen::Vector3d::Zero());
  const Trajectory estimate =
      changed(truth, [&](double, const Pose& pose) { return pose * rotation; });
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  EXPECT_NEAR(statistics(rotations(errors.absolute)).rmse, 0.02, kRounding);
  EXPECT_LT(statistics(translations(errors.absolute)).max, kRounding);
}

TEST(TrajectoryErrors, AlignmentRecoversARigidMotion) {
  const Trajectory truth = a_winding_path();
  const Pose T_truth_estimate(
      Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(2, -1, 2) / 3.0)), {3, -2, 1});
  const Trajectory estimate =
      changed(truth, [&](double, const Pose& pose) { return T_truth_estimate.inverse() * pose; });
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  ASSERT_TRUE(errors.T_reference_estimate.has_value());
  EXPECT_LT(translation_distance(*errors.T_reference_estimate, T_truth_estimate), 1e-10);
  EXPECT_LT(rotation_distance(*errors.T_reference_estimate, T_truth_estimate), kAngleRounding);
  EXPECT_LT(statistics(translations(errors.absolute_aligned)).max, 1e-10);
  EXPECT_GT(statistics(translations(errors.absolute)).min, 1.0);
}

TEST(TrajectoryErrors, AlignmentMinimisesTheSquaredErrorWithoutReflection) {
  const Trajectory truth = a_winding_path();
  const Trajectory mirrored = changed(truth, [](double, const Pose& pose) {
    return Pose(pose.rotation(), pose.translation().cwiseProduct(Eigen::Vector3d(1, 1, -1)));
  });
  const TrajectoryErrors errors = trajectory_errors(truth, mirrored);
  ASSERT_TRUE(errors.T_reference_estimate.has_value());
  EXPECT_NEAR(errors.T_reference_estimate->rotation_matrix().determinant(), 1.0, kRounding);
  EXPECT_LE(statistics(translations(errors.absolute_aligned)).sse,
            statistics(translations(errors.absolute)).sse);
  EXPECT_GT(statistics(translations(errors.absolute_aligned)).rmse, 0.1);
}

TEST(TrajectoryErrors, AlignmentIsEmptyForAStaticCamera) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 10; ++i) {
    truth.append(at_second(i), Pose::from_translation({1, 2, 3}));
    estimate.append(at_second(i), Pose::from_translation({1, 2, 3 + 1e-3 * (i % 2)}));
  }
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  EXPECT_FALSE(errors.T_reference_estimate.has_value());
  EXPECT_TRUE(errors.absolute_aligned.empty());
  EXPECT_NEAR(statistics(translations(errors.absolute)).mean, 0.5e-3, kRounding);
}

TEST(TrajectoryErrors, RelativeErrorOfAConstantDriftIsTheDriftInOneStep) {
  const Trajectory truth = a_winding_path();
  const Trajectory drifting = changed(truth, [](double t, const Pose& pose) {
    return Pose::from_translation({0.0, 0.002 * t, 0.0}) * pose;
  });
  const TrajectoryErrors errors = trajectory_errors(truth, drifting);
  ASSERT_EQ(errors.relative.size(), 41U);  // 51 poses, pairs of 10 apart
  EXPECT_NEAR(statistics(translations(errors.relative)).min, 0.002, kRounding);
  EXPECT_NEAR(statistics(translations(errors.relative)).max, 0.002, kRounding);
  ASSERT_EQ(errors.step.size(), 50U);
  EXPECT_NEAR(statistics(translations(errors.step)).rmse, 0.0002, kRounding);
}

TEST(TrajectoryErrors, RelativeErrorDoesNotDependOnAnOffset) {
  const Trajectory truth = a_winding_path();
  const Pose offset = rotated_about_z(1.0, {5, 6, 7});
  const Trajectory moved = changed(truth, [&](double, const Pose& pose) { return offset * pose; });
  EXPECT_LT(statistics(translations(trajectory_errors(truth, moved).relative)).max, 1e-10);
}

TEST(TrajectoryErrors, RelativeErrorPairsOnlyPosesOneStepApart) {
  Trajectory sparse;
  for (const double t : {0.0, 0.5, 1.05, 2.5}) sparse.append(at_second(t), Pose());
  TrajectoryErrorOptions options;
  options.max_gap = 3.0;
  const TrajectoryErrors errors = trajectory_errors(sparse, sparse, options);
  ASSERT_EQ(errors.relative.size(), 1U);  // 0 -> 1.05 alone is 1 s +-10 %
  EXPECT_EQ(errors.relative[0].stamp, at_second(1.05));
}

TEST(TrajectoryErrors, InterpolateTheReferenceAtTheEstimatesStamps) {
  Trajectory truth;
  truth.append(at_second(0.0), Pose::from_translation({0, 0, 0}));
  truth.append(at_second(0.1), Pose::from_translation({1, 0, 0}));
  Trajectory estimate;
  estimate.append(at_second(0.025), Pose::from_translation({0.25, 0, 0.5}));
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  ASSERT_EQ(errors.absolute.size(), 1U);
  EXPECT_NEAR(errors.absolute[0].translation, 0.5, kRounding);
}

TEST(TrajectoryErrors, CountEstimatesOutsideTheReferencesTimeOrInAGap) {
  Trajectory truth;
  for (const double t : {1.0, 1.05, 2.0, 2.05}) truth.append(at_second(t), Pose());
  Trajectory estimate;
  for (const double t : {0.9, 1.02, 1.5, 2.01, 2.1}) estimate.append(at_second(t), Pose());
  const TrajectoryErrors errors = trajectory_errors(truth, estimate);
  EXPECT_EQ(errors.absolute.size(), 2U);
  EXPECT_EQ(errors.unmatched, 3U);
}

TEST(TrajectoryErrors, OfAnEmptyTrajectoryAreEmpty) {
  const TrajectoryErrors errors = trajectory_errors(a_winding_path(), Trajectory());
  EXPECT_TRUE(errors.absolute.empty());
  EXPECT_EQ(errors.unmatched, 0U);
  EXPECT_EQ(trajectory_errors(Trajectory(), a_winding_path()).unmatched, 51U);
}

}  // namespace
}  // namespace pcavr
