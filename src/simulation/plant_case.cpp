// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant_case.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

#include "simulation/arm_case.hpp"
#include "simulation/box_grid.hpp"
#include "simulation/impact_moves.hpp"
#include "simulation/plant_bodies.hpp"
#include "simulation/tool_program.hpp"

namespace pcavr {
namespace {

using namespace simulation;

constexpr double kStandoff = 0.025;              ///< between tip and face before an approach [m]
constexpr double kApproachGap = 0.0005;          ///< gap at which loading begins [m]
constexpr double kBreakawayDisplacement = 5e-5;  ///< above the presliding displacement [m]

constexpr std::uint64_t kVarietyStream = 300;  ///< and one for each body after it
/// Largest angle of a push from its face's normal [rad]: less than the tip's friction holds, for
/// most bodies.
constexpr double kMaxPushAngle = 12.0 * std::numbers::pi / 180.0;

/// Depth of the tip in a soft body [m]: a large deformation, more than the tip's radius.
constexpr double kSoftDepth = 0.015;

/// Distances of the tip's centre in a push near a corner [m]: from the side, and behind the face.
constexpr double kMinCornerDistance = 0.003;
constexpr double kMaxCornerDistance = 0.006;
constexpr double kMinCornerDepth = 0.01;
constexpr double kMaxCornerDepth = 0.015;

/// Presses down on the top face, `at` from its centre [m], and retracts.
void press(Program& program, std::size_t body, double radius, double speed, double depth,
           double max_force, const Eigen::Vector2d& at = Eigen::Vector2d::Zero()) {
  constexpr double kAbove = 0.006;  // to reach the speed
  const Eigen::Vector3d top(at.x(), at.y(), half_extents_of(program.body(body)).z() + radius);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  program.add({.body = body, .target = top + kAbove * up, .speed = 0.1});
  program.wait(0.15);
  program.add({.body = body,
               .target = top - depth * up,
               .speed = speed,
               .acceleration = 2.0,
               .until_force = max_force,
               .dwell = 0.25});
  program.add({.body = body, .target = top + kAbove * up, .speed = std::max(speed, 0.03)});
}

/// Travels to a point above the centre of the top face.
void travel_above(Program& program, std::size_t body, double radius) {
  const double top = half_extents_of(program.body(body)).z() + radius;
  program.travel(body, {0.0, 0.0, top + 0.01});
}

void travel_to_contact(Program& program, std::size_t body, const PushContact& contact,
                       double radius) {
  program.travel(body, contact.point + (radius + kStandoff) * contact.outward);
}

/// Makes contact, increases the load so that breakaway comes after `seconds`, and is still moving
/// at breakaway; the next move follows after `reaction_time` [s].
void load_until_breakaway(Program& program, std::size_t body, const PushContact& contact,
                          double seconds, double reaction_time) {
  const double speed = program.loading_speed(body, seconds);
  const double touch_force = 0.15 * program.body(body).parameters.limiting_static_friction;
  program.approach(body, contact, kApproachGap, 0.1);
  const auto forward = [&](double at_speed) -> ToolMove {
    return {.body = body,
            .target = 0.05 * -contact.outward,
            .is_offset = true,
            .speed = at_speed,
            .acceleration = 0.2,
            .blends_into_next = true};
  };
  ToolMove move = forward(std::max(0.005, speed));
  move.until_force = touch_force;
  program.add(move);
  move = forward(speed);
  move.until_moved = kBreakawayDisplacement;
  move.reaction_time = reaction_time;
  program.add(move);
}

/// Increases the load slowly until breakaway, follows the box for `follow` [m], and retracts.
void push_to_breakaway(Program& program, std::size_t body, const PushContact& contact,
                       double seconds, double reaction_time, double follow) {
  load_until_breakaway(program, body, contact, seconds, reaction_time);
  program.add({.body = body,
               .target = follow * -contact.outward,
               .is_offset = true,
               .speed = 0.015,
               .acceleration = 0.1,
               .dwell = 0.15});
  program.back_off(body, contact, 0.006, 0.05);
  program.wait(0.1);
}

void slide_modulated(Program& program, std::size_t body, const PushContact& contact,
                     double distance, double modulation_amplitude) {
  load_until_breakaway(program, body, contact, 0.5, 0.0);
  program.add({.body = body,
               .target = distance * -contact.outward,
               .is_offset = true,
               .speed = 0.06,
               .acceleration = 0.3,
               .modulation_amplitude = modulation_amplitude,
               .modulation_frequency = 2.0,
               .dwell = 0.2});
  program.back_off(body, contact, 0.01, 0.08);
}

/// The operator's push; by `style` steady, with a stop in the middle, or with a slow-down.
void push(Program& program, std::size_t body, const PushContact& contact, int style,
          double distance, double speed) {
  const Eigen::Vector3d push_direction = -contact.outward;
  load_until_breakaway(program, body, contact, 0.35, 0.0);
  ToolMove move{.body = body,
                .target = distance * push_direction,
                .is_offset = true,
                .speed = speed,
                .acceleration = 0.15,
                .modulation_frequency = 0.8};
  if (style == 1) {
    move.target = 0.45 * distance * push_direction;
    program.add(move);
    program.wait(0.6);
    move.target = 0.55 * distance * push_direction;
  }
  if (style == 2) {
    // The speed goes down to a fifth and up again; the modulation takes 0.8 s to grow and to fade.
    move.modulation_amplitude = 0.8 * speed / (2.0 * std::numbers::pi * move.modulation_frequency);
    move.acceleration = speed / 0.8;
  }
  program.add(move);
  program.wait(0.3);
  program.back_off(body, contact, 0.03, 0.1);
}

/// Error of an operator who aims at the centre of a face [m].
double aim_error(Random& random) { return 0.001 * random.normal(); }

/// A push with its approach takes longer than this [s].
constexpr double kMinPush = 1.0;

/// Pushes each box in turn; in every second round back from the other side by the same distance, so
/// that the boxes stay near their initial positions for any duration.
void add_push_moves(Program& program, double radius, Random& random, const PushOptions& options) {
  const auto count = static_cast<std::size_t>(options.boxes);
  const auto needed = static_cast<std::size_t>(std::ceil(options.duration / kMinPush));
  std::vector<double> distances(count);
  for (std::size_t i = 0; i < std::max(count, needed); ++i) {
    const std::size_t body = i % count;
    const bool is_back = i / count % 2 == 1;
    const double offset = aim_error(random);
    const PushContact contact =
        is_back ? program.plus_y_face(body, offset) : program.minus_y_face(body, offset);
    const int style = static_cast<int>(random.below(3));
    travel_to_contact(program, body, contact, radius);
    const bool is_grid = needs_grid(options.boxes);
    const double speed = is_grid ? random.uniform(0.02, 0.04) : random.uniform(0.02, 0.07);
    if (!is_back) {
      distances[body] =
          is_grid ? random.uniform(kMinGridPush, kMaxGridPush) : random.uniform(0.04, 0.08);
    }
    push(program, body, contact, style, distances[body], speed);
    program.lift();
  }
}

double press_limit(const PlantBody& body) {
  return std::clamp(1.5 * body.parameters.limiting_static_friction, 10.0, 40.0);
}

void add_probe_moves(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    for (const double speed : {0.005, 0.015, 0.04}) {
      press(program, body, radius, speed, 0.006, press_limit(program.body(body)));
    }
    const PushContact contact = program.minus_y_face(body, aim_error(random));
    travel_to_contact(program, body, contact, radius);
    for (int i = 0; i < 10; ++i) push_to_breakaway(program, body, contact, 1.0, 0.15, 0.003);
    slide_modulated(program, body, contact, 0.09, 0.0035);
    program.lift();
  }
}

void add_press_moves(Program& program, double radius) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    for (const double speed : {0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06}) {
      press(program, body, radius, speed, 0.002, 60.0);
    }
  }
}

/// B's soft ball.
void add_soft_moves(Program& program, double radius) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    for (const double speed : {0.01, 0.02, 0.03, 0.04, 0.05}) {
      press(program, body, radius, speed, kSoftDepth, 60.0);
    }
  }
}

/// Pushes of the -y face so close to a corner that the tip gets deeper than it is from the side.
void add_corner_moves(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    const double half_face = half_extents_of(program.body(body)).x();
    for (const double side : {1.0, -1.0, 1.0}) {
      const double offset =
          side * (half_face - random.uniform(kMinCornerDistance, kMaxCornerDistance));
      const PushContact contact = program.minus_y_face(body, offset);
      travel_to_contact(program, body, contact, radius);
      load_until_breakaway(program, body, contact, 0.6, 0.0);
      program.add({.body = body,
                   .target = random.uniform(0.02, 0.035) * -contact.outward,
                   .is_offset = true,
                   .speed = random.uniform(0.02, 0.04),
                   .acceleration = 0.1,
                   .dwell = 0.3});
      program.back_off(body, contact, 0.04, 0.1);
      program.lift();
    }
  }
}

void add_turn_moves(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    const Eigen::Vector3d half = half_extents_of(program.body(body));
    // First one direction of rotation from the -y face, then the other, then from the -x face.
    const double offsets[] = {0.75, 0.45, 0.6, -0.7, -0.4, 0.25, 0.65, -0.55};
    for (int i = 0; i < 8; ++i) {
      const bool is_from_side = i >= 6;
      const double along = is_from_side ? half.y() : half.x();
      const double offset = (offsets[i] + random.uniform(-0.08, 0.08)) * along;
      const PushContact contact =
          is_from_side ? program.minus_x_face(body, offset) : program.minus_y_face(body, offset);
      travel_to_contact(program, body, contact, radius);
      load_until_breakaway(program, body, contact, 0.4, 0.0);
      program.add({.body = body,
                   .target = random.uniform(0.02, 0.04) * -contact.outward,
                   .is_offset = true,
                   .speed = random.uniform(0.01, 0.04),
                   .acceleration = 0.1,
                   .dwell = 0.2});
      program.back_off(body, contact, 0.02, 0.1);
      program.lift();
    }
  }
}

void add_slot_moves(Program& program, const PlantBody& block, double radius) {
  const double floor = block.parts[0].centre.z() + block.parts[0].half_extents.z();
  const double half_slot = block.parts[2].centre.x() - block.parts[2].half_extents.x();
  const double along = 0.6 * block.parts[2].half_extents.y();
  const double depth = floor + radius + 0.012;
  const double wall_offset = half_slot - radius + 0.0009;  // 0.9 mm beyond first contact
  const double top = block.parts[2].centre.z() + block.parts[2].half_extents.z();
  program.travel(0, {0.0, -along, top + radius + 0.01});
  const auto move_to = [&](double x, double y, double z, double speed) {
    program.add({.body = 0, .target = {x, y, z}, .speed = speed, .acceleration = 0.5});
    program.wait(0.1);
  };
  move_to(0.0, -along, depth, 0.05);
  for (const double side : {1.0, -1.0}) {
    move_to(side * wall_offset, -side * along, depth, 0.01);
    move_to(side * wall_offset, side * along, depth, 0.03);
    move_to(0.0, side * along, depth, 0.02);
  }
  move_to(0.0, 0.0, depth, 0.05);
  move_to(0.0, 0.0, floor + radius - 0.001, 0.01);
  program.lift();
}

/// Paper B's contact experiment, pushes for the friction, and twice along z down to the floor of
/// the hole: the tip slides along the wall that lies below it, and pushes the block aside.
void add_hole_moves(Program& program, const PlantBody& block, double radius, Random& random) {
  constexpr double kMaxForce = 90.0;  // [N] of B's hole slotting
  const ObliqueHole hole = hole_of(block);
  const double top = half_extents_of(block).z() + radius;
  const Eigen::Vector2d aside(0.0, -hole.mouth.y());
  program.travel(0, {aside.x(), aside.y(), top + 0.01});
  for (const double speed : {0.005, 0.015, 0.04}) {
    press(program, 0, radius, speed, 0.002, 60.0, aside);
  }
  const PushContact contact = program.minus_y_face(0, aim_error(random));
  travel_to_contact(program, 0, contact, radius);
  for (int i = 0; i < 3; ++i) push_to_breakaway(program, 0, contact, 0.7, 0.05, 0.002);
  slide_modulated(program, 0, contact, 0.06, 0.0025);
  program.lift();
  const double depth = half_extents_of(block).z() - hole.floor;
  for (const double speed : {0.02, 0.05}) {
    program.travel(0, {hole.mouth.x(), hole.mouth.y(), top + 0.004});
    program.add({.target = {0.0, 0.0, -depth - 0.002},
                 .is_offset = true,
                 .speed = speed,
                 .acceleration = 0.5,
                 .dwell = 0.2});
    program.add({.target = {0.0, 0.0, -0.02},
                 .is_offset = true,
                 .speed = 0.01,
                 .acceleration = 0.5,
                 .until_force = kMaxForce,
                 .dwell = 0.3});
    program.add({.target = {0.0, 0.0, depth + 0.02}, .is_offset = true, .speed = 0.05});
  }
  program.lift();
}

void add_paper_moves(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    press(program, body, radius, 0.02, 0.006, press_limit(program.body(body)));
    const PushContact contact = program.minus_y_face(body, aim_error(random));
    travel_to_contact(program, body, contact, radius);
    for (int i = 0; i < 3; ++i) push_to_breakaway(program, body, contact, 0.7, 0.05, 0.002);
    // Foam and box oscillate at 4.5 Hz: 3.5 mm would stop the box.
    slide_modulated(program, body, contact, 0.06, 0.0025);
    push(program, body, contact, 0, 0.04, 0.06);
    program.lift();
  }
}

std::vector<PlantBody> bodies_of(ToolTask task, std::uint64_t seed, double tip_radius,
                                 const PushOptions& push) {
  if (task == ToolTask::none) return {};
  if (task == ToolTask::slot) return {slotted_block(seed, tip_radius)};
  if (task == ToolTask::hole) return {block_with_hole(seed, tip_radius)};
  if (task == ToolTask::paper) return paper_boxes(seed);
  if (task == ToolTask::soft) return soft_boxes(seed, kSoftDepth);
  if (task == ToolTask::corner) {
    return yielding_boxes(seed, tip_radius + kMinCornerDepth, tip_radius + kMaxCornerDepth);
  }
  if (task == ToolTask::impact) return struck_boxes(seed, kImpactSpeed, kStrikerMass);
  return sample_boxes(seed, task == ToolTask::push ? push.boxes : 2);
}

}  // namespace

PlantCase make_plant_case(ToolTask task, std::uint64_t seed, const PushOptions& push,
                          PlantVariety variety) {
  PCAVR_REQUIRE(push.boxes >= 1 && push.boxes <= PushOptions::kMaxBoxes, push.boxes);
  PCAVR_REQUIRE(push.duration >= 0.0, push.duration);
  PlantCase made;
  made.bodies = bodies_of(task, seed, made.tool.radius, push);
  if (task == ToolTask::none) return made;
  Random arm = Random(seed).fork(40);
  made.tool.stiffness = arm.uniform(3e4, 1e5);
  made.tool.bandwidth = arm.uniform(10.0, 20.0);
  if (task == ToolTask::impact) {
    made.tool = striking_tool(made.tool);
    made.substeps = kImpactSubsteps;
  }
  made.tool.p_base_start = {0.55, -0.55, Program::travel_height(made.bodies, made.tool)};
  Random random = Random(seed).fork(41);
  Program program(made.bodies, made.tool);
  if (variety == PlantVariety::wide) {
    for (std::size_t i = 0; i < made.bodies.size(); ++i) {
      Random of_body = Random(seed).fork(kVarietyStream + i);
      wear_support(made.bodies[i], of_body);
      program.turn_pushes(of_body.uniform(-kMaxPushAngle, kMaxPushAngle));
    }
  }
  switch (task) {
    case ToolTask::push:
      add_push_moves(program, made.tool.radius, random, push);
      break;
    case ToolTask::probe:
      add_probe_moves(program, made.tool.radius, random);
      break;
    case ToolTask::press:
      add_press_moves(program, made.tool.radius);
      break;
    case ToolTask::slot:
      add_slot_moves(program, made.bodies[0], made.tool.radius);
      break;
    case ToolTask::hole:
      add_hole_moves(program, made.bodies[0], made.tool.radius, random);
      break;
    case ToolTask::turn:
      add_turn_moves(program, made.tool.radius, random);
      break;
    case ToolTask::corner:
      add_corner_moves(program, made.tool.radius, random);
      break;
    case ToolTask::paper:
      add_paper_moves(program, made.tool.radius, random);
      break;
    case ToolTask::soft:
      add_soft_moves(program, made.tool.radius);
      break;
    case ToolTask::impact:
      add_impact_moves(program, made.tool.radius);
      break;
    case ToolTask::none:
      break;
  }
  made.moves = program.take();
  return made;
}

void add_arm(PlantCase& plant, std::uint64_t seed) {
  PCAVR_REQUIRE(!plant.bodies.empty());
  // The tip starts above the first body; the arm does not reach the start of other tasks.
  const Eigen::Vector3d& body = plant.bodies.front().T_base_object.translation();
  plant.tool.p_base_start.head<2>() = body.head<2>();
  plant.tool.arm = make_arm(seed, plant.tool.radius, plant.tool.p_base_start);
}

}  // namespace pcavr
