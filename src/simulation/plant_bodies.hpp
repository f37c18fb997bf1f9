// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/simulation/plant.hpp"

#include "simulation/shapes.hpp"

namespace pcavr::simulation {

/// Boxes on the table with parameters from wide ranges: 0.8 to 6 kg, friction coefficient 0.2
/// to 1.1, penetration at breakaway 0.2 to 2 mm. Up to two stand far apart; more are small and
/// stand in a grid (box_grid.hpp).
[[nodiscard]] std::vector<PlantBody> sample_boxes(std::uint64_t seed, int count = 2);

/// A support as it is after years: a worn spot under the body, whose friction is lower by a third
/// to a half, and friction that depends on the load. The limits under the weight alone stay.
void wear_support(PlantBody& body, Random& random);

/// The foam-faced and the rubber-faced box of paper C.
[[nodiscard]] std::vector<PlantBody> paper_boxes(std::uint64_t seed);

/// Two of sample_boxes that are soft: a tip `depth` [m] deep needs 10 to 40 N.
[[nodiscard]] std::vector<PlantBody> soft_boxes(std::uint64_t seed, double depth);

/// Two of sample_boxes that are so soft that a tip is `min_depth` to `max_depth` [m] deep in them
/// when they begin to slide.
[[nodiscard]] std::vector<PlantBody> yielding_boxes(std::uint64_t seed, double min_depth,
                                                    double max_depth);

/// Two of sample_boxes, with a contact on which a tip of `mass` [kg] at `speed` [m/s] bounces
/// for 2.5 to 70 ms, with a restitution of 0.1 to 0.95.
[[nodiscard]] std::vector<PlantBody> struck_boxes(std::uint64_t seed, double speed, double mass);

/// A heavy block with a slot along its y, open above, a little wider than a tip of `tip_radius`.
[[nodiscard]] PlantBody slotted_block(std::uint64_t seed, double tip_radius);

/// A block with an oblique hole [paper B, fig. 7], beside its middle, so that a tip that is driven
/// into it along z slides and turns the block.
[[nodiscard]] PlantBody block_with_hole(std::uint64_t seed, double tip_radius);

/// The hole of block_with_hole, from its parts.
[[nodiscard]] ObliqueHole hole_of(const PlantBody& block);

/// Half extents of the bounding box of all parts [m]; bodies here are centred on their origin.
[[nodiscard]] Eigen::Vector3d half_extents_of(const PlantBody& body);

}  // namespace pcavr::simulation
