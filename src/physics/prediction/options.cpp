// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/physics/prediction/predictor.hpp"

namespace pcavr {
namespace {

constexpr auto kPredictorFields = std::to_array<OptionField<PredictorOptions>>({
    {"step", &PredictorOptions::step, 0.001, 1e-4, 0.01, "s", "the operator's cycle",
     "lower: computing time; higher: stiff contacts are unstable to render"},
    {"history", &PredictorOptions::history, 2.0, 0.0, 60.0, "s", "maximum age of a correction",
     "lower: corrections over a slow link are rejected; higher: memory, and longer re-simulation"},
    {"blending", &PredictorOptions::blending, 0.1, 0.0, 10.0, "s",
     "time in which the displayed state converges to a corrected one",
     "lower: corrections are seen and felt as jumps; higher: the display lags behind"},
    // Two seconds of corrections at 60 Hz for four bodies.
    {"max_corrections", &PredictorOptions::max_corrections, 512, 1, 100'000, "",
     "corrections that are remembered for re-simulation",
     "lower: older ones are lost with many bodies or a fast tracker; higher: memory"},
});
static_assert(are_valid_fields(kPredictorFields));

constexpr auto kWorldFields = std::to_array<OptionField<WorldOptions>>({
    // No hand-guided arm moves at that speed.
    {"max_tip_speed", &WorldOptions::max_tip_speed, 5.0, 0.1, 100.0, "m/s",
     "speed above which the tip has jumped: it is placed, and does not push on its path",
     "lower: fast motions pass through bodies; higher: a jump of the tip hits bodies"},
    // No arm that pushes objects over a table exerts more.
    {"max_contact_force", &WorldOptions::max_contact_force, 2000.0, 1.0, 1e5, "N",
     "maximum force of the tip on a body",
     "lower: heavy bodies are not moved; higher: a tip that jumps into a body accelerates it away"},
    {"body_friction", &WorldOptions::body_friction, 0.3, 0.0, 10.0, "",
     "friction coefficient between bodies, and between bodies and the scan",
     "lower: bodies slip off each other; higher: they stick together"},
    {"body_penetration", &WorldOptions::body_penetration, 5e-5, 1e-6, 0.01, "m",
     "penetration of two bodies under the force at which one of them breaks loose",
     "lower: stiff contacts need more solver sweeps; higher: bodies visibly overlap"},
    {"max_separation_speed", &WorldOptions::max_separation_speed, 0.05, 0.001, 10.0, "m/s",
     "speed at which an overlap of two bodies is resolved",
     "lower: overlaps of a correction stay for long; higher: bodies jump apart"},
    {"min_obstacle_height", &WorldOptions::min_obstacle_height, 0.005, 0.0, 1.0, "m",
     "height above a body's lowest point below which the scan is the support and its noise",
     "lower: the support's noise stops bodies; higher: low edges do not stop them"},
    // Less than a depth camera resolves; contacts under the forces of an arm need a tenth of it.
    {"max_scan_penetration", &WorldOptions::max_scan_penetration, 0.0015, 1e-4, 0.1, "m",
     "penetration of the scan into a body at which the body stops, under any force",
     "lower: a scan's noise stops bodies that slide along it; higher: bodies visibly enter it"},
    {"max_scan_depth", &WorldOptions::max_scan_depth, 0.01, 1e-4, 1.0, "m",
     "depth inside a body from which a scanned surface is not in contact with it",
     "lower: errors of scan and pose lose contacts; higher: a scan of the body itself pushes it"},
    {"shape_tolerance", &WorldOptions::shape_tolerance, 0.02, 1e-4, 1.0, "",
     "depth of a concavity, over the body's diagonal, that is filled for its neighbours",
     "lower: more convex parts, computing time; higher: neighbours stop in front of concavities"},
    {"max_convex_parts", &WorldOptions::max_convex_parts, 16, 1, 256, "",
     "convex parts of a body's collision shape",
     "lower: concavities stay filled; higher: computing time"},
});
static_assert(are_valid_fields(kWorldFields));

constexpr auto kPhysicsFields = std::to_array<OptionField<PhysicsDefaults>>({
    // Wood, and filled boxes and tins.
    {"density", &PhysicsDefaults::density, 700.0, 1.0, 25000.0, "kg/m^3",
     "assumed density of the CAD body's volume",
     "lower: bodies move before they do in reality; higher: they seem too heavy"},
    // Rather too high: most dry pairs have 0.2 to 0.5.
    {"sliding_coefficient", &PhysicsDefaults::sliding_coefficient, 0.5, 0.001, 10.0, "",
     "assumed friction coefficient on the support",
     "lower: bodies move before they do in reality; higher: they stay at rest too long"},
    {"static_to_kinetic_ratio", &PhysicsDefaults::static_to_kinetic_ratio, 1.1, 1.0, 10.0, "",
     "assumed limiting static friction over Coulomb friction",
     "lower: bodies move before they do in reality; higher: they jerk when they break loose"},
    // The value is for metal on metal [Canudas de Wit et al. 1995, table 1]. Used for objects whose
    // F_M, coefficient and contact law with damping are known.
    {"stribeck_speed", &PhysicsDefaults::stribeck_speed, 0.001, 0.0, 1.0, "m/s",
     "assumed speed over which sliding friction falls from F_M to the Coulomb force; 0: at once",
     "lower: bodies stop late, under less force than they bear; higher: slow ones stop early"},
    // A smooth metal tip on most materials.
    {"tool_friction", &PhysicsDefaults::tool_friction, 0.3, 0.0, 10.0, "",
     "assumed friction coefficient between tip and body",
     "lower: the tip slips off faces; higher: it drags and turns bodies along"},
    {"penetration", &PhysicsDefaults::penetration, 1e-3, 1e-6, 0.1, "m",
     "assumed penetration of the tip when the body breaks loose",
     "lower: stiff contacts, hard to render; higher: bodies feel soft and begin to move late"},
    // The exponent of a sphere on a flat face [Hertz].
    {"contact_exponent", &PhysicsDefaults::contact_exponent, 1.5, 1.0, 3.0, "",
     "assumed exponent of the contact law", "lower: contact begins hard; higher: it begins soft"},
    {"damping_ratio", &PhysicsDefaults::damping_ratio, 0.2, 0.0, 10.0, "",
     "assumed damping ratio of a body on the contact's spring",
     "lower: bodies bounce off the tip; higher: contact feels viscous"},
    {"patch_height", &PhysicsDefaults::patch_height, 1e-3, 1e-6, 0.1, "m",
     "height above the lowest vertex up to which vertices touch the support",
     "lower: a slightly tilted pose stands on an edge; higher: rounded edges count as contact"},
});
static_assert(are_valid_fields(kPhysicsFields));

}  // namespace

PredictorOptions::PredictorOptions() { set_defaults(*this, kPredictorFields); }
OptionSection section_of(PredictorOptions& options) {
  return make_section("prediction.predictor", options, kPredictorFields);
}

WorldOptions::WorldOptions() { set_defaults(*this, kWorldFields); }
OptionSection section_of(WorldOptions& options) {
  return make_section("prediction.world", options, kWorldFields);
}

PhysicsDefaults::PhysicsDefaults() { set_defaults(*this, kPhysicsFields); }
OptionSection section_of(PhysicsDefaults& options) {
  return make_section("prediction.unknown_objects", options, kPhysicsFields);
}

}  // namespace pcavr
