// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Forward and inverse dynamics of an arm against Orocos KDL and Bullet's btMultiBody, in one run,
// on the same random states. Each library works on a block of states in turn; the time is that of
// its fastest block, which other processes disturb least. Then each call by Google Benchmark.
//
//     pcavr_bench_robot calib/robots/pa10/pa10.urdf
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "robot/bullet_peer.hpp"
#include "robot/kdl_peer.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kStates = 100;
constexpr int kBlocks = 400;

/// Positions, velocities, and accelerations or torques.
struct States {
  std::vector<Eigen::VectorXd> q;
  std::vector<Eigen::VectorXd> dq;
  std::vector<Eigen::VectorXd> x;
  // The same for KDL, so that no copying is measured.
  std::vector<KDL::JntArray> kdl_q;
  std::vector<KDL::JntArray> kdl_dq;
  std::vector<KDL::JntArray> kdl_x;
};

std::vector<KDL::JntArray> to_kdl(const std::vector<Eigen::VectorXd>& vectors) {
  std::vector<KDL::JntArray> arrays;
  for (const Eigen::VectorXd& v : vectors) {
    arrays.emplace_back(static_cast<unsigned>(v.size()));
    arrays.back().data = v;
  }
  return arrays;
}

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
  states.kdl_q = to_kdl(states.q);
  states.kdl_dq = to_kdl(states.dq);
  states.kdl_x = to_kdl(states.x);
  return states;
}

/// Works on one of the states.
using Call = std::function<void(std::size_t state)>;

/// Everything that is measured, on one robot.
struct Arm {
  explicit Arm(const RobotModel& model)
      : states(random_states(model.dof)),
        dynamics(model),
        kdl(model),
        bullet(model),
        result(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.dof))),
        mass(model.dof, model.dof),
        regressor(model.dof, 10 * model.joints.size()) {}

  States states;
  RobotDynamics dynamics;
  test::KdlPeer kdl;
  test::BulletPeer bullet;
  Eigen::VectorXd result;
  Eigen::MatrixXd mass;
  Eigen::MatrixXd regressor;
};

struct NamedCall {
  std::string name;
  Call call;
};

std::vector<NamedCall> calls_of(Arm& arm) {
  const States& s = arm.states;
  RobotDynamics& d = arm.dynamics;
  return {
      {"forward dynamics, pcavr",
       [&](std::size_t i) { d.forward_dynamics(s.q[i], s.dq[i], s.x[i], arm.result); }},
      {"forward dynamics, KDL",
       [&](std::size_t i) { arm.kdl.forward_dynamics(s.kdl_q[i], s.kdl_dq[i], s.kdl_x[i]); }},
      {"forward dynamics, Bullet",
       [&](std::size_t i) { arm.bullet.forward_dynamics(s.q[i], s.dq[i], s.x[i], arm.result); }},
      {"inverse dynamics, pcavr",
       [&](std::size_t i) { d.inverse_dynamics(s.q[i], s.dq[i], s.x[i], arm.result); }},
      {"inverse dynamics, KDL",
       [&](std::size_t i) { arm.kdl.inverse_dynamics(s.kdl_q[i], s.kdl_dq[i], s.kdl_x[i]); }},
      {"mass matrix, pcavr", [&](std::size_t i) { d.mass_matrix(s.q[i], arm.mass); }},
      {"gravity, pcavr", [&](std::size_t i) { d.gravity_torque(s.q[i], arm.result); }},
      {"forward kinematics, pcavr", [&](std::size_t i) { d.forward_kinematics(s.q[i]); }},
      {"regressor, pcavr",
       [&](std::size_t i) { d.regressor(s.q[i], s.dq[i], s.x[i], arm.regressor); }},
  };
}

void run_block(const NamedCall& named) {
  for (std::size_t i = 0; i < kStates; ++i) {
    named.call(i);
    benchmark::ClobberMemory();
  }
}

/// [us] a call, by the fastest block; the libraries take turns.
std::vector<double> measure(const std::vector<NamedCall>& calls) {
  std::vector<double> fastest(calls.size(), 1e9);
  for (int block = 0; block < kBlocks; ++block) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      run_block(calls[i]);
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
  if (argc != 2) {
    fmt::print(stderr, "usage: pcavr_bench_robot ROBOT.urdf\n");
    return 1;
  }
  const Expected<RobotModel> model = read_urdf(argv[1], {.requires_inertia = true});
  if (!model) {
    fmt::print(stderr, "{}\n", model.error().to_string());
    return 1;
  }
  Arm arm(*model);
  const std::vector<NamedCall> calls = calls_of(arm);
  fmt::print("{}: {} joints\n", model->name, model->dof);
  print_ratios(calls, measure(calls));
  for (const NamedCall& named : calls) {
    benchmark::RegisterBenchmark(named.name.c_str(), [&](benchmark::State& state) {
      for (auto _ : state) run_block(named);
      state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kStates));
    });
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
