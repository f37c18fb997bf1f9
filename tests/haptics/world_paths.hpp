// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/tabletop.hpp"

namespace pcavr::test {

/// A closed path of a hand from the side of or above the box of one_box_on_a_table() into it, into
/// the table, or both, and back: at most 20 m/s^2.
class ClosedPathAtABox {
 public:
  static constexpr int kSteps = 800;

  explicit ClosedPathAtABox(Random& random) {
    const double angle = random.uniform(0.0, 2.0 * M_PI);
    const double far = random.uniform(0.11, 0.14);
    start_ = {far * std::cos(angle), far * std::sin(angle), random.uniform(0.012, 0.2)};
    const Eigen::Vector3d inside(random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06),
                                 random.uniform(-0.02, 0.12));
    displacement_ = random.uniform(0.2, 1.0) * (inside - start_);
    for (Eigen::Vector3d& wave : waves_) {
      wave = {random.uniform(-0.004, 0.004), random.uniform(-0.004, 0.004),
              random.uniform(-0.003, 0.003)};
    }
  }

  [[nodiscard]] Eigen::Vector3d operator()(int step) const {
    const double turn = 2.0 * M_PI * step / kSteps;
    Eigen::Vector3d p = start_ + 0.5 * (1.0 - std::cos(turn)) * displacement_;
    for (int i = 0; i < 4; ++i) p += std::sin((i + 1) * turn) / (i + 1) * waves_[i];
    return p;
  }

 private:
  Eigen::Vector3d start_;
  Eigen::Vector3d displacement_;
  Eigen::Vector3d waves_[4];
};

inline Work over_closed_paths(HapticWorld& world, int paths, std::uint64_t seed) {
  Random random(seed);
  Work work;
  for (int path = 0; path < paths; ++path) {
    const ClosedPathAtABox hand(random);
    world.reset(hand(0));
    if (world.state().p_base_proxy != hand(0)) continue;  // no room there
    Eigen::Vector3d tip = hand(0);
    double taken = 0.0;
    bool has_touched = false;
    for (int i = 0; i <= ClosedPathAtABox::kSteps; ++i) {
      const Eigen::Vector3d next = hand(i);
      // The device's force is constant until the next cycle (zero-order hold).
      taken -= world.state().force_base.dot(next - tip);
      tip = next;
      world.step({tip, true}, kCycle);
      has_touched |= world.state().touched_body.has_value();
    }
    work.min = std::min(work.min, taken);
    work.sum += taken;
    work.active += taken < 0.0 ? 1 : 0;
    work.touched += has_touched ? 1 : 0;
  }
  return work;
}

/// Variants of box, device and table: a soft, damped body; a stiff one; an immovable one.
inline HapticWorldModel contact_case(int which) {
  HapticWorldModel model = one_box_on_a_table(which == 2 ? 0.001 : 0.0003);
  BodyPhysics& physics = model.world.bodies[0].physics;
  if (which == 0) physics.contact = {16'000.0, 55'000.0, 1.45};
  if (which == 1) {
    physics.contact = {300'000.0, 800'000.0, 1.54};
    physics.friction.limiting_force = 40.0;
    physics.friction.coulomb_force = 34.0;
  }
  if (which == 2) physics.friction.limiting_force = 1000.0;
  if (which != 0) {
    model.force.max_force = 50.0;
  }
  return model;
}

}  // namespace pcavr::test
