// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"

namespace pcavr {
namespace {

constexpr auto kFrictionPriorFields = std::to_array<OptionField<FrictionPriors>>({
    {"max_viscous", &FrictionPriors::max_viscous, 40.0, 0.1, 1e4, "N s/m",
     "viscous friction, uniform from 0 to this",
     "lower: excludes greased or rubber supports; higher: slow pushes say less of Coulomb "
     "friction"},
    // Repeated pushes on dry tables differ by 2 to 5 %.
    {"scatter", &FrictionPriors::scatter, 0.02, 1e-4, 1.0, "",
     "std of friction from push to push and from place to place, as a share; its median",
     "lower: too confident on an uneven table; higher: many pushes are needed"},
    {"scatter_factor", &FrictionPriors::scatter_factor, 2.0, 1.01, 100.0, "",
     "factor by which that std may differ from its median: one std of its logarithm",
     "lower: the data can't correct the median; higher: two pushes alone decide it"},
    // Friction drifts as surfaces wear, warm up and gather dust.
    {"push_correlation", &FrictionPriors::push_correlation, 0.9, 0.0, 0.999, "",
     "maximum correlation of the friction of successive pushes; as likely as 0 and its half",
     "lower: many pushes seem to average out friction that drifts; higher: few pushes say less"},
    {"correlation_path", &FrictionPriors::correlation_path, 0.020, 1e-4, 1.0, "m",
     "travel over which friction varies with the place",
     "lower: samples of one place count as independent; higher: long slides count for little"},
    {"bias_std", &FrictionPriors::bias_std, 0.02, 0.0, 100.0, "N",
     "error of the force's bias in one push",
     "lower: too confident for light objects; higher: light objects are not identified"},
    {"stribeck_share", &FrictionPriors::stribeck_share, 0.04, 1e-4, 1.0, "",
     "share by which friction at rest exceeds that of fast sliding, with the same as its std",
     "lower: slow pushes overestimate Coulomb friction; higher: slow pushes say less of it"},
    {"stribeck_speed", &FrictionPriors::stribeck_speed, 0.003, 1e-5, 1.0, "m/s",
     "speed over which that excess falls off, as exp(-(v / this)^2) [Stribeck 1902]",
     "lower: slow pushes count as fast ones; higher: fast ones count as slow"},
    {"support_size_share", &FrictionPriors::support_size_share, 0.25, 1e-3, 10.0, "",
     "std of the support's size about that of the CAD body's lowest face",
     "lower: too confident where only the rim bears; higher: turning objects say less of friction"},
    {"min_coefficient", &FrictionPriors::min_coefficient, 0.02, 0.0, 1.0, "",
     "friction coefficient below which a mass by accelerations is not identified: no support "
     "without rollers or air has less",
     "lower: friction that varies during slow pushes resembles a large mass; higher: greased "
     "supports have no mass"},
    {"mass_share", &FrictionPriors::mass_share, 0.005, 1e-6, 1.0, "",
     "std of a weighed mass, as a share",
     "lower: too confident for a bad scale; higher: the coefficient is less certain"},
});
static_assert(are_valid_fields(kFrictionPriorFields));

constexpr auto kBreakawayPriorFields = std::to_array<OptionField<BreakawayPriors>>({
    // The ratio of sliding to limiting friction is mostly 0.6 to 1.
    {"excess", &BreakawayPriors::excess, 0.2, 1e-3, 10.0, "",
     "share by which the limiting static friction exceeds Coulomb friction; its median",
     "lower: fast pushes underestimate a high limit; higher: they overestimate a low one"},
    {"excess_factor", &BreakawayPriors::excess_factor, 2.5, 1.01, 100.0, "",
     "factor by which that share may differ from its median: one std of its logarithm",
     "lower: the data can't correct the median; higher: fast pushes say less of the limit"},
    // 1 to 50 um of metals [Armstrong-Helouvry et al. 1994].
    {"presliding", &BreakawayPriors::presliding, 5e-6, 1e-8, 1e-2, "m",
     "displacement before friction has its full limit; its median",
     "lower: creep before the breakaway seems a softer contact; higher: a softer contact creep"},
    {"presliding_factor", &BreakawayPriors::presliding_factor, 3.0, 1.01, 100.0, "",
     "factor by which that displacement may differ from its median: one std of its logarithm",
     "lower: the data can't correct the median; higher: fast pushes say less of the limit"},
    {"stribeck_factor", &BreakawayPriors::stribeck_factor, 2.0, 1.01, 100.0, "",
     "factor by which a breakaway's Stribeck speed may differ from "
     "`identification.friction_priors.stribeck_speed`: one std of its logarithm",
     "lower: the data can't correct the median; higher: fast pushes say less of the limit"},
    // Bristles slip before they are fully deflected [Canudas de Wit et al. 1995]; some
    // per cent of a fast load.
    {"max_shortfall", &BreakawayPriors::max_shortfall, 0.03, 0.0, 1.0, "",
     "share by which the peak may fall short of the limit: the more the faster the load",
     "lower: fast pushes underestimate the limit; higher: a limit above any force is possible"},
    // A line through the loading of a law with an exponent of 1 to 2.
    {"compliance_std", &BreakawayPriors::compliance_std, 0.3, 1e-3, 10.0, "",
     "std of the contact's compliance by a push's loading alone, as a share",
     "lower: too confident without presses; higher: fast pushes say less of the limit"},
    // A restitution of a half at 0.1 m/s is one of 5 [Hunt & Crossley 1975].
    {"damping_std", &BreakawayPriors::damping_std, 5.0, 1e-3, 1e3, "s/m",
     "std of the contact's damping over its stiffness, where no press shows it",
     "lower: too confident without presses; higher: fast pushes say less of the limit"},
    // Static friction grows with the time at rest and falls with the loading rate.
    {"rate_share", &BreakawayPriors::rate_share, 0.10, 0.0, 1.0, "",
     "std of the limiting static friction of an object that is loaded in no time, as a share",
     "lower: too confident in fast pushes; higher: fast pushes count for little"},
    {"rate_duration", &BreakawayPriors::rate_duration, 0.10, 1e-3, 100.0, "s",
     "duration of loading that halves that std",
     "lower: too confident in fast pushes; higher: slow pushes count for little"},
    // On simulated supports, worn and even, peaks lack nothing of the excess below 0.02, and a half
    // of it (0 to 0.9) beyond 0.08.
    {"turning_onset", &BreakawayPriors::turning_onset, 0.08, 1e-3, 10.0, "",
     "travel of the support's rim by turning, over that of its centre, from which on a breakaway's "
     "peak may hide all that the limiting static friction exceeds Coulomb friction by: the places "
     "of the support slip one after the other",
     "lower: pushes that hardly turn the object count for little; higher: too confident in pushes "
     "that turn it"},
});
static_assert(are_valid_fields(kBreakawayPriorFields));

}  // namespace

FrictionPriors::FrictionPriors() : gravity(kStandardGravity) {
  set_defaults(*this, kFrictionPriorFields);
}
OptionSection section_of(FrictionPriors& priors) {
  return make_section("identification.friction_priors", priors, kFrictionPriorFields);
}

BreakawayPriors::BreakawayPriors() { set_defaults(*this, kBreakawayPriorFields); }
OptionSection section_of(BreakawayPriors& priors) {
  return make_section("identification.breakaway_priors", priors, kBreakawayPriorFields);
}

}  // namespace pcavr
