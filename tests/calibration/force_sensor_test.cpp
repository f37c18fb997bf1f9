// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/force_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"

#include "calibration/random_rig.hpp"
#include "support/std_coverage.hpp"

namespace pcavr {
namespace {

/// A sensor with a load in random poses; its axes are turned, and reversed, at random.
struct ForceRig {
  struct Options {
    int poses = 60;
    double noise = 0.2;  ///< [N] per axis
    ForceAxes axes = ForceAxes::sensor;
    Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
    double max_tilt = 3.0;  ///< [rad]
    bool has_bias = true;
  };

  double mass = 0.0, sign = 1.0;
  Eigen::Matrix3d R_sensor_flange;
  Eigen::Vector3d bias, centre;
  std::vector<ForceReading> readings;
  double noise_squares = 0.0;  ///< [N^2] of what was drawn

  /// [N] per axis.
  [[nodiscard]] double noise_rms() const {
    return std::sqrt(noise_squares / (3.0 * static_cast<double>(readings.size())));
  }

  ForceRig(std::uint64_t seed, const Options& options) {
    Random random(seed);
    mass = random.uniform(0.5, 3.0);
    sign = random.uniform() < 0.5 ? -1.0 : 1.0;
    R_sensor_flange = random_rotation(random, 3.0);
    bias = options.has_bias ? normal_vector(random, 10.0) : Eigen::Vector3d::Zero();
    centre = normal_vector(random, 0.05);
    for (int i = 0; i < options.poses; ++i) {
      const Eigen::Matrix3d R = random_rotation(random, options.max_tilt);
      const Eigen::Vector3d gravity_flange =
          R.transpose() * Eigen::Vector3d(0, 0, -kStandardGravity);
      const Eigen::Vector3d weight = sign * mass * (R_sensor_flange * gravity_flange);
      Eigen::Vector3d force = bias + options.gain * weight;
      Eigen::Vector3d torque = centre.cross(weight);
      if (options.axes == ForceAxes::base) {
        force = R * force;
        torque = R * torque;
      }
      const Eigen::Vector3d noise = normal_vector(random, options.noise);
      noise_squares += noise.squaredNorm();
      readings.push_back({"pose " + std::to_string(i), Eigen::Quaterniond(R), force + noise,
                          torque + normal_vector(random, 0.1 * options.noise)});
    }
  }

  static Eigen::Matrix3d random_rotation(Random& random, double max_angle) {
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = normal_vector(random, 1.0).normalized() * random.uniform(0.0, max_angle);
    return Pose::exp(turn).rotation_matrix();
  }
};

TEST(CalibrateForceSensor, FindsAxesLoadAndBiasOf60NoisyPosesInAnyAxes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ForceAxes axes = seed % 2 == 0 ? ForceAxes::sensor : ForceAxes::base;
    const ForceRig rig(seed, {.axes = axes});
    const auto found = calibrate_force_sensor(rig.readings);
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_EQ(found->axes, axes) << seed;
    EXPECT_EQ(found->sign, rig.sign) << seed;
    EXPECT_FALSE(found->is_pose_inverted);
    const Eigen::Matrix3d signed_axes = rig.sign * rig.R_sensor_flange;
    for (int row = 0; row < 3; ++row) {
      Eigen::Index axis = 0;
      const double cosine = signed_axes.row(row).cwiseAbs().maxCoeff(&axis);
      if (cosine < 0.75) continue;  // half-way between two axes, the noise decides
      EXPECT_EQ(found->read_axes[row].axis, static_cast<int>(axis)) << seed;
      EXPECT_EQ(found->read_axes[row].is_reversed, signed_axes(row, axis) < 0.0) << seed;
    }
    EXPECT_LT(found->residual_rms, 1.1 * rig.noise_rms()) << seed;
    EXPECT_LT(found->held_out_rms, 1.1 * rig.noise_rms()) << seed;
    EXPECT_NEAR(found->mass, rig.mass, 5.0 * found->mass_std) << seed;
    ASSERT_TRUE(found->centre);
    EXPECT_LT((*found->centre - rig.centre).norm(), 0.01) << seed;
  }
}

TEST(CalibrateForceSensor, StatesStdsThatHoldOn200RandomRigs) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 1001; seed <= 1200; ++seed) {
    const ForceRig rig(seed, {.poses = 10 + static_cast<int>(seed % 50),
                              .axes = seed % 2 == 0 ? ForceAxes::sensor : ForceAxes::base});
    const auto found = calibrate_force_sensor(rig.readings);
    ASSERT_TRUE(found) << seed << ' ' << found.error().to_string();
    const Pose found_turn(found->R_sensor_flange, Eigen::Vector3d::Zero());
    const Pose true_turn(Eigen::Quaterniond(rig.R_sensor_flange), Eigen::Vector3d::Zero());
    const Vector6d turn = (found_turn.inverse() * true_turn).log();
    ratios.push_back((found->mass - rig.mass) / found->mass_std);
    for (int axis = 0; axis < 3; ++axis) {
      ratios.push_back((found->force_bias - rig.bias)[axis] / found->force_bias_std[axis]);
      ratios.push_back(turn[3 + axis] / found->rotation_std[axis]);
      ratios.push_back((*found->centre - rig.centre)[axis] / found->centre_std[axis]);
    }
  }
  expect_stds_cover(ratios, 8.0);
}

TEST(CalibrateForceSensor, ShowsCrossTalkOnlyWhereThereIsSome) {
  Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
  gain(0, 2) = 0.06;
  gain(1, 1) = 0.95;
  int false_alarms = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto clean = calibrate_force_sensor(ForceRig(seed, {}).readings);
    false_alarms += clean->has_cross_talk ? 1 : 0;
  }
  EXPECT_EQ(false_alarms, 0);
  const auto found = calibrate_force_sensor(ForceRig(3, {.noise = 0.02, .gain = gain}).readings);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->has_cross_talk);
}

TEST(CalibrateForceSensor, LeavesOutAPoseThatWasTouched) {
  ForceRig rig(4, {});
  rig.readings[7].force += Eigen::Vector3d(0, 15, 0);
  const auto found = calibrate_force_sensor(rig.readings);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->residuals[7].is_outlier);
  EXPECT_LT(found->residual_rms, 1.1 * 0.2);
  ASSERT_FALSE(found->notes.empty());
  EXPECT_NE(found->notes[0].find("pose 7"), std::string::npos);
}

TEST(CalibrateForceSensor, SaysWhatThePosesDoNotShow) {
  const auto tilted = calibrate_force_sensor(ForceRig(5, {.max_tilt = 0.05}).readings);
  ASSERT_FALSE(tilted);
  EXPECT_NE(tilted.error().message.find("do not show the sensor's axes"), std::string::npos);
  ForceRig weightless(6, {});
  Random random(6);
  for (ForceReading& reading : weightless.readings) {
    reading.force = Eigen::Vector3d(3.0, -2.0, 1.0) + normal_vector(random, 0.2);
  }
  const auto constant = calibrate_force_sensor(weightless.readings);
  ASSERT_FALSE(constant);
  EXPECT_NE(constant.error().message.find("do not change"), std::string::npos)
      << constant.error().to_string();
}

// A bias is the same in all poses, as a weight in the base's axes is.
TEST(CalibrateForceSensor, TakesNoBiasOfASensorWithoutALoadForAWeight) {
  for (const Eigen::Vector3d& bias :
       {Eigen::Vector3d(2.0, -1.5, -9.0), Eigen::Vector3d(0, 0, -9.0)}) {
    ForceRig rig(8, {});
    Random random(8);
    for (ForceReading& reading : rig.readings) {
      reading.force = bias + normal_vector(random, 0.2);
      reading.torque = Eigen::Vector3d(0.1, -0.2, 0.05) + normal_vector(random, 0.02);
    }
    const auto found = calibrate_force_sensor(rig.readings);
    ASSERT_FALSE(found) << bias.transpose();
    EXPECT_NE(found.error().message.find("do not change"), std::string::npos)
        << found.error().to_string();
  }
  ForceRig rig(8, {});  // a load of 1 kg, its reading turned to the base without a bias
  Random random(8);
  for (ForceReading& reading : rig.readings) {
    const Eigen::Vector3d weight(0, 0, -kStandardGravity);
    reading.force = weight + normal_vector(random, 0.2);
    reading.torque = (reading.R_base_flange * Eigen::Vector3d(0.0, 0.01, 0.06)).cross(weight) +
                     normal_vector(random, 0.02);
  }
  const auto found = calibrate_force_sensor(rig.readings);
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_EQ(found->axes, ForceAxes::base);
  EXPECT_NEAR(found->mass, 1.0, 5.0 * found->mass_std);
}

TEST(CalibrateForceSensor, KnowsPosesThatAreInverted) {
  ForceRig rig(7, {});
  for (ForceReading& reading : rig.readings) {
    reading.R_base_flange = reading.R_base_flange.conjugate();
  }
  const auto found = calibrate_force_sensor(rig.readings);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_pose_inverted);
  EXPECT_LT(found->residual_rms, 1.1 * 0.2);
}

// The limit is that of an F distribution: too small a one with few poses would invent cross-talk.
TEST(CalibrateForceSensor, InventsCrossTalkOfFewPosesOnceInAThousandTimes) {
  for (const int poses : {6, 8, 12}) {
    constexpr int kRigs = 1000;
    int fitted = 0, invented = 0;
    for (std::uint64_t seed = 1; seed <= kRigs; ++seed) {
      const ForceRig rig(seed, {.poses = poses, .noise = 0.05});
      const auto found = calibrate_force_sensor(rig.readings);
      fitted += found ? 1 : 0;
      invented += found && found->has_cross_talk ? 1 : 0;
    }
    std::printf("  %d poses: %d of %d with cross-talk that is not there\n", poses, invented,
                fitted);
    EXPECT_GT(fitted, kRigs / 2) << poses;
    EXPECT_LE(invented, 6) << poses;
  }
}

}  // namespace
}  // namespace pcavr
