// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/robots/arm/arm_queries.hpp"
#include "pcavr/robots/arm/driven_arm.hpp"

namespace pcavr {
namespace {

constexpr auto kDriveFields = std::to_array<OptionField<DrivenArmOptions>>({
    // The bandwidth is for arms with gears: their first resonance is at 10 to 30 Hz.
    {"bandwidth", &DrivenArmOptions::bandwidth, 12.0, 0.5, 100.0, "Hz",
     "of the joint controller, undamped",
     "lower: the tip lags and gives way; higher: more torque than the joints have"},
    {"damping_ratio", &DrivenArmOptions::damping_ratio, 1.0, 0.1, 5.0, "",
     "of the joint controller", "lower: the tip overshoots; higher: it creeps to its target"},
    // Geared drives of small arms: without it a wrist would have less inertia than any controller
    // can hold.
    {"rotor_inertia_per_torque", &DrivenArmOptions::rotor_inertia_per_torque, 0.003, 0.0, 1.0,
     "kg m^2/(N m)",
     "rotor inertia, seen from the joint, over its torque limit, where neither the URDF's "
     "transmission states nor identification found one",
     "lower: wrists shake under the controller; higher: the arm is sluggish"},
});
static_assert(are_valid_fields(kDriveFields));

constexpr auto kQueryFields = std::to_array<OptionField<ArmQueryOptions>>({
    {"position_tolerance", &ArmQueryOptions::position_tolerance, 0.001, 1e-5, 0.1, "m",
     "distance of the tip to its target at which it is there",
     "lower: the last of the controller's lag counts; higher: answers are too hopeful"},
    {"max_deflection", &ArmQueryOptions::max_deflection, 0.005, 1e-5, 0.1, "m",
     "way that the tip may give under a force that it holds",
     "lower: the controller's stiffness decides; higher: the joints' torques alone"},
    {"hold_time", &ArmQueryOptions::hold_time, 1.0, 0.05, 60.0, "s",
     "for which a force is held, after half of that time to build it up",
     "lower: the arm has not settled; higher: computing time"},
    {"max_time", &ArmQueryOptions::max_time, 10.0, 0.1, 600.0, "s",
     "up to which a time is searched", "lower: slow motions are not found; higher: computing time"},
    {"run_up", &ArmQueryOptions::run_up, 0.05, 0.002, 1.0, "m",
     "path on which the tip pushes a body up to its speed",
     "lower: more force and torque; higher: more room"},
    {"clearance", &ArmQueryOptions::clearance, 0.01, 0.0, 0.5, "m",
     "least distance of the links to surfaces and each other",
     "lower: it may touch; higher: narrow ways are refused"},
});
static_assert(are_valid_fields(kQueryFields));

}  // namespace

DrivenArmOptions::DrivenArmOptions() { set_defaults(*this, kDriveFields); }
OptionSection section_of(DrivenArmOptions& options) {
  return make_section("arm.drive", options, kDriveFields);
}

ArmQueryOptions::ArmQueryOptions() { set_defaults(*this, kQueryFields); }
OptionSection section_of(ArmQueryOptions& options) {
  return make_section("arm.query", options, kQueryFields);
}

}  // namespace pcavr
