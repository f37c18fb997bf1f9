// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/identify_slides.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/identification/path_view.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kStep = 0.002;         // [s]
constexpr double kStiffness = 3e4;      // [N/m]
constexpr double kSlidingForce = 30.0;  // [N]

/// A push along x: an object at `object` [m], pushed by `force` [N] through a linear contact.
Contact push_of(const std::vector<double>& object, const std::vector<double>& force,
                double breakaway) {
  Contact contact;
  contact.kind = ContactKind::slide;
  contact.direction_base = Eigen::Vector3d::UnitX();
  for (std::size_t i = 0; i < object.size(); ++i) {
    contact.t.push_back(kStep * static_cast<double>(i));
    contact.tool.push_back(object[i] + force[i] / kStiffness);
    contact.force_base.push_back(force[i] * contact.direction_base);
  }
  contact.force = force;
  contact.begin = contact.t.front();
  contact.end = contact.t.back();
  contact.breakaway.is_found = true;
  contact.breakaway.t = breakaway;
  contact.breakaway.stiffness = kStiffness;
  return contact;
}

std::vector<FrictionSample> samples_of(Contact& contact, double damping_std = 0.0) {
  std::vector<Eigen::Vector3d> p_base_tip;
  for (const double x : contact.tool) p_base_tip.emplace_back(x, 0.0, 0.0);
  const PathView tip(contact.t, p_base_tip);
  const CadModel model;
  return friction_samples(
      {&contact}, {HuntCrossley{.stiffness = kStiffness, .exponent = 1.0}, 0.1, damping_std},
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
  Contact contact = push_of(object, force, 0.30);
  const std::vector<FrictionSample> samples = samples_of(contact);
  ASSERT_GE(samples.size(), 5U);
  for (const FrictionSample& sample : samples) {
    EXPECT_NEAR(sample.force, kSlidingForce, 0.005 * kSlidingForce) << "at " << sample.t << " s";
  }
}

// The measured compression of the contact is only the force's noise in a steady push, which does
// not show how soft the contact is. A push whose force swings shows it.
TEST(FrictionSamples, ExpectNoMotionOfTheContactFromTheNoiseOfTheForce) {
  for (const double swing : {0.0, 3.0}) {
    std::vector<double> object, force;
    for (double t = 0.0; t < 2.2; t += kStep) {
      object.push_back(0.06 * std::max(t - 0.2, 0.0));
      const double steady = kSlidingForce + swing * std::sin(6.0 * std::numbers::pi * t);
      force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : steady);
    }
    Contact contact = push_of(object, force, 0.20);
    Random random(3);
    for (double& measured : contact.force) measured += 0.1 * random.normal();
    const std::vector<FrictionSample> samples = samples_of(contact);
    ASSERT_GE(samples.size(), 20U);
    double squares = 0.0, noise = 0.0;
    for (const FrictionSample& sample : samples) {
      squares += std::pow(sample.acceleration_change, 2);
      noise += std::pow(0.1 * sample.acceleration_std, 2);  // 0.1: the compliance's std
    }
    const double share = std::sqrt(squares / noise);
    if (swing > 0.0) {
      EXPECT_GT(share, 2.0);
    } else {
      EXPECT_LT(share, 0.5);
    }
  }
}

TEST(FrictionSamples, KeepBothHalvesOfAModulatedPush) {
  std::vector<double> object, force;
  for (double t = 0.0; t < 2.2; t += kStep) {
    const double slid = std::max(t - 0.2, 0.0);
    object.push_back(0.06 * slid + 0.003 * std::sin(4.0 * std::numbers::pi * slid));
    force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce);
  }
  Contact contact = push_of(object, force, 0.2);
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
  Contact contact = push_of(object, force, 0.2);
  const std::vector<FrictionSample> samples = samples_of(contact);
  ASSERT_GE(samples.size(), 10U);
  for (const FrictionSample& sample : samples) {
    EXPECT_NEAR(sample.speed_change, 0.1 * 12.0 / kStiffness, 1e-6) << "at " << sample.t << " s";
  }
}

TEST(FrictionSamples, StateWhatTheContactsDampingChanges) {
  // The force swings by a tenth after the breakaway, four times a second, and the contact's
  // damping, which the law does not have, delays the compression: c d d' [m].
  constexpr double kRate = 8.0 * std::numbers::pi, kDamping = 5.0;  // [1/s], [s/m]
  std::vector<double> object, force;
  for (double t = 0.0; t < 1.5; t += kStep) {
    const double swing = t < 0.2 ? 0.0 : 3.0 * std::sin(kRate * (t - 0.2));
    force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce + swing);
    const double depth = force.back() / kStiffness;
    const double rate = t < 0.2 ? 0.0 : 3.0 * kRate * std::cos(kRate * (t - 0.2)) / kStiffness;
    object.push_back(0.04 * std::max(t - 0.2, 0.0) - kDamping * depth * rate);
  }
  Contact contact = push_of(object, force, 0.2);
  const std::vector<FrictionSample> samples = samples_of(contact, kDamping);
  ASSERT_GE(samples.size(), 10U);
  double missed = 0.0, unexplained = 0.0;
  for (const FrictionSample& sample : samples) {
    missed += std::pow(sample.acceleration, 2);
    unexplained += std::pow(sample.acceleration + sample.damping_acceleration_change, 2);
    EXPECT_NEAR(sample.speed + sample.damping_speed_change, 0.04, 2e-5) << sample.t << " s";
  }
  EXPECT_LT(unexplained, 0.01 * missed);
}

TEST(FrictionSamples, BeginAfterTheLoadingWhereNoBreakawayWasFound) {
  // The tip's mount gives way while the tip loads the object: that looks like a slide.
  std::vector<double> object, force;
  for (double t = 0.0; t < 2.0; t += kStep) {
    object.push_back(0.002 * t);
    force.push_back(t < 0.4 ? 1.2 * kSlidingForce * t / 0.4 : kSlidingForce);
  }
  Contact contact = push_of(object, force, 0.0);
  contact.breakaway.is_found = false;
  const std::vector<FrictionSample> samples = samples_of(contact);
  ASSERT_GE(samples.size(), 20U);
  EXPECT_GT(samples.front().t, 0.4);
  for (const FrictionSample& sample : samples) EXPECT_NEAR(sample.force, kSlidingForce, 1e-6);
}

TEST(FrictionSamples, OfASlowSlideHaveTheNoiseThatTheyShow) {
  const auto noise_of = [](double speed) {
    std::vector<double> object, force;
    Random random(3);
    double swing = 0.0;
    for (int i = 0; i < 1500; ++i) {
      // An error that differs from one smoothing to the next, but not from sample to sample.
      if (i % 20 == 0) swing = 1.5 * random.normal();
      const double t = kStep * i;
      object.push_back(speed * std::max(t - 0.2, 0.0));
      force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce + swing);
    }
    Contact contact = push_of(object, force, 0.2);
    const std::vector<FrictionSample> samples = samples_of(contact);
    return samples.empty() ? 0.0 : samples.back().force_std;
  };
  EXPECT_GT(noise_of(0.01), 0.3);
  // Friction at speed may differ from one sample to the next.
  EXPECT_LT(noise_of(0.06), 0.3);
}

TEST(FrictionSamples, LeaveOutASlideThatSticksAndSlips) {
  // Every 0.1 s the object stops, for less than the smoothing shows: its mean speed is steady.
  constexpr double kRate = 20.0 * std::numbers::pi;  // [1/s]
  for (const double swing : {0.5, 1.0}) {
    std::vector<double> object, force;
    for (double t = 0.0; t < 2.0; t += kStep) {
      const double slid = std::max(t - 0.2, 0.0);
      object.push_back(0.01 * (slid - swing * std::sin(kRate * slid) / kRate));
      force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce);
    }
    Contact contact = push_of(object, force, 0.2);
    EXPECT_EQ(samples_of(contact).empty(), swing == 1.0) << swing;
  }
}

/// A box that is pushed beside its centre, and turns: its centre moves at `kSpeed` along x.
struct TurningPush {
  static constexpr double kSpeed = 0.03, kRate = 0.2;      // [m/s], [rad/s]
  static constexpr double kLever = 0.03, kRadius = 0.005;  // [m] of the force; of the tip
  Contact contact;
  std::vector<Eigen::Vector3d> p_base_tip;
  CadModel model;
  std::vector<TrackedPose> tracked;

  explicit TurningPush(double tracked_until) {
    model.mesh_object = test::box_mesh({0.1F, 0.1F, 0.05F});
    std::vector<double> object, force;
    for (double t = 0.0; t < 1.5; t += kStep) {
      const double slid = std::max(t - 0.2, 0.0);
      object.push_back((kSpeed - kRate * kLever) * slid);
      force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce);
      p_base_tip.emplace_back(kSpeed * slid - 0.05 - kRadius, kLever, 0.0);
      if (t <= tracked_until) tracked.push_back({t, pose_at_slide(slid)});
    }
    contact = push_of(object, force, 0.2);
    contact.normal_object = -Eigen::Vector3d::UnitX();
    contact.lever = kLever;
  }

  [[nodiscard]] std::vector<FrictionSample> samples(std::optional<double> friction_radius) {
    const PathView tip(contact.t, p_base_tip);
    const ContactCompliance compliance{HuntCrossley{.stiffness = kStiffness, .exponent = 1.0}, 0.1};
    return friction_samples({&contact}, compliance, {model, tracked}, tip, kRadius,
                            {.friction_radius = friction_radius});
  }

 private:
  static Pose pose_at_slide(double slid) {
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(kRate * slid, Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(kSpeed * slid, 0.0, 0.0));
  }
};

TEST(FrictionSamples, DissipateByTheSupportsFrictionRadius) {
  TurningPush push(1.5);
  // All power goes into the translation of a support in one point.
  const std::vector<FrictionSample> point = push.samples(1e-6);
  ASSERT_GE(point.size(), 8U);
  const double share = 1.0 - TurningPush::kRate * TurningPush::kLever / TurningPush::kSpeed;
  for (const FrictionSample& sample : point) {
    EXPECT_NEAR(sample.force, share * kSlidingForce, 0.02 * kSlidingForce) << sample.t;
  }
  // A part of it goes into the rotation of a wide support.
  const std::vector<FrictionSample> wide = push.samples(0.06);
  ASSERT_EQ(wide.size(), point.size());
  for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_LT(wide[i].force, 0.98 * point[i].force);
}

/// A box that moves along a direction that is not the push's, and turns with its path; its speed is
/// modulated faster than its tracking, at 30 Hz, is smoothed.
struct ObliquePush {
  static constexpr double kSpeed = 0.06, kSwing = 0.038, kRate = 4.0 * std::numbers::pi;
  static constexpr double kRadius = 0.005;  // [m] of the tip
  Contact contact;
  std::vector<Eigen::Vector3d> p_base_tip;
  CadModel model;
  std::vector<TrackedPose> tracked;

  static double path_at(double t) {
    const double slid = std::max(t - 0.2, 0.0);
    return kSpeed * slid + kSwing / kRate * std::sin(kRate * slid);
  }
  static double speed_at(double t) { return kSpeed + kSwing * std::cos(kRate * (t - 0.2)); }
  static double acceleration_at(double t) { return -kSwing * kRate * std::sin(kRate * (t - 0.2)); }

  /// `angle` [rad] of the motion to the push, `curvature` [rad/m] of the heading over the path.
  ObliquePush(double angle, double curvature) {
    model.mesh_object = test::box_mesh({0.2F, 0.2F, 0.05F});
    const Eigen::Vector3d way(std::cos(angle), std::sin(angle), 0.0);
    const auto pose_at_path = [&](double path) {
      const Eigen::AngleAxisd turn(curvature * path, Eigen::Vector3d::UnitZ());
      return Pose(Eigen::Quaterniond(turn), path * way);
    };
    std::vector<double> object, force;
    for (double t = 0.0; t < 1.7; t += kStep) {
      const Pose T_base_object = pose_at_path(path_at(t));
      p_base_tip.push_back(T_base_object * Eigen::Vector3d(-0.1 - kRadius, 0.0, 0.0));
      object.push_back(p_base_tip.back().x());
      force.push_back(t < 0.2 ? kSlidingForce * t / 0.2 : kSlidingForce);
    }
    for (double t = 0.0; t < 1.9; t += 1.0 / 30.0) tracked.push_back({t, pose_at_path(path_at(t))});
    contact = push_of(object, force, 0.2);
    contact.normal_object = -Eigen::Vector3d::UnitX();
    for (Eigen::Vector3d& pushed : contact.force_base) pushed = kSlidingForce * way;
  }

  [[nodiscard]] std::vector<FrictionSample> samples() {
    const PathView tip(contact.t, p_base_tip);
    const ContactCompliance compliance{HuntCrossley{.stiffness = 1e7, .exponent = 1.0}, 0.1};
    contact.breakaway.stiffness = 1e7;
    return friction_samples({&contact}, compliance, {model, tracked}, tip, kRadius, {});
  }
};

TEST(FrictionSamples, AccelerateAlongTheMotionAndNotAlongThePush) {
  ObliquePush push(0.42, 0.0);
  const std::vector<FrictionSample> samples = push.samples();
  ASSERT_GE(samples.size(), 15U);
  double products = 0.0, squares = 0.0;
  for (const FrictionSample& sample : samples) {
    const double expected = ObliquePush::acceleration_at(sample.t);
    products += expected * sample.acceleration;
    squares += expected * expected;
    EXPECT_NEAR(sample.speed, ObliquePush::speed_at(sample.t), 0.004) << sample.t;
  }
  // The smoothing takes some per cent of a swing at 2 Hz.
  EXPECT_NEAR(products / squares, 1.0, 0.03);
}

TEST(FrictionSamples, AccelerateTheRotation) {
  constexpr double kCurvature = 2.0;  // [rad/m]
  ObliquePush straight(0.0, 0.0), turning(0.0, kCurvature);
  const std::vector<FrictionSample> without = straight.samples(), with = turning.samples();
  double products = 0.0, squares = 0.0;
  for (const FrictionSample& one : without) {
    for (const FrictionSample& other : with) {
      if (std::abs(one.t - other.t) > 1e-9) continue;
      // Per speed of the centre, not per mean speed of the support.
      products += one.acceleration * other.acceleration / (1.0 - other.rotation_share);
      squares += one.acceleration * one.acceleration;
    }
  }
  ASSERT_GT(squares, 0.0);
  const double square_radius = 0.2 * 0.2 / 6.0;  // [m^2] of gyration
  EXPECT_NEAR(products / squares, 1.0 + square_radius * kCurvature * kCurvature, 0.006);
}

TEST(FrictionSamples, OffTheCentreAreNoneWhereTheObjectIsNotTracked) {
  constexpr double kUntil = 0.9;  // [s]
  TurningPush push(kUntil);
  const std::vector<FrictionSample> off_centre = push.samples({});
  ASSERT_GE(off_centre.size(), 3U);
  EXPECT_LT(off_centre.back().t, kUntil);
  // The tip's motion is the object's in a push through the centre.
  push.contact.lever = 0.0;
  EXPECT_GT(push.samples({}).back().t, kUntil + 0.3);
}

}  // namespace
}  // namespace pcavr
