// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/force_ceiling.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kClippedNoise = 0.02;  // [N]
constexpr double kPriorNoise = 0.1;     // [N]

struct ClippedForce {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force_base;
};

/// A push along x whose force is clipped at `range` [N].
ClippedForce clipped_push(double range) {
  Random random(7);
  ClippedForce samples;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.002 * i;
    samples.t.push_back(t);
    Eigen::Vector3d force(20.0 * std::sin(t), 0.0, 0.0);
    for (double& axis : force)
      axis = std::clamp(axis + kClippedNoise * random.normal(), -range, range);
    samples.force_base.push_back(force);
  }
  return samples;
}

std::optional<double> ceiling_of(const ClippedForce& samples) {
  ForceCeiling ceiling(kPriorNoise);
  for (const Eigen::Vector3d& force_base : samples.force_base) ceiling.add(force_base);
  return ceiling.value();
}

TEST(ForceCeilingTest, IsThatOfASearchInAllSamples) {
  const ClippedForce samples = clipped_push(12.0);
  const auto found = find_saturation(samples.t, samples.force_base);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(ceiling_of(samples), found.front().force);
  EXPECT_EQ(ceiling_of(samples), 12.0);
}

TEST(ForceCeilingTest, IsEmptyWithoutSaturation) {
  EXPECT_FALSE(ceiling_of(clipped_push(100.0)));
  EXPECT_FALSE(ForceCeiling(kPriorNoise).value());
}

TEST(ForceCeilingTest, IsEmptyWhereAHigherForceFollows) {
  ClippedForce samples = clipped_push(12.0);
  std::erase_if(samples.force_base, [](const auto& force_base) { return force_base.x() < 0.0; });
  samples.force_base.emplace_back(12.5, 0.0, 0.0);
  samples.t.resize(samples.force_base.size());
  EXPECT_TRUE(find_saturation(samples.t, samples.force_base).empty());
  EXPECT_FALSE(ceiling_of(samples));
}

TEST(ForceCeilingTest, IsFoundWhereMostSamplesAreSaturated) {
  const ClippedForce samples = clipped_push(1.0);
  EXPECT_EQ(ceiling_of(samples), 1.0);
}

TEST(ForceCeilingTest, ForgetsSamplesThatAreDiscarded) {
  const ClippedForce samples = clipped_push(12.0);
  ForceCeiling ceiling(kPriorNoise);
  for (const Eigen::Vector3d& force_base : samples.force_base) ceiling.add(force_base);
  ASSERT_TRUE(ceiling.value());
  ceiling.restart(std::span(samples.force_base).first(100));
  EXPECT_FALSE(ceiling.value());
}

}  // namespace
}  // namespace pcavr
