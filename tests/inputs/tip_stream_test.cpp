// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/tip_stream.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"

namespace pcavr {
namespace {

struct Path {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> p_base;
};

/// A hand's motion of 6 s at 500 Hz with noise of 50 um.
Path hand_motion() {
  Path path;
  Random random(5);
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.002 * i;
    path.t.push_back(t);
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    path.p_base.push_back(Eigen::Vector3d(0.1 * std::sin(2.0 * t), 0.05 * t, 0.3) + 5e-5 * noise);
  }
  return path;
}

TipStream streamed(const Path& path) {
  TipStream stream(5e-5, {});
  for (std::size_t i = 0; i < path.t.size(); ++i) stream.add(path.t[i], path.p_base[i]);
  return stream;
}

TEST(TipStream, AcceptsWhatACleanedRecordingKeeps) {
  Path path = hand_motion();
  for (std::size_t i = 150; i < path.t.size(); i += 700) path.p_base[i].y() += 0.02;
  for (std::size_t i = 1000; i < 1010; ++i) path.p_base[i].x() += 0.5;
  for (std::size_t i = 2000; i < path.t.size(); ++i) path.p_base[i].z() += 0.004;
  const TipPath whole = clean_tip_path(path.t, path.p_base, {});
  const TipStream stream = streamed(path);
  ASSERT_GT(whole.outliers, 10U);
  // The last three are not decided yet.
  ASSERT_EQ(stream.t().size() + 3, whole.t.size());
  for (std::size_t i = 0; i < stream.t().size(); ++i) EXPECT_EQ(stream.t()[i], whole.t[i]);
  ASSERT_EQ(stream.bad().size(), whole.bad.size());
  for (std::size_t i = 0; i < stream.bad().size(); ++i) {
    EXPECT_NEAR(stream.bad()[i].begin, whole.bad[i].begin, 1e-9);
    EXPECT_NEAR(stream.bad()[i].end, whole.bad[i].end, 1e-9);
  }
  EXPECT_NEAR(stream.noise(), whole.noise, 0.1 * whole.noise);
}

TEST(TipStream, StoresNoMoreThanIsAskedFor) {
  TipStream stream(5e-5, {});
  for (int i = 0; i < 100000; ++i) {
    stream.add(0.002 * i, Eigen::Vector3d(0.001 * std::sin(0.01 * i), 0.0, 0.3));
    stream.discard_before(0.002 * i - 1.0);
  }
  EXPECT_LT(stream.t().size(), 6000U);
  EXPECT_NEAR(*stream.known_until(), 0.002 * (100000 - 4), 1e-9);
}

TEST(NoiseTracker, FindsTheNoiseWithinASecondAndForgetsAnEpisodeOfVibration) {
  NoiseTracker noise(1.0);
  Random random(6);
  const auto add = [&](int count, double std) {
    for (int i = 0; i < count; ++i) {
      noise.add({std * random.normal(), std * random.normal(), 2.0 * std * random.normal()});
    }
  };
  EXPECT_EQ(noise.largest(), 1.0);
  add(64, 0.1);
  EXPECT_NEAR(noise.largest(), 0.2, 0.06);
  add(10000, 0.1);
  add(2000, 1.0);
  EXPECT_NEAR(noise.std().x(), 0.1, 0.01);
  EXPECT_NEAR(noise.largest(), 0.2, 0.02);
}

}  // namespace
}  // namespace pcavr
