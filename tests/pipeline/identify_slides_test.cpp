// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/identify_slides.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/identification/path_view.hpp"

namespace pcavr {
namespace {

constexpr double kStep = 0.002;         // [s]
constexpr double kStiffness = 3e4;      // [N/m]
constexpr double kSlidingForce = 30.0;  // [N]

/// A push along x: an object at `object` [m], pushed by `force` [N] through a linear contact.
IdentifiedContact push_of(const std::vector<double>& object, const std::vector<double>& force,
                          double breakaway) {
  IdentifiedContact contact;
  ContactEpisode& episode = contact.episode;
  episode.kind = ContactKind::slide;
  episode.direction_base = Eigen::Vector3d::UnitX();
  for (std::size_t i = 0; i < object.size(); ++i) {
    episode.t.push_back(kStep * static_cast<double>(i));
    episode.tool.push_back(object[i] + force[i] / kStiffness);
    contact.force_base.push_back(force[i] * episode.direction_base);
  }
  episode.force = force;
  episode.begin = episode.t.front();
  episode.end = episode.t.back();
  episode.breakaway.is_found = true;
  episode.breakaway.t = breakaway;
  episode.breakaway.stiffness = kStiffness;
  return contact;
}

std::vector<FrictionSample> samples_of(IdentifiedContact& contact) {
  std::vector<Eigen::Vector3d> p_base_tip;
  for (const double x : contact.episode.tool) p_base_tip.emplace_back(x, 0.0, 0.0);
  const PathView tip(contact.episode.t, p_base_tip);
  const CadModel model;
  return friction_samples({&contact}, {HuntCrossley{.stiffness = kStiffness, .exponent = 1.0}, 0.1},
                          {model, {}}, tip, 0.005);
}

TEST(FrictionSamples, LeaveOutTheTimeInWhichFrictionSettlesAfterAStop) {
  // A slip of 30 ms, a rest under a force that grows, and a slide of 0.4 s.
  std::vector<double> object, force;
  double x = 0.0;
  for (double t = 0.0; t < 1.0; t += kStep) {
    const bool slides = (t > 0.30 && t < 0.33) || t > 0.50;
    if (slides) x += 0.015 * kStep;
    object.push_back(x);
    const double rest = t < 0.30 ? std::max(t - 0.1, 0.0) / 0.2 : 0.8 + 0.2 * (t - 0.33) / 0.17;
    force.push_back(slides ? kSlidingForce : 38.0 * rest);
  }
  IdentifiedContact contact = push_of(object, force, 0.30);
  const std::vector<FrictionSample> samples = samples_of(contact);
  ASSERT_GE(samples.size(), 5U);
  for (const FrictionSample& sample : samples) {
    EXPECT_NEAR(sample.force, kSlidingForce, 0.005 * kSlidingForce) << "at " << sample.t << " s";
  }
}

TEST(FrictionSamples, KeepBothHalvesOfAModulatedPush) {
  std::vector<double> object, force;
  for (double t = 0.0; t < 2.2; t += kStep) {
    const double slid = std::max(t - 0.2, 0.0);
    object.push_back(0.06 * slid + 0.003 * std::sin(4.0 * std::numbers::pi * slid));
    force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce);
  }
  IdentifiedContact contact = push_of(object, force, 0.2);
  const std::vector<FrictionSample> samples = samples_of(contact);
  const auto faster = std::count_if(samples.begin(), samples.end(), [](const FrictionSample& one) {
    return one.acceleration > 0.2;
  });
  const auto slower = std::count_if(samples.begin(), samples.end(), [](const FrictionSample& one) {
    return one.acceleration < -0.2;
  });
  EXPECT_GE(faster, 12);
  EXPECT_GE(slower, 12);
}

TEST(FrictionSamples, StateWhatTheContactsComplianceChanges) {
  // The force, and with it the compression, changes by 12 N/s: 0.4 mm/s.
  std::vector<double> object, force;
  for (double t = 0.0; t < 1.5; t += kStep) {
    object.push_back(0.03 * std::max(t - 0.2, 0.0));
    force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce + 12.0 * (t - 0.2));
  }
  IdentifiedContact contact = push_of(object, force, 0.2);
  const std::vector<FrictionSample> samples = samples_of(contact);
  ASSERT_GE(samples.size(), 10U);
  for (const FrictionSample& sample : samples) {
    EXPECT_NEAR(sample.speed_change, 0.1 * 12.0 / kStiffness, 1e-6) << "at " << sample.t << " s";
  }
}

}  // namespace
}  // namespace pcavr
