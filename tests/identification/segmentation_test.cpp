// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/plant.hpp"

namespace pcavr {
namespace {

/// A press along -z, a push along +y that slides, a push along +y that doesn't, with free time
/// between; noise, drift, spikes, and a tool clock of its own.
struct WholeRecording {
  std::vector<double> t_force, t_tool;
  std::vector<Eigen::Vector3d> force_base, p_base_tip;
};

WholeRecording whole_recording(std::uint64_t seed, const Eigen::Vector3d& bias) {
  WholeRecording all;
  Random random(seed);
  Sensors sensors;
  sensors.force_noise = 0.0;
  Plant fixed;
  fixed.is_fixed = true;
  const auto there_and_back = [](double far) {
    return
        [far](double t) { return std::min(0.01 * (t - 0.5), 2.0 * far + 0.03 - 0.01 * (t - 0.5)); };
  };
  const std::vector<Trial> parts = {run(fixed, sensors, 4.5, 1, there_and_back(-0.010)),
                                    run({}, sensors, 6.5, 2, there_and_back(0.005)),
                                    run(fixed, sensors, 3.5, 3, there_and_back(-0.012))};
  const Eigen::Vector3d along[] = {-Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY(),
                                   Eigen::Vector3d::UnitY()};
  double start = 0.0;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (std::size_t i = 0; i < parts[part].t.size(); ++i) {
      const double t = start + parts[part].t[i];
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      Eigen::Vector3d force = bias + 0.2 * noise + parts[part].true_force[i] * along[part];
      force.x() += 0.1 * std::sin(0.9 * t);
      if (random.uniform() < 0.001) force.y() += 20.0;
      all.t_force.push_back(t + 0.001);
      all.force_base.push_back(force);
      all.t_tool.push_back(t);
      all.p_base_tip.push_back(parts[part].tool[i] * along[part]);
    }
    start += parts[part].t.back() + 0.002;
  }
  return all;
}

TEST(SegmentContacts, FindsPressSlideAndPushWithoutAnnotations) {
  const WholeRecording all = whole_recording(5105, Eigen::Vector3d::Zero());
  const Segmentation found =
      segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
  ASSERT_EQ(found.contacts.size(), 3U);
  EXPECT_EQ(found.contacts[0].kind, ContactKind::press);
  EXPECT_EQ(found.contacts[1].kind, ContactKind::slide);
  EXPECT_EQ(found.contacts[2].kind, ContactKind::push);
  EXPECT_GT(found.contacts[0].direction_base.dot(-Eigen::Vector3d::UnitZ()), 0.99);
  EXPECT_GT(found.contacts[1].direction_base.dot(Eigen::Vector3d::UnitY()), 0.99);
  EXPECT_NEAR(found.contacts[0].begin, 0.5, 0.06);
  EXPECT_GE(found.spikes, 5U);
  EXPECT_NEAR(found.noise, 0.2, 0.05);
  ASSERT_FALSE(found.contacts[1].slides.empty());
  EXPECT_TRUE(found.contacts[1].breakaway.is_found);
}

TEST(SegmentContacts, ExtrapolatesBeginAndEndToTheSurface) {
  std::vector<double> errors;
  for (std::uint64_t seed = 5111; seed <= 5130; ++seed) {
    const WholeRecording all = whole_recording(seed, Eigen::Vector3d::Zero());
    const Segmentation found =
        segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
    ASSERT_EQ(found.contacts.size(), 3U);
    // The faces are at 0, at 10 mm/s; the forces' timestamps are 1 ms late.
    for (const double error : {found.contacts[0].begin - 0.501, found.contacts[0].end - 1.501,
                               found.contacts[1].begin - 5.003}) {
      errors.push_back(std::abs(error));
    }
  }
  std::sort(errors.begin(), errors.end());
  // A threshold of six stds is 90 ms late here, at begin and end.
  EXPECT_LT(errors[errors.size() / 2], 0.015);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.03);
  // Noise and drift look like a first touch in one of two hundred contacts.
  EXPECT_LT(errors[errors.size() - 2], 0.06);
}

TEST(SegmentContacts, SubtractsAConstantBias) {
  const Eigen::Vector3d bias(0.4, -0.6, 0.5);
  const WholeRecording all = whole_recording(5106, bias);
  const Segmentation found =
      segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
  ASSERT_EQ(found.contacts.size(), 3U);
  for (std::size_t i = 0; i < found.bias_base.size(); ++i) {
    EXPECT_NEAR((found.bias_base[i] - bias).norm(), 0.0, 0.25);  // drift is 0.1 N of it
  }
}

TEST(SegmentContacts, FindsNothingWithoutContact) {
  Random random(7);
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force, tip;
  for (int i = 0; i < 3000; ++i) {
    t.push_back(0.002 * i);
    force.push_back(0.3 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    tip.push_back({0.001 * i, 0.0, 0.0});
  }
  EXPECT_TRUE(segment_contacts(t, force, t, tip).contacts.empty());
  EXPECT_TRUE(segment_contacts({}, {}, {}, {}).contacts.empty());
}

/// A force along y that rises to `peak` [N] within `rise` [s], stays for 1 s and falls likewise,
/// `pushes` times, with 2 s between; its bias drifts by `drift` [N/s]. The tip moves with it.
WholeRecording drifting_pushes(int pushes, double peak, double rise, double drift) {
  WholeRecording all;
  Random random(5131);
  const double period = 3.0 + 2.0 * rise;
  for (double t = 0.0; t < pushes * period + 2.0; t += 0.002) {
    const double in_period = std::fmod(t, period) - 2.0;
    const double share =
        std::clamp(std::min(in_period, 1.0 + 2.0 * rise - in_period) / rise, 0.0, 1.0);
    const bool is_pushing = t < pushes * period;
    Eigen::Vector3d force(0.0, (is_pushing ? share * peak : 0.0) + drift * t, 0.0);
    force += 0.1 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    all.t_force.push_back(t);
    all.force_base.push_back(force);
    all.t_tool.push_back(t);
    all.p_base_tip.push_back({0.0, 1e-3 * share, 0.0});
  }
  return all;
}

TEST(SegmentContacts, KeepsContactsApartUnderADriftBeyondTheirThreshold) {
  for (const double drift : {0.03, -0.03}) {
    // 2 N in all: many times the force at which a contact begins.
    const WholeRecording all = drifting_pushes(20, 6.0, 0.1, drift);
    const Segmentation found =
        segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
    ASSERT_EQ(found.contacts.size(), 20U) << drift;
    for (const Contact& contact : found.contacts) {
      EXPECT_NEAR(contact.end - contact.begin, 1.2, 0.1);
      EXPECT_NEAR(contact.peak_force, 6.0, 0.25);
    }
  }
}

TEST(SegmentContacts, TakesNoSlowPressForDrift) {
  const WholeRecording all = drifting_pushes(2, 3.0, 12.0, 0.0);  // 0.25 N/s
  const Segmentation found =
      segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
  ASSERT_EQ(found.contacts.size(), 2U);
  for (const Contact& contact : found.contacts) EXPECT_NEAR(contact.peak_force, 3.0, 0.3);
}

TEST(SegmentContacts, TakesNoCablesPullForAContact) {
  // The tip travels 0.6 m at 0.25 m/s between pushes at two places, and a cable of 2 N/m pulls on
  // the sensor: 1.2 N, at ten times the rate of a sensor that warms up.
  WholeRecording all;
  Random random(5171);
  for (double t = 0.0; t < 20.0; t += 0.002) {
    const double x = 0.6 * std::clamp((t - 9.0) * 0.25 / 0.6, 0.0, 1.0);
    const double in_half = std::fmod(t, 10.0) - 4.0;
    const double share = std::clamp(std::min(in_half, 2.0 - in_half) / 0.5, 0.0, 1.0);
    Eigen::Vector3d force(-2.0 * x, 6.0 * share, 0.0);
    force += 0.1 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    all.t_force.push_back(t);
    all.force_base.push_back(force);
    all.t_tool.push_back(t);
    all.p_base_tip.push_back({x, 1e-3 * share, 0.0});
  }
  const Segmentation found =
      segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
  ASSERT_EQ(found.contacts.size(), 2U);
  for (const Contact& contact : found.contacts) {
    EXPECT_NEAR(contact.end - contact.begin, 2.0, 0.15);
    EXPECT_NEAR(contact.peak_force, 6.0, 0.2);
    EXPECT_NEAR(contact.direction_base.y(), 1.0, 1e-3);
  }
}

/// The tip rests on the object for a while after a push, under a force below the threshold of
/// contact, as a light object that has stopped holds it: 15 % of the push would go into the bias.
TEST(SegmentContacts, TakesNoRestAfterAPushForBias) {
  for (std::uint64_t seed = 5171; seed <= 5180; ++seed) {
    Random random(seed);
    WholeRecording all;
    for (double t = 0.0; t < 12.0; t += 0.002) {
      const double in_push = std::fmod(t, 4.0) - 2.0;
      const double push = in_push < 0.0 ? 0.0 : in_push < 1.0 ? 2.0 : in_push < 1.3 ? 0.45 : 0.0;
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      all.t_force.push_back(t);
      all.force_base.push_back(0.2 * noise + push * Eigen::Vector3d::UnitY());
      all.t_tool.push_back(t);
      all.p_base_tip.push_back({0.0, 0.01 * std::clamp(in_push, 0.0, 1.3), 0.0});
    }
    const Segmentation found =
        segment_contacts(all.t_force, all.force_base, all.t_tool, all.p_base_tip);
    ASSERT_EQ(found.contacts.size(), 3U) << seed;
    for (const Eigen::Vector3d& bias : found.bias_base) ASSERT_LT(bias.y(), 0.15) << seed;
  }
}

/// A modulated press that was never let go of for long, whose log has few samples for a second.
TEST(SegmentContacts, TakesGapsInAContactForNoBias) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force_base, p_base_tip;
  Random random(5161);
  for (int i = 0; i < 1320; ++i) {
    if (i > 650 && i < 715 && i % 4 != 0) continue;
    t.push_back(0.0152 * i);
    const double force = std::max(0.0, 0.9 + 1.1 * std::cos(2.0 * M_PI * 3.0 * t.back()));
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    force_base.push_back(0.02 * noise - force * Eigen::Vector3d::UnitZ());
    p_base_tip.push_back({0.0, 0.0, -force / 500.0});
  }
  const Segmentation found = segment_contacts(t, force_base, t, p_base_tip);
  for (const Eigen::Vector3d& bias : found.bias_base) ASSERT_LT(bias.norm(), 0.2);
  ASSERT_FALSE(found.contacts.empty());
  for (const Contact& contact : found.contacts) {
    EXPECT_LT(contact.direction_base.z(), -0.9) << contact.begin;
  }
}

}  // namespace
}  // namespace pcavr
