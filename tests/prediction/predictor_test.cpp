// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/predictor.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using test::row_of_boxes;
using test::touching_tip;

PredictedWorld two_boxes() { return PredictedWorld::create(row_of_boxes(2, 0.01)).value(); }

Eigen::Vector3d tip_at(double t) {
  return touching_tip(0.01) + Eigen::Vector3d(0.04 * t + 0.002 * std::sin(12.0 * t), 0.0, 0.0);
}

Predictor predictor_until(double end, const PredictorOptions& options = {}) {
  Predictor predictor(two_boxes(), 0.0, tip_at(0.0), options);
  const auto steps = std::lround(end / options.step);
  for (long i = 1; i <= steps; ++i) predictor.step(tip_at(static_cast<double>(i) * options.step));
  return predictor;
}

bool same(const BodyState& a, const BodyState& b) {
  return a.planar.position == b.planar.position && a.planar.yaw == b.planar.yaw &&
         a.planar.twist == b.planar.twist && a.planar.phase == b.planar.phase &&
         a.tangential_deflection_base == b.tangential_deflection_base &&
         a.tool_force_base == b.tool_force_base && a.penetration == b.penetration &&
         a.phase == b.phase;
}

TEST(Predictor, TwoRunsGiveTheSameBits) {
  const Predictor a = predictor_until(1.5);
  const Predictor b = predictor_until(1.5);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(same(a.world().state()[i], b.world().state()[i])) << i;
  }
}

TEST(Predictor, RollbackAndResimulationGivesTheSameBits) {
  PredictedWorld world = two_boxes();
  for (int i = 0; i < 700; ++i) world.step(tip_at(0.001 * i), tip_at(0.001 * (i + 1)), 0.001);
  const std::vector<BodyState> saved = world.state();
  const auto resimulate = [&] {
    for (int i = 700; i < 1200; ++i) world.step(tip_at(0.001 * i), tip_at(0.001 * (i + 1)), 0.001);
    return world.state();
  };
  const std::vector<BodyState> once = resimulate();
  for (int i = 0; i < 50; ++i) world.step(tip_at(3.0), tip_at(3.0), 0.001);
  world.set_state(saved);
  const std::vector<BodyState> again = resimulate();
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(same(once[i], again[i])) << i;
}

/// The final state of a run in which the correction was known at its time.
std::vector<BodyState> run_with(const Correction& correction, double end) {
  PredictedWorld world = two_boxes();
  const auto steps = std::lround(end / 0.001);
  for (long i = 1; i <= steps; ++i) {
    world.step(tip_at(0.001 * static_cast<double>(i - 1)), tip_at(0.001 * static_cast<double>(i)),
               0.001);
    if (i != std::lround(correction.t / 0.001)) continue;
    const std::size_t body = correction.body;
    if (correction.physics) world.set_physics(body, *correction.physics);
    std::vector<BodyState> state = world.state();
    const Eigen::Vector3d twist = state[body].planar.twist;
    if (correction.T_base_object) {
      world.set_pose(body, *correction.T_base_object);
      state = world.state();
    }
    state[body].planar.twist = correction.twist.value_or(twist);
    if (!state[body].planar.twist.isZero(0.0)) state[body].planar.phase = FrictionPhase::sliding;
    world.set_state(state);
  }
  return world.state();
}

TEST(Predictor, ACorrectionIsAsIfItHadBeenKnownAtItsTime) {
  Correction correction;
  correction.t = 0.9;
  correction.body = 1;
  correction.T_base_object = test::standing_at(0.2, 0.01, 0.05);
  correction.physics = test::foam_physics();
  correction.physics->friction.coulomb_force = 6.0;
  for (const bool with_twist : {false, true}) {
    if (with_twist) correction.twist = Eigen::Vector3d(0.02, 0.001, 0.1);
    Predictor predictor = predictor_until(1.3);
    ASSERT_TRUE(predictor.correct(correction));
    const std::vector<BodyState> expected = run_with(correction, 1.3);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(same(predictor.world().state()[i], expected[i])) << i;
    }
  }
}

TEST(Predictor, CorrectingByWhatWasPredictedChangesNothing) {
  Predictor predictor = predictor_until(1.3);
  const std::vector<BodyState> before = predictor.world().state();
  Correction correction;
  correction.t = 0.8;
  correction.body = 0;
  correction.T_base_object = predictor.world().pose_of(0, *predictor.state_at(0, 0.8));
  ASSERT_TRUE(predictor.correct(correction));
  for (std::size_t i = 0; i < 2; ++i) {
    const PlanarState& after = predictor.world().state()[i].planar;
    EXPECT_LT((after.position - before[i].planar.position).norm(), 1e-9);
  }
}

TEST(Predictor, LaterCorrectionsAreReappliedAfterAnEarlierOneThatArrivesLate) {
  Predictor predictor = predictor_until(1.3);
  Correction late;
  late.t = 1.2;
  late.body = 1;
  late.T_base_object = test::standing_at(0.5, 0.3);
  ASSERT_TRUE(predictor.correct(late));
  Correction early;
  early.t = 0.7;
  early.body = 0;
  early.T_base_object = test::standing_at(0.03, 0.0);
  ASSERT_TRUE(predictor.correct(early));
  EXPECT_NEAR(predictor.state_at(1, 1.2)->planar.position.x(), 0.5, 1e-12);
  EXPECT_NEAR(predictor.state_at(0, 0.7)->planar.position.x(), 0.03, 1e-12);
}

TEST(Predictor, PhysicsAreValidFromTheirTimeOn) {
  Predictor predictor = predictor_until(1.3);
  Correction correction;
  correction.t = 1.0;
  correction.physics = test::foam_physics();
  correction.physics->friction.viscous = 20.0;
  const BodyState before = *predictor.state_at(0, 1.0);
  ASSERT_TRUE(predictor.correct(correction));
  EXPECT_TRUE(same(before, *predictor.state_at(0, 1.0)));
  EXPECT_EQ(predictor.world().physics(0).friction.viscous, 20.0);
  // The re-simulation after an earlier correction uses the physics of that time.
  Correction pose;
  pose.t = 0.5;
  pose.body = 1;
  pose.T_base_object = predictor.world().pose_of(1, *predictor.state_at(1, 0.5));
  ASSERT_TRUE(predictor.correct(pose));
  EXPECT_LT((predictor.state_at(0, 1.0)->planar.position - before.planar.position).norm(), 1e-9);
  EXPECT_EQ(predictor.world().physics(0).friction.viscous, 20.0);
}

TEST(Predictor, RejectsCorrectionsOutsideItsHistory) {
  PredictorOptions options;
  options.history = 0.5;
  Predictor predictor = predictor_until(1.0, options);
  Correction correction;
  correction.T_base_object = test::standing_at(0.5, 0.0);
  const std::vector<BodyState> before = predictor.world().state();
  for (const double t : {-1.0, 0.0, 0.49, 1.01, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    correction.t = t;
    EXPECT_FALSE(predictor.correct(correction)) << t;
    EXPECT_FALSE(predictor.state_at(0, t)) << t;
  }
  correction.t = 0.9;
  correction.body = 2;
  EXPECT_FALSE(predictor.correct(correction));
  correction.body = 0;
  correction.twist = Eigen::Vector3d(std::numeric_limits<double>::infinity(), 0.0, 0.0);
  EXPECT_FALSE(predictor.correct(correction));
  correction.twist.reset();
  correction.physics = test::foam_physics();
  correction.physics->contact.stiffness = -1.0;
  EXPECT_FALSE(predictor.correct(correction));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(same(before[i], predictor.world().state()[i]));
  correction.physics.reset();
  correction.t = 0.5;
  EXPECT_TRUE(predictor.correct(correction));
}

/// The maximum change of the display from one step to the next: position [m], force [N] and speed
/// [m/s].
struct Jumps {
  double position = 0.0;
  double force = 0.0;
  double speed = 0.0;
};

Jumps jumps_of(Predictor& predictor, int steps, int every, const Correction& correction) {
  Jumps jumps;
  ShownBody last = predictor.shown(0);
  double last_speed = 0.04;
  const double start = predictor.now();
  for (int i = 1; i <= steps; ++i) {
    if (i % every == 1) {
      Correction now = correction;
      now.t = predictor.now() - 0.4;
      predictor.correct(now);
    }
    predictor.step(tip_at(start + 0.001 * i));
    const ShownBody shown = predictor.shown(0);
    const double displacement = translation_distance(last.T_base_object, shown.T_base_object);
    jumps.position = std::max(jumps.position, displacement);
    jumps.force = std::max(jumps.force, (shown.force_base - last.force_base).norm());
    if (i > 1) jumps.speed = std::max(jumps.speed, std::abs(displacement / 0.001 - last_speed));
    last_speed = displacement / 0.001;
    last = shown;
  }
  return jumps;
}

TEST(Predictor, ShowsACorrectionWithoutAJump) {
  Correction correction;
  correction.T_base_object = test::standing_at(0.01, 0.003, 0.02);
  Predictor once = predictor_until(0.8);
  const Jumps one = jumps_of(once, 300, 1000, correction);
  // 1.9 times the mean speed of the change, about 10 mm in 100 ms, over 1 ms; and the push itself.
  EXPECT_LT(one.position, 0.4e-3);
  EXPECT_LT(one.force, 1.0);
  EXPECT_LT(one.speed, 0.02);
  Predictor often = predictor_until(0.8);
  const Jumps many = jumps_of(often, 300, 30, correction);
  EXPECT_LT(many.position, 0.8e-3);
  EXPECT_LT(many.force, 2.0);
}

TEST(Predictor, ShowsTheStateItselfAfterBlending) {
  Predictor predictor = predictor_until(0.8);
  Correction correction;
  correction.t = 0.6;
  correction.T_base_object = test::standing_at(0.02, 0.003, 0.02);
  const ShownBody before = predictor.shown(0);
  ASSERT_TRUE(predictor.correct(correction));
  EXPECT_LT(translation_distance(before.T_base_object, predictor.shown(0).T_base_object), 1e-12);
  EXPECT_LT((before.force_base - predictor.shown(0).force_base).norm(), 1e-9);
  for (int i = 1; i <= 100; ++i) predictor.step(tip_at(0.8 + 0.001 * i));
  EXPECT_LT(
      translation_distance(predictor.shown(0).T_base_object, predictor.world().T_base_object(0)),
      1e-15);
  PredictorOptions options;
  options.blending = 0.0;
  Predictor abrupt = predictor_until(0.8, options);
  ASSERT_TRUE(abrupt.correct(correction));
  EXPECT_LT(translation_distance(abrupt.shown(0).T_base_object, abrupt.world().T_base_object(0)),
            1e-15);
}

TEST(Predictor, ACorrectionIntoTheTipPushesTheBodyOutGently) {
  for (const double stiffness : {8000.0, 1e6}) {
    WorldModel model = test::one_box();
    model.bodies[0].physics.contact.stiffness = stiffness;
    Predictor predictor(PredictedWorld::create(model).value(), 0.0, touching_tip());
    for (int i = 1; i <= 500; ++i) predictor.step(touching_tip());
    Correction correction;
    correction.t = 0.3;
    correction.T_base_object = test::standing_at(-0.03, 0.0);  // the tip is 30 mm inside
    ASSERT_TRUE(predictor.correct(correction));
    const BodyState& state = predictor.world().state()[0];
    EXPECT_NEAR(state.planar.position.x(), 0.0, 0.0015);
    EXPECT_LT(state.planar.twist.norm(), 1e-6);
    EXPECT_LE(state.tool_force_base.norm(), 9.6);
  }
}

TEST(Predictor, BoundsItsHistory) {
  PredictorOptions options;
  options.history = 0.1;
  Predictor predictor = predictor_until(0.2, options);
  Correction correction;
  correction.physics = test::foam_physics();
  for (int i = 0; i < 1000; ++i) {
    correction.t = predictor.now() - 0.05;
    correction.physics->friction.viscous = 1.0 + i;
    ASSERT_TRUE(predictor.correct(correction));
    if (i % 4 == 0) predictor.step(tip_at(predictor.now() + 0.001));
  }
  EXPECT_EQ(predictor.world().physics(0).friction.viscous, 1000.0);
  EXPECT_FALSE(predictor.state_at(0, predictor.now() - 0.102));
  EXPECT_TRUE(predictor.state_at(0, predictor.now() - 0.1));
}

TEST(Predictor, RefusesOptionsOutOfTheirRange) {
  PredictorOptions options;
  options.step = 0.0;
  EXPECT_THROW(Predictor(two_boxes(), 0.0, tip_at(0.0), options), ContractError);
  options = {};
  options.blending = -1.0;
  EXPECT_THROW(Predictor(two_boxes(), 0.0, tip_at(0.0), options), ContractError);
}

}  // namespace
}  // namespace pcavr
