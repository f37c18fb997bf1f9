// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Time per cycle of the predicted world. Targets: a step of one body 2 us, of ten bodies in contact
// 100 us, rollback and re-simulation of 400 ms at 1 kHz 20 ms.
#include <benchmark/benchmark.h>

#include "pcavr/physics/prediction/predictor.hpp"

#include "prediction/scan_clutter.hpp"
#include "prediction/worlds.hpp"

namespace {

using pcavr::test::touching_tip;

constexpr double kStep = 0.001;  // [s]

/// Forward at 40 mm/s with a modulation; restarted before the body leaves the table.
Eigen::Vector3d pushing_tip(double t) {
  const double forward = 0.04 * t + 0.002 * std::sin(12.566 * t);
  return touching_tip(0.01) + Eigen::Vector3d(forward, 0.0, 0.0);
}

void push(benchmark::State& state, pcavr::PredictedWorld world, double from) {
  const std::vector<pcavr::BodyState> start = [&] {
    for (double t = 0.0; t < from; t += kStep) {
      world.step(pushing_tip(t), pushing_tip(t + kStep), kStep);
    }
    return world.state();
  }();
  constexpr int kSteps = 1000;
  std::vector<Eigen::Vector3d> tips;
  for (int i = 0; i <= kSteps; ++i) tips.push_back(pushing_tip(from + i * kStep));
  std::size_t step = 0;
  for (auto _ : state) {
    if (step == kSteps) {
      world.set_state(start);
      step = 0;
    }
    world.step(tips[step], tips[step + 1], kStep);
    ++step;
  }
  benchmark::DoNotOptimize(world.state().front().planar.position.x());
}

pcavr::PredictedWorld world_of(const pcavr::WorldModel& model) {
  return pcavr::PredictedWorld::create(model).value();
}

void OneBodySlides(benchmark::State& state) { push(state, world_of(pcavr::test::one_box()), 0.5); }
BENCHMARK(OneBodySlides);

void OneStiffBodySlides(benchmark::State& state) {
  pcavr::BodyPhysics physics = pcavr::test::foam_physics();
  physics.friction.mass = 0.3;
  physics.friction.limiting_force = 1.2;
  physics.friction.coulomb_force = 1.0;
  physics.contact = {1e6, 50.0, 1.0};
  push(state, world_of(pcavr::test::one_box(physics)), 0.5);
}
BENCHMARK(OneStiffBodySlides);

void OneBodyInStaticContact(benchmark::State& state) {
  pcavr::BodyPhysics physics = pcavr::test::foam_physics();
  physics.friction.limiting_force = 1000.0;
  push(state, world_of(pcavr::test::one_box(physics)), 0.01);
}
BENCHMARK(OneBodyInStaticContact);

void TenTouchingBodiesSlide(benchmark::State& state) {
  push(state, world_of(pcavr::test::row_of_boxes(10, 0.0)), 0.5);
}
BENCHMARK(TenTouchingBodiesSlide);

void TenBodiesFarApartOneSlides(benchmark::State& state) {
  push(state, world_of(pcavr::test::row_of_boxes(10, 0.5)), 0.5);
}
BENCHMARK(TenBodiesFarApartOneSlides);

void OneBodySlidesPastAScannedWall(benchmark::State& state) {
  pcavr::WorldModel model = pcavr::test::one_box();
  model.static_mesh_base = pcavr::test::wall_at(0.0875 + 0.03);
  push(state, world_of(model), 0.5);
}
BENCHMARK(OneBodySlidesPastAScannedWall);

/// 50 to 100 mm into the clutter: it turns, slides along and is pressed.
void OneBodyIsPushedIntoAScan(benchmark::State& state, std::string_view shape) {
  const pcavr::test::ScanPush scan{.shape = shape, .offset = 0.02, .noise = 0.001};
  pcavr::PredictedWorld world = world_of(pcavr::test::world_of(scan));
  const std::vector<pcavr::BodyState> start = world.state();
  constexpr double kEnd = 1.2;  // [s]
  double t = 0.0;
  for (auto _ : state) {
    if (t > kEnd) {
      world.set_state(start);
      t = 0.0;
    }
    world.step(pcavr::test::tip_at(scan, t), pcavr::test::tip_at(scan, t + kStep), kStep);
    t += kStep;
  }
}
BENCHMARK_CAPTURE(OneBodyIsPushedIntoAScan, cup, "cup");
BENCHMARK_CAPTURE(OneBodyIsPushedIntoAScan, plate, "plate");
BENCHMARK_CAPTURE(OneBodyIsPushedIntoAScan, box, "box");

void RollBackAndResimulate400ms(benchmark::State& state) {
  const auto start = pcavr::test::touching_tip(0.01);
  pcavr::Predictor predictor(world_of(pcavr::test::row_of_boxes(2, 0.001)), 0.0, start);
  for (int i = 1; i <= 900; ++i) predictor.step(pushing_tip(i * kStep));
  pcavr::Correction correction;
  correction.t = 0.5;
  correction.T_base_object = predictor.world().pose_of(0, *predictor.state_at(0, 0.5));
  for (auto _ : state) benchmark::DoNotOptimize(predictor.correct(correction));
}
BENCHMARK(RollBackAndResimulate400ms)->Unit(benchmark::kMillisecond);

void OneBodyIsFarAway(benchmark::State& state) {
  pcavr::WorldModel model = pcavr::test::one_box();
  model.bodies[0].T_base_object = pcavr::test::standing_at(2.0, 0.0);
  push(state, world_of(model), 0.01);
}
BENCHMARK(OneBodyIsFarAway);

}  // namespace
