// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"

namespace pcavr {
namespace {

using IkOptions = InverseKinematicsOptions;

constexpr auto kIkFields = std::to_array<OptionField<IkOptions>>({
    // Below the repeatability of any arm.
    {"position_tolerance", &IkOptions::position_tolerance, 1e-5, 1e-10, 0.1, "m",
     "position error at which a target counts as reached",
     "lower: more iterations; higher: the tip stops beside the target"},
    {"rotation_tolerance", &IkOptions::rotation_tolerance, 1e-4, 1e-10, 1.0, "rad",
     "rotation error at which a target counts as reached",
     "lower: more iterations; higher: the tip stays tilted"},
    // The length of a tool or wrist: what a rotation moves.
    {"rotation_length", &IkOptions::rotation_length, 0.2, 0.01, 10.0, "m/rad",
     "position error that weighs as much as a rotation error of 1 rad",
     "lower: position first where both cannot be had; higher: rotation first"},
    {"singular_value", &IkOptions::singular_value, 0.02, 1e-4, 1.0, "m/rad",
     "singular value of the Jacobian below which its direction is damped",
     "lower: fast joints near singularities; higher: slow convergence in more poses"},
    {"max_damping", &IkOptions::max_damping, 0.02, 1e-4, 1.0, "m/rad", "damping in a singularity",
     "lower: large steps of the joints there; higher: slow there"},
    {"max_step", &IkOptions::max_step, 0.3, 0.001, 3.0, "rad or m",
     "maximum motion of a joint in an iteration",
     "lower: more iterations; higher: the linearisation no longer holds, steps overshoot"},
    {"centring_gain", &IkOptions::centring_gain, 0.5, 0.0, 1.0, "",
     "fraction of the way to the middle of its range in an iteration, for the joint with the "
     "narrowest "
     "one, as far as the pose leaves it free",
     "lower: redundant joints drift to their limits; higher: they move more than the task needs"},
    {"max_iterations", &IkOptions::max_iterations, 150, 1, 100'000, "", "iterations from one start",
     "lower: far targets are missed; higher: computing time"},
    {"max_restarts", &IkOptions::max_restarts, 30, 0, 10'000, "",
     "random positions to start from where the given one gets stuck",
     "lower: reachable targets are missed behind limits; higher: computing time if out of reach"},
});
static_assert(are_valid_fields(kIkFields));

constexpr auto kArmFields = std::to_array<OptionField<ArmFollowerOptions>>({
    // Capsules contain the links, and a cycle moves a joint by some 3 mm at most.
    {"stop_distance", &ArmFollowerOptions::stop_distance, 0.01, 0.001, 0.5, "m",
     "distance of a link to the scan, to a body or to another link at which the arm stops",
     "lower: a joint at full speed may pass it in a cycle; higher: the arm can't reach into gaps"},
    {"shown_distance", &ArmFollowerOptions::shown_distance, 0.3, 0.01, 2.0, "m",
     "distance up to which the nearest pair is searched and shown",
     "lower: no distance is shown; higher: computing time"},
});
static_assert(are_valid_fields(kArmFields));

}  // namespace

InverseKinematicsOptions::InverseKinematicsOptions() { set_defaults(*this, kIkFields); }
OptionSection section_of(InverseKinematicsOptions& options) {
  return make_section("robot.inverse_kinematics", options, kIkFields);
}

ArmFollowerOptions::ArmFollowerOptions() { set_defaults(*this, kArmFields); }
OptionSection section_of(ArmFollowerOptions& options) {
  return make_section("robot.arm", options, kArmFields);
}

}  // namespace pcavr
