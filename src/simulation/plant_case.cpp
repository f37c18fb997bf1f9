// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant_case.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/core/check.hpp"
#include "pcavr/core/gravity.hpp"
#include "pcavr/core/random.hpp"

#include "simulation/box_grid.hpp"
#include "simulation/plant_bodies.hpp"

namespace pcavr {
namespace {

using namespace simulation;

constexpr double kStandOff = 0.025;          ///< between tip and face before an approach [m]
constexpr double kNear = 0.0005;             ///< and when it begins to load [m]
constexpr double kHasGone = 5e-5;            ///< more than a box gives before it breaks away [m]
constexpr double kClearance = 0.025;         ///< of the tip over the highest body [m]
constexpr double kTravelSpeed = 0.9;         ///< [m/s]
constexpr double kTravelAcceleration = 5.0;  ///< [m/s^2]

/// Where a box is pushed, in its own frame: a point on a face, and what points out of it.
struct Spot {
  Eigen::Vector3d point;
  Eigen::Vector3d outward;
};

/// Strings moves together.
class Program {
 public:
  Program(const std::vector<PlantBody>& bodies, const PlantTool& tool)
      : bodies_(bodies), tool_(tool), high_(high_above(bodies, tool)) {}

  /// Height of the tip in base that clears all bodies [m].
  static double high_above(const std::vector<PlantBody>& bodies, const PlantTool& tool) {
    double top = 0.0;
    for (const PlantBody& body : bodies) top = std::max(top, 2.0 * half_extents_of(body).z());
    return top + tool.radius + kClearance;
  }

  /// In the middle of the face towards -y, `aside` [m] along x; as low as the box needs not to tip.
  [[nodiscard]] Spot behind(std::size_t body, double aside = 0.0) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return {{aside, -half.y(), height(body, half.y())}, -Eigen::Vector3d::UnitY()};
  }

  /// In the face towards +y, where a box is pushed back from.
  [[nodiscard]] Spot before(std::size_t body, double aside) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return {{aside, half.y(), height(body, half.y())}, Eigen::Vector3d::UnitY()};
  }

  /// In the face towards -x.
  [[nodiscard]] Spot beside(std::size_t body, double aside) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return {{-half.x(), aside, height(body, half.x())}, -Eigen::Vector3d::UnitX()};
  }

  void wait(double seconds) { moves_.back().dwell += seconds; }

  void lift() {
    add({.target = {0.0, 0.0, high_ - tool_.radius},
         .is_offset = true,
         .speed = kTravelSpeed,
         .acceleration = kTravelAcceleration});
  }

  /// Through the air to a place in the body's frame.
  void travel(std::size_t body, const Eigen::Vector3d& p_body) {
    Eigen::Vector3d above = p_body;
    above.z() = high_ - bodies_[body].T_base_object.translation().z();
    for (const Eigen::Vector3d& p : {above, p_body}) {
      add({.body = body, .target = p, .speed = kTravelSpeed, .acceleration = kTravelAcceleration});
    }
  }

  /// To a spot, `gap` [m] before it touches.
  void approach(std::size_t body, const Spot& spot, double gap, double speed) {
    add({.body = body,
         .target = spot.point + (tool_.radius + gap) * spot.outward,
         .speed = speed,
         .acceleration = 1.0});
  }

  void go(const ToolMove& move) { add(move); }

  void back_off(std::size_t body, const Spot& spot, double distance, double speed) {
    add({.body = body,
         .target = distance * spot.outward,
         .is_offset = true,
         .speed = speed,
         .acceleration = 1.0});
  }

  /// On the way to breakaway the tip goes at this speed [m/s] so that it takes `seconds`.
  [[nodiscard]] double loading_speed(std::size_t body, double seconds) const {
    const PlantParameters& p = bodies_[body].parameters;
    const double give =
        std::pow(p.limiting_static_friction / p.contact_stiffness, 1.0 / p.contact_exponent) +
        p.limiting_static_friction / tool_.stiffness;
    return give / seconds;
  }

  [[nodiscard]] const PlantBody& body(std::size_t index) const { return bodies_[index]; }
  [[nodiscard]] std::vector<ToolMove> take() { return std::move(moves_); }

 private:
  /// Of a push over the body's origin [m]: its middle, or lower where friction is high, so that the
  /// pressure's centre stays well inside of the base.
  [[nodiscard]] double height(std::size_t body, double half_along) const {
    const PlantBody& b = bodies_[body];
    const double half = half_extents_of(b).z();
    const double steep =
        b.parameters.limiting_static_friction / (b.parameters.mass * kStandardGravity);
    return std::max(tool_.radius + 0.005, std::min(half, 0.6 * half_along / steep)) - half;
  }

  void add(const ToolMove& move) { moves_.push_back(move); }

  const std::vector<PlantBody>& bodies_;
  const PlantTool& tool_;
  double high_;
  std::vector<ToolMove> moves_;
};

/// Down on the middle of the top, and up again.
void press(Program& program, std::size_t body, double radius, double speed, double depth,
           double max_force) {
  constexpr double kAbove = 0.006;  // room to reach the speed
  const Eigen::Vector3d top(0.0, 0.0, half_extents_of(program.body(body)).z() + radius);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  program.go({.body = body, .target = top + kAbove * up, .speed = 0.1});
  program.wait(0.15);
  program.go({.body = body,
              .target = top - depth * up,
              .speed = speed,
              .acceleration = 2.0,
              .until_force = max_force,
              .dwell = 0.25});
  program.go({.body = body, .target = top + kAbove * up, .speed = std::max(speed, 0.03)});
}

/// Above the middle of the top, ready to press.
void travel_above(Program& program, std::size_t body, double radius) {
  const double top = half_extents_of(program.body(body)).z() + radius;
  program.travel(body, {0.0, 0.0, top + 0.01});
}

void travel_behind(Program& program, std::size_t body, const Spot& spot, double radius) {
  program.travel(body, spot.point + (radius + kStandOff) * spot.outward);
}

/// Touches, loads so that it takes `seconds` to breakaway, and is on the way when the box goes; the
/// next move takes over after `reaction` [s].
void load_until_it_goes(Program& program, std::size_t body, const Spot& spot, double seconds,
                        double reaction) {
  const double speed = program.loading_speed(body, seconds);
  const double touch = 0.15 * program.body(body).parameters.limiting_static_friction;
  program.approach(body, spot, kNear, 0.1);
  const auto go = [&](double at_speed) -> ToolMove {
    return {.body = body,
            .target = 0.05 * -spot.outward,
            .is_offset = true,
            .speed = at_speed,
            .acceleration = 0.2,
            .flows_on = true};
  };
  ToolMove move = go(std::max(0.005, speed));
  move.until_force = touch;
  program.go(move);
  move = go(speed);
  move.until_moved = kHasGone;
  move.reaction = reaction;
  program.go(move);
}

/// Loads slowly until the box goes, follows it for some way, and lets go.
void break_away(Program& program, std::size_t body, const Spot& spot, double seconds,
                double reaction, double follow) {
  load_until_it_goes(program, body, spot, seconds, reaction);
  program.go({.body = body,
              .target = follow * -spot.outward,
              .is_offset = true,
              .speed = 0.015,
              .acceleration = 0.1,
              .dwell = 0.15});
  program.back_off(body, spot, 0.006, 0.05);
  program.wait(0.1);
}

void slide_modulated(Program& program, std::size_t body, const Spot& spot, double distance,
                     double swing) {
  load_until_it_goes(program, body, spot, 0.5, 0.0);
  program.go({.body = body,
              .target = distance * -spot.outward,
              .is_offset = true,
              .speed = 0.06,
              .acceleration = 0.3,
              .swing = swing,
              .swing_frequency = 2.0,
              .dwell = 0.2});
  program.back_off(body, spot, 0.01, 0.08);
}

/// The operator's push; by style straight on, with a stop in the middle, or slowing down.
void push(Program& program, std::size_t body, const Spot& spot, int style, double distance,
          double speed) {
  const Eigen::Vector3d onward = -spot.outward;
  load_until_it_goes(program, body, spot, 0.35, 0.0);
  ToolMove move{.body = body,
                .target = distance * onward,
                .is_offset = true,
                .speed = speed,
                .acceleration = 0.15,
                .swing_frequency = 0.8};
  if (style == 1) {
    move.target = 0.45 * distance * onward;
    program.go(move);
    program.wait(0.6);
    move.target = 0.55 * distance * onward;
  }
  if (style == 2) {
    // Down to a fifth of the speed and up again; the swing takes 0.8 s to grow and to fade.
    move.swing = 0.8 * speed / (2.0 * std::numbers::pi * move.swing_frequency);
    move.acceleration = speed / 0.8;
  }
  program.go(move);
  program.wait(0.3);
  program.back_off(body, spot, 0.03, 0.1);
}

/// Whoever aims at the middle of a face misses it by as much [m].
double aim_error(Random& random) { return 0.001 * random.normal(); }

/// A push with its way there takes longer than this [s].
constexpr double kMinPush = 1.0;

/// Each box in turn; in every second round back from the other side by as much as before, so that
/// the boxes stay about where they were however long it goes on.
void program_push(Program& program, double radius, Random& random, const PushOptions& options) {
  const auto count = static_cast<std::size_t>(options.boxes);
  const auto needed = static_cast<std::size_t>(std::ceil(options.duration / kMinPush));
  std::vector<double> distances(count);
  for (std::size_t i = 0; i < std::max(count, needed); ++i) {
    const std::size_t body = i % count;
    const bool is_back = i / count % 2 == 1;
    const double aside = aim_error(random);
    const Spot spot = is_back ? program.before(body, aside) : program.behind(body, aside);
    const int style = static_cast<int>(random.below(3));
    travel_behind(program, body, spot, radius);
    const bool is_grid = needs_grid(options.boxes);
    const double speed = is_grid ? random.uniform(0.02, 0.04) : random.uniform(0.02, 0.07);
    if (!is_back) {
      distances[body] =
          is_grid ? random.uniform(kMinGridPush, kMaxGridPush) : random.uniform(0.04, 0.08);
    }
    push(program, body, spot, style, distances[body], speed);
    program.lift();
  }
}

double press_limit(const PlantBody& body) {
  return std::clamp(1.5 * body.parameters.limiting_static_friction, 10.0, 40.0);
}

void program_probe(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    for (const double speed : {0.005, 0.015, 0.04}) {
      press(program, body, radius, speed, 0.006, press_limit(program.body(body)));
    }
    const Spot spot = program.behind(body, aim_error(random));
    travel_behind(program, body, spot, radius);
    for (int i = 0; i < 10; ++i) break_away(program, body, spot, 1.0, 0.15, 0.003);
    slide_modulated(program, body, spot, 0.09, 0.0035);
    program.lift();
  }
}

void program_press(Program& program, double radius) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    for (const double speed : {0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06}) {
      press(program, body, radius, speed, 0.002, 60.0);
    }
  }
}

void program_turn(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    const Eigen::Vector3d half = half_extents_of(program.body(body));
    // First the one way round from behind, then the other way, then from the side.
    const double places[] = {0.75, 0.45, 0.6, -0.7, -0.4, 0.25, 0.65, -0.55};
    for (int i = 0; i < 8; ++i) {
      const bool is_from_side = i >= 6;
      const double along = is_from_side ? half.y() : half.x();
      const double aside = (places[i] + random.uniform(-0.08, 0.08)) * along;
      const Spot spot = is_from_side ? program.beside(body, aside) : program.behind(body, aside);
      travel_behind(program, body, spot, radius);
      load_until_it_goes(program, body, spot, 0.4, 0.0);
      program.go({.body = body,
                  .target = random.uniform(0.02, 0.04) * -spot.outward,
                  .is_offset = true,
                  .speed = random.uniform(0.01, 0.04),
                  .acceleration = 0.1,
                  .dwell = 0.2});
      program.back_off(body, spot, 0.02, 0.1);
      program.lift();
    }
  }
}

void program_slot(Program& program, const PlantBody& block, double radius) {
  const double floor = block.parts[0].centre.z() + block.parts[0].half_extents.z();
  const double half_slot = block.parts[2].centre.x() - block.parts[2].half_extents.x();
  const double along = 0.6 * block.parts[2].half_extents.y();
  const double depth = floor + radius + 0.012;
  const double into = half_slot - radius + 0.0009;  // 0.9 mm beyond the first touch
  const double top = block.parts[2].centre.z() + block.parts[2].half_extents.z();
  program.travel(0, {0.0, -along, top + radius + 0.01});
  const auto go = [&](double x, double y, double z, double speed) {
    program.go({.body = 0, .target = {x, y, z}, .speed = speed, .acceleration = 0.5});
    program.wait(0.1);
  };
  go(0.0, -along, depth, 0.05);
  for (const double side : {1.0, -1.0}) {
    go(side * into, -side * along, depth, 0.01);
    go(side * into, side * along, depth, 0.03);
    go(0.0, side * along, depth, 0.02);
  }
  go(0.0, 0.0, depth, 0.05);
  go(0.0, 0.0, floor + radius - 0.001, 0.01);
  program.lift();
}

void program_paper(Program& program, double radius, Random& random) {
  for (std::size_t body = 0; body < 2; ++body) {
    travel_above(program, body, radius);
    press(program, body, radius, 0.02, 0.006, press_limit(program.body(body)));
    const Spot spot = program.behind(body, aim_error(random));
    travel_behind(program, body, spot, radius);
    for (int i = 0; i < 3; ++i) break_away(program, body, spot, 0.7, 0.05, 0.002);
    // Foam and box swing at 4.5 Hz: 3.5 mm would stop the box.
    slide_modulated(program, body, spot, 0.06, 0.0025);
    push(program, body, spot, 0, 0.04, 0.06);
    program.lift();
  }
}

std::vector<PlantBody> bodies_of(ToolTask task, std::uint64_t seed, double tip_radius,
                                 const PushOptions& push) {
  if (task == ToolTask::none) return {};
  if (task == ToolTask::slot) return {slotted_block(seed, tip_radius)};
  if (task == ToolTask::paper) return paper_boxes(seed);
  return drawn_boxes(seed, task == ToolTask::push ? push.boxes : 2);
}

}  // namespace

PlantCase make_plant_case(ToolTask task, std::uint64_t seed, const PushOptions& push) {
  PCAVR_REQUIRE(push.boxes >= 1 && push.boxes <= PushOptions::kMaxBoxes, push.boxes);
  PCAVR_REQUIRE(push.duration >= 0.0, push.duration);
  PlantCase made;
  made.bodies = bodies_of(task, seed, made.tool.radius, push);
  if (task == ToolTask::none) return made;
  Random arm = Random(seed).fork(40);
  made.tool.stiffness = arm.uniform(3e4, 1e5);
  made.tool.bandwidth = arm.uniform(10.0, 20.0);
  made.tool.p_base_start = {0.55, -0.55, Program::high_above(made.bodies, made.tool)};
  Random random = Random(seed).fork(41);
  Program program(made.bodies, made.tool);
  switch (task) {
    case ToolTask::push:
      program_push(program, made.tool.radius, random, push);
      break;
    case ToolTask::probe:
      program_probe(program, made.tool.radius, random);
      break;
    case ToolTask::press:
      program_press(program, made.tool.radius);
      break;
    case ToolTask::slot:
      program_slot(program, made.bodies[0], made.tool.radius);
      break;
    case ToolTask::turn:
      program_turn(program, made.tool.radius, random);
      break;
    case ToolTask::paper:
      program_paper(program, made.tool.radius, random);
      break;
    case ToolTask::none:
      break;
  }
  made.moves = program.take();
  return made;
}

}  // namespace pcavr
