// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/placement.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// Two tracked bodies, 0.3 m apart in the scene, that are tracked where they are.
BodyPlacements sound_placement() {
  BodyPlacements placement{.contacts = 4, .elsewhere = 0, .bodies = {{}, {}}};
  for (std::size_t i = 0; i < 2; ++i) {
    placement.bodies[i].is_tracked = true;
    placement.bodies[i].distance_at_start = placement.bodies[i].nearest_distance = 0.002;
    placement.bodies[i].nearest_at_start = i;
  }
  return placement;
}

std::vector<InputBody> two_bodies() {
  std::vector<InputBody> bodies(2);
  bodies[0].name = "box_1";
  bodies[1].name = "box_2";
  return bodies;
}

TEST(Placement, IsNotContradictedByBodiesInTheirPlaces) {
  EXPECT_TRUE(placement_contradictions(two_bodies(), sound_placement()).empty());
}

TEST(Placement, IsContradictedByTracksThatBeginInEachOthersPlace) {
  BodyPlacements placement = sound_placement();
  for (std::size_t i = 0; i < 2; ++i) {
    placement.bodies[i].nearest_at_start = 1 - i;
    placement.bodies[i].distance_at_start = 0.3;
  }
  const std::vector<std::string> found = placement_contradictions(two_bodies(), placement);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("box_1 and box_2 begin in each other's place: 0.300 m"),
            std::string::npos)
      << found[0];
  // One of them alone was put elsewhere.
  placement.bodies[1].nearest_at_start = 1;
  EXPECT_TRUE(placement_contradictions(two_bodies(), placement).empty());
}

TEST(Placement, IsContradictedByABodyThatMovesInAContactElsewhere) {
  BodyPlacements placement = sound_placement();
  placement.bodies[1].moved_untouched = 0.043;
  placement.bodies[1].gap_untouched = 0.2;
  placement.bodies[1].t_untouched = 3.25;
  const std::vector<std::string> found = placement_contradictions(two_bodies(), placement);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].starts_with(
      "box_2 moves by 43 mm in the contact at t = 3.250 s, in which the tip is 0.200 m from it"))
      << found[0];
}

}  // namespace
}  // namespace pcavr
