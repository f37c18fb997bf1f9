// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/push.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/core/random.hpp"

#include "simulation/layout.hpp"

namespace pcavr::simulation {
namespace {

constexpr double kGravity = 9.81;    ///< [m/s^2]
constexpr int kSubsteps = 20;        ///< in a step: 50 us, a thousandth of the contact's swing
constexpr double kPressedTo = 0.96;  ///< of the indentation at breakaway: friction is then critical

PushParameters draw_parameters(double mass, Random& random) {
  PushParameters p;
  p.mass = mass;
  // Wood, card and plastic on a table.
  const double static_coefficient = random.uniform(0.25, 0.55);
  p.limiting_static_friction = static_coefficient * mass * kGravity;
  p.sliding_friction_coefficient = random.uniform(0.80, 0.87) * static_coefficient;
  p.viscous_friction = random.uniform(8.0, 20.0);
  // A rubber tip that gives by less than a millimetre before the box moves.
  const double indentation = random.uniform(0.0005, 0.0009);
  p.contact_stiffness = p.limiting_static_friction / std::pow(indentation, p.contact_exponent);
  p.contact_damping = random.uniform(2.5, 4.0) * p.contact_stiffness;
  return p;
}

double indentation_at_breakaway(const PushParameters& p) {
  return std::pow(p.limiting_static_friction / p.contact_stiffness, 1.0 / p.contact_exponent);
}

/// A way through points with rests at each: minimum jerk between them [Flash & Hogan 1985].
class ToolWay {
 public:
  ToolWay(const World& world, const std::vector<PushParameters>& parameters, double duration) {
    const double share = duration / static_cast<double>(world.boxes.size());
    points_.push_back({0.0, start_before(world, 0)});
    for (std::size_t i = 0; i < world.boxes.size(); ++i) {
      const double begin = share * static_cast<double>(i);
      const Eigen::Vector3d start = start_before(world, i);
      const double press = kStartGap + kPressedTo * indentation_at_breakaway(parameters[i]);
      const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
      const Eigen::Vector3d above(0.0, 0.0, kLift);
      const Eigen::Vector3d end = start + (press + kSlideDistance) * y;
      const std::size_t next = std::min(i + 1, world.boxes.size() - 1);
      const Eigen::Vector3d start_of_next =
          next > i ? start_before(world, next) : Eigen::Vector3d(end - kBackOff * y);
      const auto add = [&](double fraction, const Eigen::Vector3d& p) {
        points_.push_back({begin + fraction * share, p});
      };
      add(0.10, start + (kStartGap - kNear) * y);
      add(0.30, start + press * y);
      add(0.46, end);
      add(0.51, end);
      add(0.58, end - kBackOff * y);
      add(0.70, end - kBackOff * y + above);
      add(0.88, start_of_next + above);
      add(1.00, start_of_next + (next > i ? Eigen::Vector3d::Zero().eval() : above));
    }
  }

  [[nodiscard]] Eigen::Vector3d at(double t) const {
    std::size_t i = 1;
    while (i + 1 < points_.size() && points_[i].t < t) ++i;
    const auto& [t0, p0] = points_[i - 1];
    const auto& [t1, p1] = points_[i];
    const double s = std::clamp((t - t0) / (t1 - t0), 0.0, 1.0);
    return p0 + s * s * s * (10.0 + s * (6.0 * s - 15.0)) * (p1 - p0);
  }

 private:
  static constexpr double kStartGap = 0.06;  ///< between tip and box before the approach [m]
  static constexpr double kNear = 0.004;     ///< and after it [m]
  static constexpr double kBackOff = 0.03;   ///< [m]
  static constexpr double kLift = 0.16;      ///< over the highest box [m]

  static Eigen::Vector3d start_before(const World& world, std::size_t i) {
    Eigen::Vector3d p = world.boxes[i].T_base_object.translation();
    p.y() -= world.boxes[i].half_extents.y() + world.tool_radius + kStartGap;
    return p;
  }

  struct Point {
    double t;
    Eigen::Vector3d p;
  };
  std::vector<Point> points_;
};

/// One box on the table, along y.
struct SlidingBox {
  double face = 0.0;   ///< y of the face that is pushed, at the start [m]
  double slid = 0.0;   ///< [m]
  double speed = 0.0;  ///< [m/s]
  bool is_stuck = true;
  double force = 0.0;  ///< of the tool [N]
  bool is_touched = false;
  PushPhase phase = PushPhase::free;
};

double contact_force(const PushParameters& p, double indentation, double rate) {
  if (indentation <= 0.0) return 0.0;
  const double power = std::pow(indentation, p.contact_exponent);
  return std::max(0.0, power * (p.contact_stiffness + p.contact_damping * rate));
}

void advance(SlidingBox& box, const PushParameters& p, double front, double front_speed,
             double dt) {
  const double indentation = front - box.face - box.slid;
  box.is_touched = indentation > 0.0;
  box.force = contact_force(p, indentation, front_speed - box.speed);
  if (box.is_stuck) {
    box.is_stuck = box.force <= p.limiting_static_friction;
    return;
  }
  const double friction =
      p.sliding_friction_coefficient * p.mass * kGravity + p.viscous_friction * box.speed;
  box.speed += dt * (box.force - friction) / p.mass;
  box.is_stuck = box.speed <= 0.0;
  if (box.is_stuck) box.speed = 0.0;
  box.slid += dt * box.speed;
}

PushPhase phase_of(const SlidingBox& box, const PushParameters& p) {
  const double least = box.phase == PushPhase::sliding ? 0.0003 : 0.001;  // [m/s]
  if (box.speed > least) return PushPhase::sliding;
  if (!box.is_touched) return PushPhase::free;
  return box.force >= 0.9 * p.limiting_static_friction ? PushPhase::critical
                                                       : PushPhase::static_friction;
}

/// Intervals shorter than this are merged into the one before: chatter, not phases [s].
constexpr double kShortestPhase = 0.008;

void add_phase(std::vector<PhaseChange>& phases, const PhaseChange& change) {
  if (!phases.empty() && phases.back().phase == change.phase) return;
  if (phases.size() > 1 && change.t - phases.back().t < kShortestPhase) phases.pop_back();
  if (phases.empty() || phases.back().phase != change.phase) phases.push_back(change);
}

std::vector<PhaseChange> merged(std::vector<std::vector<PhaseChange>> by_box) {
  std::vector<PhaseChange> all;
  for (const auto& phases : by_box) all.insert(all.end(), phases.begin(), phases.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const PhaseChange& a, const PhaseChange& b) { return a.t < b.t; });
  return all;
}

}  // namespace

PushRun simulate_push(const World& world, double duration, std::uint64_t seed) {
  PushRun run;
  if (!world.has_tool) return run;
  PCAVR_REQUIRE(!world.boxes.empty());
  Random random = Random(seed).fork(5);
  std::vector<SlidingBox> boxes;
  for (const Box& box : world.boxes) {
    run.parameters.push_back(draw_parameters(box.mass, random));
    boxes.push_back({.face = box.T_base_object.translation().y() - box.half_extents.y()});
  }
  const ToolWay way(world, run.parameters, duration);
  run.slid.resize(boxes.size());
  std::vector<std::vector<PhaseChange>> phases(boxes.size());
  const auto steps = static_cast<std::size_t>(std::ceil(duration / PushRun::kStep)) + 1;
  constexpr double kDt = PushRun::kStep / kSubsteps;
  for (std::size_t step = 0; step < steps; ++step) {
    const double t = PushRun::kStep * static_cast<double>(step);
    const Eigen::Vector3d tip = way.at(t);
    const double speed = (way.at(t + PushRun::kStep).y() - tip.y()) / PushRun::kStep;
    run.tip.push_back(tip);
    double impulse = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      run.slid[i].push_back(boxes[i].slid);
      boxes[i].phase = phase_of(boxes[i], run.parameters[i]);
      add_phase(phases[i], {.t = t, .box = i, .phase = boxes[i].phase});
      // A tool above the boxes touches none of them.
      const bool is_level = tip.z() < 2.0 * world.boxes[i].half_extents.z();
      const bool is_behind = tip.y() < boxes[i].face + boxes[i].slid + world.tool_radius;
      for (int k = 0; k < kSubsteps; ++k) {
        const double front = tip.y() + world.tool_radius + speed * kDt * k;
        advance(boxes[i], run.parameters[i], is_level && is_behind ? front : -1e3, speed, kDt);
        impulse += boxes[i].force * kDt;
      }
    }
    run.force.push_back(impulse / PushRun::kStep);
  }
  run.phases = merged(std::move(phases));
  return run;
}

std::vector<Pose> body_poses(const World& world, const PushRun& run, double t) {
  std::vector<Pose> poses{Pose()};
  for (const Box& box : world.boxes) poses.push_back(box.T_base_object);
  if (!world.has_tool) return poses;
  const double last = static_cast<double>(run.tip.size() - 1);
  const double place = std::clamp(t / PushRun::kStep, 0.0, last);
  const auto before = std::min(static_cast<std::size_t>(place), run.tip.size() - 2);
  const double fraction = place - static_cast<double>(before);
  for (std::size_t i = 0; i < world.boxes.size(); ++i) {
    const double slid =
        run.slid[i][before] + fraction * (run.slid[i][before + 1] - run.slid[i][before]);
    poses[1 + i] = Pose::from_translation({0.0, slid, 0.0}) * poses[1 + i];
  }
  // The tool's z points down: a half turn about x.
  poses.emplace_back(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0),
                     run.tip[before] + fraction * (run.tip[before + 1] - run.tip[before]));
  return poses;
}

}  // namespace pcavr::simulation
