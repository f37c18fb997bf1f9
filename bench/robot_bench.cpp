// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Forward and inverse dynamics of an arm against Orocos KDL and Bullet's btMultiBody, in one run, on
// the same random states. Each library works on a block of states in turn; the time is that of its
// fastest block, which other processes disturb least. Then each call by Google Benchmark.
//
//     pcavr_bench_robot [robot.urdf]     by default calib/robots/pa10/pa10.urdf
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pcavr/core/random.hpp"
#include "pcavr/robot/robot_dynamics.hpp"
#include "pcavr/robot/urdf.hpp"

#include "robot/bullet_peer.hpp"
#include "robot/kdl_peer.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kStates = 100;
constexpr int kBlocks = 400;

/// Positions, velocities, and accelerations or torques.
struct States {
  std::vector<Eigen::VectorXd> q;
  std::vector<Eigen::VectorXd> dq;
  std::vector<Eigen::VectorXd> x;
};

States random_states(std::size_t dof) {
  Random random(1);
  States states;
  for (auto* list : {&states.q, &states.dq, &states.x}) {
    for (std::size_t i = 0; i < kStates; ++i) {
      Eigen::VectorXd v(static_cast<Eigen::Index>(dof));
      for (double& number : v) number = random.uniform(-2.0, 2.0);
      list->push_back(v);
    }
  }
  return states;
}

using Call = std::function<void(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                const Eigen::VectorXd& x, Eigen::VectorXd& result)>;

/// Everything that is measured, on one robot.
struct Arm {
  explicit Arm(const RobotModel& model)
      : states(random_states(model.dof)),
        dynamics(model),
        kdl(model),
        bullet(model),
        mass(model.dof, model.dof),
        regressor(model.dof, 10 * model.joints.size()) {}

  States states;
  RobotDynamics dynamics;
  test::KdlPeer kdl;
  test::BulletPeer bullet;
  Eigen::MatrixXd mass;
  Eigen::MatrixXd regressor;
};

struct NamedCall {
  std::string name;
  Call call;
};

std::vector<NamedCall> calls_of(Arm& arm) {
  return {
      {"forward dynamics, pcavr",
       [&](auto& q, auto& dq, auto& x, auto& r) { arm.dynamics.forward_dynamics(q, dq, x, r); }},
      {"forward dynamics, KDL",
       [&](auto& q, auto& dq, auto& x, auto& r) { arm.kdl.forward_dynamics(q, dq, x, r); }},
      {"forward dynamics, Bullet",
       [&](auto& q, auto& dq, auto& x, auto& r) { arm.bullet.forward_dynamics(q, dq, x, r); }},
      {"inverse dynamics, pcavr",
       [&](auto& q, auto& dq, auto& x, auto& r) { arm.dynamics.inverse_dynamics(q, dq, x, r); }},
      {"inverse dynamics, KDL",
       [&](auto& q, auto& dq, auto& x, auto& r) { arm.kdl.inverse_dynamics(q, dq, x, r); }},
      {"mass matrix, pcavr",
       [&](auto& q, auto&, auto&, auto&) { arm.dynamics.mass_matrix(q, arm.mass); }},
      {"gravity, pcavr",
       [&](auto& q, auto&, auto&, auto& r) { arm.dynamics.gravity_torque(q, r); }},
      {"forward kinematics, pcavr", [&](auto& q, auto&, auto&, auto&) { arm.dynamics.forward_kinematics(q); }},
      {"regressor, pcavr",
       [&](auto& q, auto& dq, auto& x, auto&) { arm.dynamics.regressor(q, dq, x, arm.regressor); }},
  };
}

void run_block(const NamedCall& named, const States& states, Eigen::VectorXd& result) {
  for (std::size_t i = 0; i < kStates; ++i) {
    named.call(states.q[i], states.dq[i], states.x[i], result);
    benchmark::DoNotOptimize(result.data());
  }
}

/// [us] a call, by the fastest block; the libraries take turns.
std::vector<double> measure(const std::vector<NamedCall>& calls, const States& states,
                            std::size_t dof) {
  std::vector<double> fastest(calls.size(), 1e9);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(dof));
  for (int block = 0; block < kBlocks; ++block) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      run_block(calls[i], states, result);
      const std::chrono::duration<double, std::micro> taken =
          std::chrono::steady_clock::now() - start;
      fastest[i] = std::min(fastest[i], taken.count() / static_cast<double>(kStates));
    }
  }
  return fastest;
}

void print_ratios(const std::vector<NamedCall>& calls, const std::vector<double>& times) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    fmt::print("{:28} {:8.3f} us\n", calls[i].name, times[i]);
  }
  fmt::print("forward dynamics: {:.3f} of KDL's time, {:.3f} of Bullet's (at most 0.4, aim 0.2)\n",
             times[0] / times[1], times[0] / times[2]);
  fmt::print("inverse dynamics: {:.3f} of KDL's time (at most 0.35, aim 0.2)\n",
             times[3] / times[4]);
}

}  // namespace
}  // namespace pcavr

int main(int argc, char** argv) {
  using namespace pcavr;
  benchmark::Initialize(&argc, argv);
  const std::filesystem::path file =
      argc > 1 ? std::filesystem::path(argv[1]) : source_folder() / "calib/robots/pa10/pa10.urdf";
  const Expected<RobotModel> model = read_urdf(file, {.requires_inertia = true});
  if (!model) {
    fmt::print(stderr, "{}\n", model.error().to_string());
    return 1;
  }
  Arm arm(*model);
  const std::vector<NamedCall> calls = calls_of(arm);
  fmt::print("{}: {} joints\n", model->name, model->dof);
  print_ratios(calls, measure(calls, arm.states, model->dof));
  for (const NamedCall& named : calls) {
    benchmark::RegisterBenchmark(named.name.c_str(), [&](benchmark::State& state) {
      Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model->dof));
      for (auto _ : state) run_block(named, arm.states, result);
      state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kStates));
    });
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
