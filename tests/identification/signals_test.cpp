// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/signals.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

namespace pcavr {
namespace {

std::vector<double> grid(double rate, double duration) {
  std::vector<double> t;
  for (int i = 0; i <= static_cast<int>(duration * rate); ++i) t.push_back(i / rate);
  return t;
}

TEST(RemoveSpikes, ReplacesSingleSpikesAndKeepsTheRest) {
  Random random(1);
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) values.push_back(5.0 * std::sin(0.01 * i) + 0.2 * random.normal());
  std::vector<double> with_spikes = values;
  for (std::size_t i = 100; i < 2000; i += 190) with_spikes[i] += i % 380 == 100 ? 30.0 : -6.0;
  const DespikedSignal clean = remove_spikes(with_spikes);
  for (std::size_t i = 100; i < 2000; i += 190) EXPECT_NEAR(clean.values[i], values[i], 1.0) << i;
  EXPECT_GE(clean.spikes.size(), 10U);
  EXPECT_LE(clean.spikes.size(), 20U);  // five stds of seven samples: a few false positives
}

TEST(RemoveSpikes, KeepsStepsAndRamps) {
  std::vector<double> values(40, 0.0);
  for (std::size_t i = 20; i < 40; ++i) values[i] = 10.0 + static_cast<double>(i);
  EXPECT_EQ(remove_spikes(values).values, values);
}

TEST(EstimateNoiseStd, IsThatOfWhiteNoiseOnAMovingSignal) {
  Random random(2);
  std::vector<double> values;
  for (int i = 0; i < 5000; ++i) values.push_back(std::sin(0.01 * i) + 0.3 * random.normal());
  EXPECT_NEAR(estimate_noise_std(values), 0.3, 0.03);  // a median of 5000: 2 %
  EXPECT_EQ(estimate_noise_std(std::vector<double>{1.0}), 0.0);
}

TEST(Smooth, IsExactForAPolynomial) {
  std::vector<double> t, x;
  for (int i = 0; i < 100; ++i) {
    t.push_back(0.002 * i + 0.0004 * std::sin(9.0 * i));  // jitter
    x.push_back(0.6 + 0.3 * t.back());
  }
  const SmoothedSample sample = smooth_at(t, x, 0.1013, 0.02);
  ASSERT_TRUE(sample.is_valid);
  EXPECT_NEAR(sample.value, 0.6 + 0.3 * 0.1013, 1e-12);
  EXPECT_NEAR(sample.rate, 0.3, 1e-10);
  EXPECT_NEAR(sample.acceleration, 0.0, 1e-8);
}

TEST(Smooth, FitsForceAndMotionTogetherExactly) {
  // F = M a + B v + k x at 5 Hz through a window of 80 ms: each smoothed alone is off by a few per
  // cent, together they satisfy the law.
  const double w = 2.0 * 3.14159265358979 * 5.0;
  const std::vector<double> t = grid(2000.0, 1.0);
  std::vector<double> x, f;
  for (const double at : t) {
    x.push_back(std::sin(w * at));
    f.push_back(-3.0 * w * w * std::sin(w * at) + 10.0 * w * std::cos(w * at) + 500.0 * x.back());
  }
  double unsmoothed = 0.0;
  for (double at = 0.1; at < 0.9; at += 0.013) {
    const SmoothedSample p = smooth_at(t, x, at, 0.04);
    const SmoothedSample force = smooth_at(t, f, at, 0.04);
    // Sums over the window approximate integrals: 160 samples, about 1e-3.
    EXPECT_NEAR(force.value, 3.0 * p.acceleration + 10.0 * p.rate + 500.0 * p.value, 5.0);
    const double exact =
        -3.0 * w * w * std::sin(w * at) + 10.0 * w * std::cos(w * at) + 500.0 * std::sin(w * at);
    unsmoothed = std::max(unsmoothed, std::abs(force.value - exact));
  }
  EXPECT_GT(unsmoothed, 100.0);
}

TEST(SmoothValues, AreThoseOfSmooth) {
  std::vector<double> t, values;
  for (int i = 0; i < 200; ++i) {
    t.push_back(0.002 * i + (i > 120 ? 0.05 : 0.0) + 1e-4 * std::sin(5.0 * i));
    values.push_back(1000.0 + std::sin(40.0 * t.back()) + 0.1 * std::sin(77.0 * i));
  }
  const std::vector<SmoothedSample> all = smooth(t, values, t, 0.012);
  const std::vector<SmoothedSample> alone = smooth_values(t, values, t, 0.012);
  ASSERT_EQ(alone.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(alone[i].is_valid, all[i].is_valid) << i;
    EXPECT_NEAR(alone[i].value, all[i].value, 1e-9) << i;
  }
}

TEST(Smooth, IsInvalidWhereTheWindowIsNotFull) {
  const std::vector<double> t = grid(500.0, 0.1);
  const std::vector<double> x(t.size(), 1.0);
  EXPECT_FALSE(smooth_at(t, x, 0.0, 0.02).is_valid);
  EXPECT_FALSE(smooth_at(t, x, 0.1, 0.02).is_valid);
  EXPECT_TRUE(smooth_at(t, x, 0.05, 0.02).is_valid);
  EXPECT_FALSE(smooth_at({}, {}, 0.05, 0.02).is_valid);
  std::vector<double> holed = t;
  std::erase_if(holed, [](double at) { return at > 0.04 && at < 0.06; });
  EXPECT_FALSE(smooth_at(holed, std::vector<double>(holed.size(), 1.0), 0.05, 0.02).is_valid);
}

TEST(Smooth, OfPointsIsThatOfEachAxis) {
  std::vector<double> t = grid(500.0, 0.2);
  Random random(6);
  for (double& at : t) at += 3e-4 * random.uniform(-1.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (const double at : t)
    points.emplace_back(0.6 + 0.3 * at, 4.0 * at * at + 1e-3 * random.normal(), -2.0);
  for (double at = -0.01; at < 0.21; at += 0.0017) {
    const std::optional<Eigen::Vector3d> smoothed = smooth_point_at(t, points, at, 0.02);
    for (int axis = 0; axis < 3; ++axis) {
      const SmoothedSample alone = smooth_at(t, axis_of(points, axis), at, 0.02);
      ASSERT_EQ(smoothed.has_value(), alone.is_valid) << at;
      if (smoothed.has_value()) {
        EXPECT_NEAR((*smoothed)[axis], alone.value, 1e-12) << at;
      }
    }
  }
}

TEST(CausalFilter, EqualsTheCentredOneAfterItsDelay) {
  const std::vector<double> t = grid(500.0, 1.0);
  Random random(4);
  std::vector<double> x, f;
  for (const double at : t) {
    x.push_back(0.01 * std::sin(9.0 * at) + 1e-5 * random.normal());
    f.push_back(5.0 * std::cos(9.0 * at) + 0.2 * random.normal());
  }
  CausalFilter filter(0.02, 500.0, 0.3);
  int given = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto out = filter.step(t[i], x[i], f[i]);
    if (!out) continue;
    ++given;
    EXPECT_NEAR(out->t, t[i] - filter.delay(), 1e-9);
    const SmoothedSample p = smooth_at(t, x, out->t, 0.02);
    EXPECT_NEAR(out->acceleration, p.acceleration, 1e-6);
    EXPECT_NEAR(out->speed, p.rate, 1e-9);
    EXPECT_NEAR(out->force, smooth_at(t, f, out->t, 0.02).value, 1e-6);
  }
  EXPECT_GT(given, 450);
}

TEST(CausalFilter, IsRobustAgainstSpikesAndInvalidNumbers) {
  CausalFilter filter(0.02, 500.0, 0.3);
  double max_force = 0.0;
  for (int i = 0; i < 500; ++i) {
    if (i % 50 == 7) filter.step(0.002 * i, NAN, 0.0);
    const auto out = filter.step(0.002 * i + 0.001, 0.0, i % 40 == 9 ? 50.0 : 1.0);
    EXPECT_FALSE(filter.step(0.002 * i, 0.0, 0.0).has_value());  // a timestamp that goes back
    if (out) max_force = std::max(max_force, out->force);
  }
  EXPECT_NEAR(max_force, 1.0, 1e-9);
}

TEST(TimeOffset, IsFoundWithItsStd) {
  double squared = 0.0, stated_std = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    std::vector<double> t_a = grid(500.0, 4.0), t_b = grid(300.0, 4.0), a, b;
    for (const double at : t_a)
      a.push_back(std::exp(-8.0 * (at - 2) * (at - 2)) + 0.02 * random.normal());
    for (const double at : t_b) {
      const double shifted = at - 0.0373;
      b.push_back(40.0 * std::exp(-8.0 * (shifted - 2) * (shifted - 2)) + 0.5 * random.normal());
    }
    const TimeOffset offset = estimate_time_offset(t_a, a, t_b, b);
    ASSERT_TRUE(offset.is_known);
    EXPECT_NEAR(offset.offset, 0.0373, 0.004);
    EXPECT_GT(offset.correlation, 0.9);
    squared += std::pow(offset.offset - 0.0373, 2) / 10.0;
    stated_std += offset.std / 10.0;
  }
  // Its std is right within a factor of three (interpolation smooths the noise).
  EXPECT_LT(std::sqrt(squared), 3.0 * stated_std);
  EXPECT_GT(std::sqrt(squared), stated_std / 3.0);
}

TEST(TimeOffset, LeavesOutGaps) {
  const std::vector<double> t_b = grid(500.0, 4.0);
  std::vector<double> t_a, a, b;
  const auto pulse = [](double at) { return std::exp(-20.0 * (at - 2.0) * (at - 2.0)); };
  for (const double at : t_b) {
    b.push_back(pulse(at) + 0.3 * pulse(at - 1.0));
    if (at > 1.7 && at < 2.1) continue;
    t_a.push_back(at);
    a.push_back(b.back());
  }
  const TimeOffset offset = estimate_time_offset(t_a, a, t_b, b);
  ASSERT_TRUE(offset.is_known);
  EXPECT_NEAR(offset.offset, 0.0, 0.002);
  EXPECT_GT(offset.correlation, 0.99);
}

TEST(TimeOffset, DetectsAForceOfTheWrongSign) {
  std::vector<double> t = grid(500.0, 3.0), a, b;
  for (const double at : t) {
    a.push_back(std::sin(3.0 * at * at));
    b.push_back(-2.0 * std::sin(3.0 * (at - 0.1) * (at - 0.1)));
  }
  const TimeOffset offset = estimate_time_offset(t, a, t, b);
  EXPECT_LT(offset.correlation, -0.95);
  EXPECT_NEAR(offset.offset, 0.1, 0.002);
}

TEST(TimeOffset, IsUnknownWithoutCorrelation) {
  Random random(8);
  std::vector<double> t = grid(500.0, 3.0), a, b;
  for (std::size_t i = 0; i < t.size(); ++i)
    a.push_back(random.normal()), b.push_back(random.normal());
  EXPECT_FALSE(estimate_time_offset(t, a, t, b).is_known);
  EXPECT_FALSE(estimate_time_offset({}, {}, t, b).is_known);
  EXPECT_FALSE(estimate_time_offset(t, std::vector<double>(t.size(), 1.0), t, b).is_known);
}

TEST(TrackBias, TracksDriftAndInterpolatesAcrossContacts) {
  const std::vector<double> t = grid(500.0, 6.0);
  std::vector<Eigen::Vector3d> force;
  std::vector<bool> is_free;
  for (const double at : t) {
    const bool free = at < 2.0 || at > 3.0;
    is_free.push_back(free);
    force.push_back({0.05 * at + (free ? 0.0 : 20.0), 0.0, 0.0});
  }
  const auto bias = track_bias(t, force, is_free, 0.25);
  for (std::size_t i = 0; i < t.size(); ++i) {
    // A one-sided mean at the ends is half a half width late: 0.125 s of 0.05 N/s.
    EXPECT_NEAR(bias[i].x(), 0.05 * t[i], 0.0075);
  }
  for (const auto& none : track_bias(t, force, std::vector<bool>(t.size(), false), 0.25)) {
    EXPECT_EQ(none.norm(), 0.0);
  }
}

}  // namespace
}  // namespace pcavr
