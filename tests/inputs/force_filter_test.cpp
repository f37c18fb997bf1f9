// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kForceRate = 500.0;  // [1/s]
constexpr double kNoise = 0.1;        // [N]

struct Force {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force;
};

/// 12 s of white noise, with a press of 1 s from t = 5 s on.
Force noisy_press(std::uint64_t seed) {
  Random random(seed);
  Force measured;
  for (int i = 0; i < 12 * static_cast<int>(kForceRate); ++i) {
    const double t = i / kForceRate;
    Eigen::Vector3d force;
    for (int axis = 0; axis < 3; ++axis) force[axis] = kNoise * random.normal();
    if (t > 5.0 && t < 6.0) force.z() -= 20.0 * std::pow(std::sin(std::numbers::pi * t), 2);
    measured.t.push_back(t);
    measured.force.push_back(force);
  }
  return measured;
}

Segmentation press_of(const Force& measured) {
  Segmentation found;
  found.contacts.emplace_back();
  found.contacts.front().begin = 5.0, found.contacts.front().end = 6.0;
  found.bias_base.assign(measured.t.size(), Eigen::Vector3d::Zero());
  return found;
}

/// Behind `order` low passes of first order, one after the other [Hz].
std::vector<Eigen::Vector3d> low_passed(std::vector<Eigen::Vector3d> force, double cutoff,
                                        int order) {
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff / kForceRate);
  for (int k = 0; k < order; ++k) {
    Eigen::Vector3d state = force.front();
    for (Eigen::Vector3d& value : force) value = state += share * (value - state);
  }
  return force;
}

double rms_difference(const std::vector<Eigen::Vector3d>& a,
                      const std::vector<Eigen::Vector3d>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// [N] Of the press, from before it to after it.
double largest_difference(const std::vector<Eigen::Vector3d>& a,
                          const std::vector<Eigen::Vector3d>& b) {
  double largest = 0.0;
  for (std::size_t i = 2400; i < 3100; ++i) {
    largest = std::max(largest, std::abs(a[i].z() - b[i].z()));
  }
  return largest;
}

std::optional<ForceFilter> filter_of_noise(const Force& measured) {
  return find_force_filter(measured.t, measured.force, press_of(measured)).filter;
}

TEST(ForceFilter, IsFoundByTheNoiseWithoutContact) {
  for (const double cutoff : {8.0, 20.0, 60.0}) {
    const Force sent = noisy_press(3);
    const std::vector<Eigen::Vector3d> seen = low_passed(sent.force, cutoff, 1);
    const auto filter = filter_of_noise({sent.t, seen});
    ASSERT_TRUE(filter) << cutoff;
    const double share = std::exp(-2.0 * std::numbers::pi * cutoff / kForceRate);
    const double delay = share / (1.0 - share) / kForceRate;
    EXPECT_NEAR(filter->delay, delay, 0.12 * delay) << cutoff;
    // What is left is a tenth of what the filter changes, and noise.
    EXPECT_LT(rms_difference(without_filter(*filter, sent.t, seen), sent.force),
              0.15 * rms_difference(seen, sent.force));
  }
}

TEST(ForceFilter, OfSecondOrderIsFound) {
  for (const double cutoff : {20.0, 60.0}) {
    const Force sent = noisy_press(4);
    const std::vector<Eigen::Vector3d> seen = low_passed(sent.force, cutoff, 2);
    const auto filter = filter_of_noise({sent.t, seen});
    ASSERT_TRUE(filter) << cutoff;
    EXPECT_LT(rms_difference(without_filter(*filter, sent.t, seen), sent.force),
              0.3 * rms_difference(seen, sent.force));
  }
}

/// The mean of the newest samples.
std::vector<Eigen::Vector3d> averaged(const std::vector<Eigen::Vector3d>& force,
                                      std::size_t samples) {
  std::vector<Eigen::Vector3d> means;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const std::size_t count = std::min(samples, i + 1);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = i + 1 - count; k <= i; ++k) sum += force[k];
    means.emplace_back(sum / static_cast<double>(count));
  }
  return means;
}

TEST(ForceFilter, OfAMovingAverageIsFound) {
  for (const std::size_t samples : {3U, 10U, 25U, 60U}) {
    const Force sent = noisy_press(10);
    const std::vector<Eigen::Vector3d> seen = averaged(sent.force, samples);
    const auto filter = filter_of_noise({sent.t, seen});
    ASSERT_TRUE(filter) << samples;
    EXPECT_EQ(filter->average, samples);
    EXPECT_DOUBLE_EQ(filter->delay, 0.5 * (static_cast<double>(samples) - 1.0) * filter->interval);
    EXPECT_FALSE(filter_with_delay(*filter, 0.02, 0.001));
    EXPECT_LT(largest_difference(without_filter(*filter, sent.t, seen), sent.force), 6.0 * kNoise)
        << samples;
  }
}

/// A Butterworth filter of an even order by the bilinear transform, a section of two poles each
/// [Hz].
std::vector<Eigen::Vector3d> butterworth_filtered(std::vector<Eigen::Vector3d> force, double cutoff,
                                                  int order) {
  const double w = std::tan(std::numbers::pi * cutoff / kForceRate);
  for (int section = 0; section < order / 2; ++section) {
    const double r = std::sin(std::numbers::pi * (2.0 * section + 1.0) / (2.0 * order));
    const double s = w * w + 2.0 * w * r + 1.0;
    Eigen::Vector3d w1 = Eigen::Vector3d::Zero(), w2 = w1;
    for (Eigen::Vector3d& value : force) {
      const Eigen::Vector3d w0 =
          2.0 * (1.0 - w * w) / s * w1 - (w * w - 2.0 * w * r + 1.0) / s * w2 + value;
      value = w * w / s * (w0 + 2.0 * w1 + w2);
      w2 = w1, w1 = w0;
    }
  }
  return force;
}

TEST(ForceFilter, OfButterworthIsFound) {
  for (const int order : {2, 4}) {
    for (const double cutoff : {15.0, 40.0, 90.0}) {
      const Force sent = noisy_press(11);
      const std::vector<Eigen::Vector3d> seen = butterworth_filtered(sent.force, cutoff, order);
      const auto filter = filter_of_noise({sent.t, seen});
      ASSERT_TRUE(filter && filter->butterworth) << order << ' ' << cutoff;
      EXPECT_EQ(filter->butterworth->order, static_cast<std::size_t>(order));
      EXPECT_NEAR(filter->butterworth->cutoff * kForceRate, cutoff, 0.1 * cutoff);
      EXPECT_LT(largest_difference(without_filter(*filter, sent.t, seen), sent.force), 6.0 * kNoise)
          << order << ' ' << cutoff;
      const auto slower = filter_with_delay(*filter, 1.2 * filter->delay, 0.001);
      ASSERT_TRUE(slower);
      EXPECT_NEAR(slower->delay, 1.2 * filter->delay, 1e-3 * filter->delay);
    }
  }
}

TEST(ForceFilter, StatesAStdOfAButterworthsDelayThatHolds) {
  int within = 0;
  constexpr int kRuns = 60;
  double largest = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Random random(static_cast<std::uint64_t>(run));
    const double cutoff = random.uniform(10.0, 60.0);
    const Force sent = noisy_press(static_cast<std::uint64_t>(100 + run));
    const auto filter = filter_of_noise({sent.t, butterworth_filtered(sent.force, cutoff, 2)});
    ASSERT_TRUE(filter && filter->butterworth) << run;
    const double delay = Butterworth{2, cutoff / kForceRate}.delay() * filter->interval;
    const double error = std::abs(filter->delay - delay) / filter->std;
    within += error < 1.0 ? 1 : 0;
    largest = std::max(largest, error);
  }
  std::printf("  within one std: %d of %d, largest error %.2f std\n", within, kRuns, largest);
  EXPECT_GE(within, 0.58 * kRuns);
  EXPECT_LT(largest, 4.0);
}

TEST(ForceFilter, IsNoneOfWhiteNoise) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    EXPECT_FALSE(filter_of_noise(noisy_press(seed)));
  }
}

TEST(ForceFilter, IsNoneOfNoiseThatDrifts) {
  Force measured = noisy_press(6);
  Random random(7);
  double drift = 0.0;
  for (Eigen::Vector3d& force : measured.force) {
    drift += 0.05 * kNoise * random.normal();
    force.x() += drift;
  }
  EXPECT_FALSE(filter_of_noise(measured));
}

TEST(ForceFilter, IsNoneOfAVibration) {
  Force measured = noisy_press(8);
  for (std::size_t i = 0; i < measured.t.size(); ++i) {
    measured.force[i].y() += 0.2 * std::sin(2.0 * std::numbers::pi * 47.0 * measured.t[i]);
  }
  EXPECT_FALSE(filter_of_noise(measured));
}

TEST(ForceFilter, IsNotKnownOfRepeatedSamplesOrWithoutNoise) {
  Force repeated = noisy_press(9);
  for (std::size_t i = 0; i < repeated.force.size(); ++i) {
    repeated.force[i] = repeated.force[i / 5 * 5];
  }
  EXPECT_FALSE(filter_of_noise(repeated));
  Force silent = noisy_press(9);
  for (Eigen::Vector3d& force : silent.force) force.setZero();
  EXPECT_FALSE(filter_of_noise(silent));
}

TEST(ForceFilter, IsGivenAnotherDelay) {
  const auto first = filter_with_delay({{0.5}, 0.002, 0.001, 0.002}, 0.006, 0.0004);
  ASSERT_TRUE(first);
  EXPECT_DOUBLE_EQ(first->coefficients.front(), 0.75);
  EXPECT_EQ(first->delay, 0.006);
  // Two of first order with 0.8, which delay by 4 samples each.
  const auto second = filter_with_delay({{1.6, -0.64}, 0.016, 0.001, 0.002}, 0.018, 0.0004);
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->delay, 0.018, 3e-4);
  const double pole = 0.5 * second->coefficients[0];
  EXPECT_NEAR(second->coefficients[1], -pole * pole, 1e-9);
  EXPECT_FALSE(filter_with_delay({{0.5, 0.1, 0.1}, 0.002, 0.001, 0.002}, 0.006, 0.0004));
}

TEST(ForceFilter, IsNotUndoneAcrossAGap) {
  const ForceFilter filter{{0.5}, 0.002, 0.0, 0.002};
  const std::vector<double> t{0.0, 0.1, 0.2, 5.0, 5.1, 5.2};
  const std::vector<Eigen::Vector3d> seen(t.size(), Eigen::Vector3d::UnitX());
  std::vector<Eigen::Vector3d> steps = seen;
  for (std::size_t i = 3; i < steps.size(); ++i) steps[i] *= 10.0;
  for (const Eigen::Vector3d& force : without_filter(filter, t, steps)) {
    EXPECT_TRUE(force.x() == 1.0 || force.x() == 10.0) << force.x();
  }
}

}  // namespace
}  // namespace pcavr
