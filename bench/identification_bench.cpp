// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// One step of the estimators and of the friction laws, as in a control loop. Baseline for affRLS:
// paper C's EWRLS (exponentially weighted recursive least squares) as published, in fixed-size
// Eigen, without bounds, scaling and adaptive forgetting factor lambda.
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <benchmark/benchmark.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/patch.hpp"
#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/friction/slider.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace {

struct Row {
  std::array<double, 3> phi;
  double force;
};

/// A pressed contact, m 0.5 kg, b 20 N s/m, k 3000 N/m, with noise of 0.1 N.
const std::vector<Row>& rows() {
  static const std::vector<Row> the_rows = [] {
    std::vector<Row> all;
    pcavr::Random random(1);
    for (int i = 0; i < 1024; ++i) {
      const double t = 0.002 * i;
      const Row row{
          {0.1 * std::sin(11.0 * t), 0.01 * std::cos(7.0 * t), 0.004 + 0.001 * std::sin(3.0 * t)},
          0.1 * random.normal()};
      all.push_back(row);
      all.back().force += 0.5 * row.phi[0] + 20.0 * row.phi[1] + 3000.0 * row.phi[2];
    }
    return all;
  }();
  return the_rows;
}

void EstimatorStep(benchmark::State& state, pcavr::EstimationMethod method) {
  pcavr::EstimatorOptions<3> options;
  options.method = method;
  options.scale = {0.1, 0.01, 0.004};
  options.noise_std = 0.1;
  pcavr::ParameterEstimator<3> estimator(options);
  std::size_t i = 0;
  for (auto _ : state) {
    const Row& row = rows()[i++ & 1023];
    benchmark::DoNotOptimize(estimator.step(row.phi, row.force));
  }
}
BENCHMARK_CAPTURE(EstimatorStep, affrls, pcavr::EstimationMethod::adaptive);
BENCHMARK_CAPTURE(EstimatorStep, ewrls, pcavr::EstimationMethod::exponential);
BENCHMARK_CAPTURE(EstimatorStep, bsls_of_30, pcavr::EstimationMethod::block);

void PlainEwrls(benchmark::State& state) {
  const double lambda = 0.98;
  Eigen::Vector3d theta = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = 1e6 * Eigen::Matrix3d::Identity();
  std::size_t i = 0;
  for (auto _ : state) {
    const Row& row = rows()[i++ & 1023];
    const Eigen::Map<const Eigen::Vector3d> phi(row.phi.data());
    const Eigen::Vector3d gain = P * phi / (lambda + phi.dot(P * phi));
    theta += gain * (row.force - phi.dot(theta));
    P = (P - gain * (phi.transpose() * P)).eval() / lambda;
    benchmark::DoNotOptimize(theta);
  }
}
BENCHMARK(PlainEwrls);

void FilterStep(benchmark::State& state) {
  pcavr::CausalFilter filter(0.014, 500.0, 0.2);
  int i = 0;
  for (auto _ : state) {
    const double t = 0.002 * ++i;
    benchmark::DoNotOptimize(filter.step(t, std::sin(t), std::cos(t)));
  }
}
BENCHMARK(FilterStep);

void SliderStep(benchmark::State& state) {
  const pcavr::FrictionParameters box{3.0, 9.57, 0.861, 8.0, 10.0};
  pcavr::SliderState slider;
  int i = 0;
  for (auto _ : state) {
    const double force = (++i & 255) < 160 ? 12.0 : 0.0;  // breaks loose, slides and stops
    slider = pcavr::step_slider(box, slider, {force, force}, 0.001).state;
    benchmark::DoNotOptimize(slider);
  }
}
BENCHMARK(SliderStep);

void PlanarStep(benchmark::State& state) {
  pcavr::PlanarFriction box;
  box.mass = 3.0;
  box.inertia = 0.0153;
  box.sliding = pcavr::ellipsoid_surface(8.0, 8.0 * pcavr::mean_radius_of_rectangle(0.175, 0.175));
  box.static_to_kinetic_ratio = 1.2;
  pcavr::PlanarState body;
  int i = 0;
  for (auto _ : state) {
    const double force = (++i & 255) < 160 ? 12.0 : 0.0;
    body = pcavr::step_planar(box, body, {force, 0.1 * force, 0.03 * force}, 0.001).state;
    benchmark::DoNotOptimize(body);
  }
}
BENCHMARK(PlanarStep);

void PushAtPoint(benchmark::State& state) {
  const pcavr::LimitSurface surface = pcavr::ellipsoid_surface(8.0, 0.5);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        pcavr::push_at_point(surface, {{-0.0875, 0.02}, {1.0, 0.0}, 0.3, {0.03, 0.005}}));
  }
}
BENCHMARK(PushAtPoint);

}  // namespace
