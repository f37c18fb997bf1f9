// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>
#include <numbers>
#include <optional>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/perception/scene/occupancy_map.hpp"
#include "pcavr/perception/scene/support_plane.hpp"

namespace pcavr {
namespace {

// Probabilities: OctoMap's defaults [Hornung et al. 2013, sec. 3 and 4].
using Occupancy = OccupancyOptions;
constexpr auto kOccupancyFields = std::to_array<OptionField<Occupancy>>({
    {"resolution", &Occupancy::resolution, 0.02, ranges::kOccupancyCell.min,
     ranges::kOccupancyCell.max, "m", "edge of an occupancy cell",
     "lower: half costs eight times the memory; higher: narrow passages are closed"},
    {"prob_hit", &Occupancy::prob_hit, 0.7, 0.51, 0.999, "",
     "probability that a cell is occupied in which a ray ends",
     "lower: more frames are needed to mark a cell; higher: single outliers mark cells"},
    {"prob_miss", &Occupancy::prob_miss, 0.4, 0.001, 0.49, "",
     "probability that a cell is occupied which a ray traverses",
     "lower: single bad rays clear cells; higher: more frames are needed to clear a cell"},
    {"clamping_min", &Occupancy::clamping_min, 0.1192, 0.001, 0.49, "",
     "lower bound of a cell's probability",
     "lower: things that appear late are marked late; higher: single outliers mark free cells"},
    {"clamping_max", &Occupancy::clamping_max, 0.971, 0.51, 0.999, "",
     "upper bound of a cell's probability",
     "lower: single bad rays clear cells; higher: things that were moved are cleared late"},
});
static_assert(are_valid_fields(kOccupancyFields));

using Support = SupportPlaneOptions;
constexpr auto kSupportFields = std::to_array<OptionField<Support>>({
    // Most objects slide above 15 degrees (friction 0.27).
    {"max_slope", &Support::max_slope, 15.0 * std::numbers::pi / 180.0, 0.01, 0.5, "rad",
     "maximum slope of a plane that supports bodies",
     "lower: tilted tables are not found; higher: slopes count as tables"},
    {"max_gap", &Support::max_gap, 0.03, 0.001, 0.5, "m",
     "maximum vertical distance between a body's lowest point and its plane",
     "lower: errors of pose and surface hide the plane; higher: a shelf nearby is taken"},
    {"search_margin", &Support::search_margin, 0.15, 0.01, 2.0, "m",
     "margin around a body within which its plane is searched",
     "lower: too little of the table is seen around the body; higher: other surfaces take part"},
    {"max_inlier_distance", &Support::max_inlier_distance, 0.01, 0.001, 0.2, "m",
     "maximum distance of a plane's points from it",
     "lower: rough or noisy tables are not found; higher: things on the table tilt the plane"},
    {"min_inlier_distance", &Support::min_inlier_distance, 0.003, 1e-4, 0.2, "m",
     "minimum of the distance that follows from the plane's noise",
     "lower: slightly bent tables are cut; higher: flat things on the table tilt the plane"},
    {"cluster_gap", &Support::cluster_gap, 0.03, 0.002, 1.0, "m",
     "gap between points up to which they are one surface",
     "lower: sparse tables fall apart; higher: tables next to each other are joined"},
    {"min_points", &Support::min_points, 30, 3, 1'000'000, "", "minimum number of a plane's points",
     "lower: small coincidental planes are found; higher: small supports are not found"},
});
static_assert(are_valid_fields(kSupportFields));

}  // namespace

OccupancyOptions::OccupancyOptions() : max_range(DepthNoise().max_depth) {
  set_defaults(*this, kOccupancyFields);
}

SupportPlaneOptions::SupportPlaneOptions() { set_defaults(*this, kSupportFields); }

OptionSection section_of(OccupancyOptions& options) {
  return make_section("scene.occupancy", options, kOccupancyFields);
}

OptionSection section_of(SupportPlaneOptions& options) {
  OptionSection section = make_section("scene.support_planes", options, kSupportFields);
  section.check = [&options]() -> std::optional<Error> {
    if (options.min_inlier_distance <= options.max_inlier_distance) return std::nullopt;
    return Error{.message = "min_inlier_distance is greater than max_inlier_distance",
                 .hint = "lower the first or raise the second"};
  };
  return section;
}

}  // namespace pcavr
