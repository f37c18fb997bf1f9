// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/physics/friction/limit_surface_fit.hpp"

namespace pcavr {
namespace {

constexpr auto kLimitSurfaceFields = std::to_array<OptionField<LimitSurfaceFitOptions>>({
    {"level_weight", &LimitSurfaceFitOptions::level_weight, 0.03, 1e-6, 100.0, "",
     "weight of a sample's distance from the surface relative to its direction",
     "lower: the surface's size is uncertain; higher: uneven supports distort its shape"},
    {"prior_weight", &LimitSurfaceFitOptions::prior_weight, 0.007, 0.0, 100.0, "",
     "weight of the fitted ellipsoid relative to all pushes together",
     "lower: arbitrary where pushes are missing; higher: the quartic is an ellipsoid"},
    {"given_prior_weight", &LimitSurfaceFitOptions::given_prior_weight, 1.0, 0.0, 100.0, "",
     "weight of the support's surface, as known from the CAD body, relative to all pushes together",
     "lower: errors of the contact point shape the surface; higher: uneven supports don't"},
    {"min_angle", &LimitSurfaceFitOptions::min_angle, 0.02, 1e-6, 1.0, "rad",
     "error of a twist's direction below which a sample gains no more weight: its noise",
     "lower: few samples decide; higher: outliers count"},
    {"min_spread", &LimitSurfaceFitOptions::min_spread, 0.02, 1e-6, 1.0, "",
     "spread of wrenches and twists out of a plane, over that within, to be excited",
     "lower: pushes along one plane give an arbitrary surface; higher: valid pushes are rejected"},
});
static_assert(are_valid_fields(kLimitSurfaceFields));

}  // namespace

LimitSurfaceFitOptions::LimitSurfaceFitOptions() : shape(SurfaceShape::quartic) {
  set_defaults(*this, kLimitSurfaceFields);
}
OptionSection section_of(LimitSurfaceFitOptions& options) {
  return make_section("friction.limit_surface", options, kLimitSurfaceFields);
}

}  // namespace pcavr
