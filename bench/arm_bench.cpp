// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// The time that an arm takes of a cycle of 1 ms: its distance to itself, to a scan of 300 000
// triangles, with and without the previous cycle's nearest triangle, and a whole step of the
// follower.
//
//     pcavr_bench_arm calib/robots/pa10/pa10.urdf
#include <cmath>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "robot/wavy_ground.hpp"

namespace pcavr {
namespace {

constexpr int kCells = 388;  ///< 2 x 388^2 = 301 088 triangles
constexpr double kReach = 2.0;
std::string description;

struct BenchedArm {
  BenchedArm()
      : model(read_urdf(description).value()),
        tip(default_tip(model)),
        meshes(link_meshes(model).value().of_link),
        q(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model.dof), 0.5)),
        collision(model, meshes, tip, q),
        kinematics(model) {}

  RobotModel model;
  std::size_t tip;
  std::vector<TriangleMesh> meshes;
  Eigen::VectorXd q;
  RobotCollision collision;
  RobotDynamics kinematics;
};

void distance_to_itself(benchmark::State& state) {
  BenchedArm arm;
  arm.kinematics.forward_kinematics(arm.q);
  for (auto _ : state) {
    arm.collision.place_links(arm.kinematics);
    benchmark::DoNotOptimize(arm.collision.distance_to_itself());
  }
  state.counters["pairs"] = static_cast<double>(arm.collision.pairs());
}
BENCHMARK(distance_to_itself)->Unit(benchmark::kMicrosecond);

/// `state.range(0)`: 0: random positions; 1: a path at 1 rad/s, 1 ms a step.
void distance_to_scan(benchmark::State& state) {
  BenchedArm arm;
  arm.collision.place_surface(arm.collision.add_surface(test::wavy_ground(kCells)),
                              Pose::from_translation({0.0, 0.0, -0.1}));
  Random random(1);
  double t = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    t += 0.001;
    for (Eigen::Index i = 0; i < arm.q.size(); ++i) {
      arm.q[i] =
          state.range(0) == 0 ? random.uniform(-1.0, 1.0) : std::sin(t + static_cast<double>(i));
    }
    arm.kinematics.forward_kinematics(arm.q);
    arm.collision.place_links(arm.kinematics);
    state.ResumeTiming();
    benchmark::DoNotOptimize(arm.collision.distance_to_surfaces(kReach));
  }
}
BENCHMARK(distance_to_scan)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// Inverse kinematics, two distances to the scan and to itself.
void follower_step(benchmark::State& state) {
  BenchedArm arm;
  ArmFollower follower(arm.model, arm.meshes, arm.tip, arm.q);
  follower.place_surface(follower.add_surface(test::wavy_ground(kCells)),
                         Pose::from_translation({0.0, 0.0, -0.1}));
  follower.reset();
  const Eigen::Vector3d start = follower.T_base_tip().translation();
  double t = 0.0;
  for (auto _ : state) {
    t += 0.001;
    const Eigen::Vector3d offset(0.05 * std::sin(3.0 * t), 0.05 * std::sin(2.0 * t),
                                 0.05 * std::sin(t));
    benchmark::DoNotOptimize(follower.follow(start + offset, 0.001));
  }
}
BENCHMARK(follower_step)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pcavr

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2 || !pcavr::read_urdf(argv[1])) {
    fmt::print(stderr, "usage: pcavr_bench_arm ROBOT.urdf\n");
    return 1;
  }
  pcavr::description = argv[1];
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
