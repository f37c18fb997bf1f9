// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/arm_case.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/simulation/plant_case.hpp"
#include "pcavr/simulation/sensors.hpp"

namespace pcavr {
namespace {

using simulation::arm_description;
using simulation::kArmTip;
using simulation::make_arm;

/// The arm presses on one box, twice, and leaves it.
struct ArmPress {
  PlantCase plant;
  PlantRun run;
};
const ArmPress& arm_press() {
  static const ArmPress press = [] {
    ArmPress made{make_plant_case(ToolTask::press, 3), {}};
    add_arm(made.plant, 3);
    made.plant.bodies.resize(1);
    std::erase_if(made.plant.moves, [](const ToolMove& move) { return move.body == 1U; });
    made.plant.moves.resize(8);
    made.run = run_plant(made.plant.bodies, made.plant.tool, made.plant.moves);
    return made;
  }();
  return press;
}

double max_force(const PlantRun& run) {
  double greatest = 0.0;
  for (const Eigen::Vector3d& force : run.force_base) greatest = std::max(greatest, force.norm());
  return greatest;
}

TEST(ArmDescription, HasTheTipAtTheEndOfTheStylus) {
  const auto model = parse_urdf(arm_description(0.01), "robot.urdf", {.requires_inertia = true});
  ASSERT_TRUE(model) << model.error().to_string();
  EXPECT_TRUE(model->warnings.empty());
  EXPECT_TRUE(model->link_index(kArmTip).has_value());
}

TEST(ArmPlant, PressesByItsOwnDynamics) {
  const PlantRun& run = arm_press().run;
  ASSERT_EQ(run.arm.size(), run.p_base_tip.size());
  EXPECT_GT(max_force(run), 5.0);
  EXPECT_LT(max_force(run), 100.0);
}

// The motors carry gravity and the contact, up to static friction, at rest with the tip pressing.
TEST(ArmPlant, MotorsCarryGravityAndTheContact) {
  const auto& [plant, run] = arm_press();
  const PlantArm& arm = *plant.tool.arm;
  const auto deepest =
      std::max_element(run.force_base.begin(), run.force_base.end(),
                       [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
  // The dwell after the descent: 100 ms later the tip rests.
  const auto step = static_cast<std::size_t>(deepest - run.force_base.begin()) + 100;
  const PlantArmState& state = run.arm[step];
  ASSERT_LT(state.dq.norm(), 2e-3);
  RobotDynamics dynamics(arm.actual);
  Eigen::VectorXd gravity(6);
  dynamics.gravity_torque(state.q, gravity);
  Matrix6Xd jacobian(6, 6);
  dynamics.jacobian(state.q, arm.tip, jacobian);
  const Eigen::VectorXd contact = jacobian.topRows<3>().transpose() * run.force_base[step];
  EXPECT_GT(contact.cwiseAbs().maxCoeff(), 2.0);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const PlantJoint& joint = arm.joints[static_cast<std::size_t>(k)];
    EXPECT_NEAR(state.tau[k], gravity[k] + contact[k], 1.1 * joint.static_friction) << k;
  }
}

// The logged tip is the encoders': it differs from the true one by the gears' deflection.
TEST(ArmPlant, TheLoggedTipLacksTheGearsDeflection) {
  const auto& [plant, run] = arm_press();
  const JointLog log = measured_joints(run, *plant.tool.arm, 3);
  const Trajectory tool = measured_tool(log, *plant.tool.arm);
  double greatest_free = 0.0;
  double greatest_pressed = 0.0;
  for (const auto& [stamp, pose] : tool.poses()) {
    const double t = stamp.seconds();
    const auto step = static_cast<std::size_t>(t / PlantRun::kStep + 0.5);
    const double error = (pose.translation() - run.p_base_tip[step]).norm();
    double& greatest = run.force_base[step].norm() > 1.0 ? greatest_pressed : greatest_free;
    greatest = std::max(greatest, error);
  }
  EXPECT_LT(greatest_free, 5e-5);
  EXPECT_GT(greatest_pressed, 5e-5);
  EXPECT_LT(greatest_pressed, 1e-3);
}

TEST(ArmPlant, EverySeedReachesItsBodies) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const ToolTask task : {ToolTask::press, ToolTask::slot, ToolTask::soft}) {
      PlantCase plant = make_plant_case(task, seed);
      add_arm(plant, seed);
      for (const PlantBody& body : plant.bodies) {
        Eigen::Vector3d above = body.T_base_object.translation();
        above.z() = plant.tool.p_base_start.z();
        EXPECT_NO_THROW((void)make_arm(seed, plant.tool.radius, above)) << seed;
      }
    }
  }
}

}  // namespace
}  // namespace pcavr
