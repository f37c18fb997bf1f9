// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/gravity.hpp"

#include "simulation/arm_dynamics.hpp"
#include "simulation/plant_dynamics.hpp"
#include "simulation/plant_phases.hpp"
#include "simulation/tool_plan.hpp"

namespace pcavr {
namespace {

using namespace simulation;

void check(const std::vector<PlantBody>& bodies, const PlantTool& tool,
           const std::vector<ToolMove>& moves, const PlantOptions& options) {
  for (const PlantBody& body : bodies) {
    const PlantParameters& p = body.parameters;
    PCAVR_REQUIRE(p.mass > 0.0 && p.limiting_static_friction > 0.0, p.mass,
                  p.limiting_static_friction);
    PCAVR_REQUIRE(p.sliding_friction_coefficient > 0.0 &&
                      p.sliding_friction_coefficient * p.mass * kStandardGravity <=
                          p.limiting_static_friction * (1.0 + 1e-9),
                  p.sliding_friction_coefficient, p.limiting_static_friction);
    PCAVR_REQUIRE(p.contact_stiffness > 0.0 && p.contact_exponent >= 1.0, p.contact_stiffness,
                  p.contact_exponent);
    PCAVR_REQUIRE(p.breakaway_displacement > 0.0 && p.stribeck_speed > 0.0,
                  p.breakaway_displacement, p.stribeck_speed);
    PCAVR_REQUIRE(!body.parts.empty() && body.patches.size() >= 3);
  }
  PCAVR_REQUIRE(tool.radius > 0.0 && tool.stiffness > 0.0 && tool.bandwidth > 0.0, tool.radius,
                tool.stiffness, tool.bandwidth);
  for (const ToolMove& move : moves) {
    PCAVR_REQUIRE(move.speed > 0.0 && move.acceleration > 0.0, move.speed, move.acceleration);
    PCAVR_REQUIRE(!move.body || *move.body < bodies.size());
    PCAVR_REQUIRE(!move.until_moved || move.body);
    PCAVR_REQUIRE(!move.release || !tool.arm);
  }
  PCAVR_REQUIRE(options.substeps >= 1 && options.tail >= 0.0, options.substeps, options.tail);
}

/// Detects the impacts of the tip on one body, at the plant's substeps.
class ImpactRecorder {
 public:
  explicit ImpactRecorder(std::size_t body) : body_(body) {}

  /// `v_base` [m/s] is the tip's velocity relative to the body, `t` [s] the time.
  void add(double t, const TipLoad& load, const Eigen::Vector3d& v_base,
           std::vector<PlantImpact>& impacts) {
    if (load.is_touched) {
      if (!was_touched_) {
        begin_ = t;
        v_before_ = v_base;
        impulse_.setZero();
      }
      impulse_ += load.force;
    } else if (was_touched_ && t - begin_ <= kMaxImpactDuration) {
      const Eigen::Vector3d along = impulse_.normalized();
      const double approach = v_before_.dot(along);
      impacts.push_back({.t = begin_,
                         .body = body_,
                         .duration = t - begin_,
                         .approach_speed = approach,
                         .restitution = -v_base.dot(along) / approach});
    }
    was_touched_ = load.is_touched;
  }

 private:
  std::size_t body_;
  bool was_touched_ = false;
  double begin_ = 0.0;
  Eigen::Vector3d v_before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d impulse_ = Eigen::Vector3d::Zero();
};

/// Mean wrench at the tip over a step.
struct MeanWrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

class Plant {
 public:
  Plant(const std::vector<PlantBody>& bodies, const PlantTool& tool,
        const std::vector<ToolMove>& moves, int substeps)
      : plan_(moves, tool.p_base_start), spring_(tool), substeps_(substeps) {
    if (tool.arm) arm_.emplace(*tool.arm);
    for (const PlantBody& body : bodies) {
      recorders_.emplace_back(bodies_.size());
      bodies_.emplace_back(body, tool.radius);
    }
  }

  /// Advances by PlantRun::kStep; returns the mean wrench that the tip exerts.
  MeanWrench step(std::vector<PlantImpact>& impacts) {
    const double dt = PlantRun::kStep / substeps_;
    MeanWrench sum;
    for (int i = 0; i < substeps_; ++i) {
      const std::optional<std::size_t> watched = plan_.watched_body();
      plan_.advance(watched ? bodies_[*watched].pose() : Pose(), load_.norm(), dt);
      load_.setZero();
      bool is_touched = false;
      Eigen::Vector3d torque = Eigen::Vector3d::Zero();
      for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const Eigen::Vector3d v_base = tip().v_base - bodies_[k].v_base();
        const TipLoad load = bodies_[k].advance(tip(), dt);
        load_ += load.force;
        torque += load.tip_torque;
        is_touched |= load.is_touched;
        recorders_[k].add(t_, load, v_base, impacts);
      }
      sum.force += load_ / substeps_;
      sum.torque += torque / substeps_;
      advance_arm(torque, dt);
      if (plan_.is_released()) plan_.follow(tip(), is_touched, dt);
      t_ += dt;
    }
    return sum;
  }

  [[nodiscard]] const ToolPlan& plan() const { return plan_; }
  [[nodiscard]] const Eigen::Vector3d& p_base_tip() const { return tip().p_base; }
  [[nodiscard]] const std::optional<ArmDynamics>& arm() const { return arm_; }
  [[nodiscard]] const std::vector<BodyDynamics>& dynamics() const { return bodies_; }

 private:
  [[nodiscard]] const Tip& tip() const { return arm_ ? arm_->tip() : spring_.tip(); }

  void advance_arm(const Eigen::Vector3d& torque, double dt) {
    if (arm_) {
      arm_->advance(plan_.p_base(), load_, torque, dt);
    } else if (plan_.is_released()) {
      spring_.fly(load_, dt);
    } else {
      spring_.advance(plan_.p_base(), plan_.v_base(), load_, dt);
    }
  }

  ToolPlan plan_;
  SpringArm spring_;
  std::optional<ArmDynamics> arm_;
  int substeps_;
  std::vector<BodyDynamics> bodies_;
  std::vector<ImpactRecorder> recorders_;
  double t_ = 0.0;  ///< [s]
  Eigen::Vector3d load_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<PlantPatch> uniform_patches(const Eigen::Vector2d& half_extents, int per_side) {
  PCAVR_REQUIRE(per_side >= 2, per_side);
  std::vector<PlantPatch> patches;
  const auto at = [per_side](int i) { return (2.0 * i + 1.0) / per_side - 1.0; };
  for (int i = 0; i < per_side; ++i) {
    for (int k = 0; k < per_side; ++k) {
      patches.push_back({.p_body = half_extents.cwiseProduct(Eigen::Vector2d(at(i), at(k))),
                         .share = 1.0 / (per_side * per_side)});
    }
  }
  return patches;
}

double friction_radius(const std::vector<PlantPatch>& patches) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const PlantPatch& patch : patches) centre += patch.share * patch.p_body;
  double radius = 0.0;
  for (const PlantPatch& patch : patches) {
    radius += patch.wear * patch.share * (patch.p_body - centre).norm();
  }
  return radius;
}

double PlantRun::duration() const {
  return p_base_tip.empty() ? 0.0 : kStep * static_cast<double>(p_base_tip.size() - 1);
}

PlantRun run_plant(const std::vector<PlantBody>& bodies, const PlantTool& tool,
                   const std::vector<ToolMove>& moves, const PlantOptions& options) {
  check(bodies, tool, moves, options);
  Plant plant(bodies, tool, moves, options.substeps);
  PlantRun run;
  run.bodies.resize(bodies.size());
  std::vector<PhaseRecorder> recorders;
  for (std::size_t i = 0; i < bodies.size(); ++i) recorders.emplace_back(i);
  const auto max_steps = static_cast<std::size_t>(options.max_duration / PlantRun::kStep);
  auto tail = static_cast<std::size_t>(options.tail / PlantRun::kStep) + 1;
  for (std::size_t step = 0; step <= max_steps && tail > 0; ++step) {
    const double t = PlantRun::kStep * static_cast<double>(step);
    if (plant.plan().is_done()) --tail;
    run.p_base_tip.push_back(plant.p_base_tip());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      run.bodies[i].push_back(plant.dynamics()[i].state());
      recorders[i].add(t, plant.dynamics()[i].phase_inputs());
    }
    if (plant.arm()) run.arm.push_back(plant.arm()->state());
    const MeanWrench mean = plant.step(run.impacts);
    run.force_base.push_back(mean.force);
    run.torque_base.push_back(mean.torque);
  }
  run.phases = merge_by_time(recorders);
  return run;
}

namespace {

struct StepFraction {
  std::size_t before = 0;
  double fraction = 0.0;
};

StepFraction locate(const PlantRun& run, double t) {
  const double last = static_cast<double>(run.p_base_tip.size() - 1);
  const double index_at_t = std::clamp(t / PlantRun::kStep, 0.0, last);
  const auto before = std::min(static_cast<std::size_t>(index_at_t), run.p_base_tip.size() - 2);
  return {before, index_at_t - static_cast<double>(before)};
}

/// Steps [begin, end) in which a body slides.
struct StepRange {
  std::size_t begin, end;
};

std::vector<StepRange> slides_of(const PlantRun& run, std::size_t body) {
  const auto step_of = [](double t) {
    return static_cast<std::size_t>(std::lround(t / PlantRun::kStep));
  };
  std::vector<StepRange> slides;
  bool is_sliding = false;
  for (const PlantPhaseChange& change : run.phases) {
    if (change.body != body) continue;
    if (is_sliding) slides.back().end = step_of(change.t);
    is_sliding = change.phase == PlantPhase::sliding;
    if (is_sliding) slides.push_back({step_of(change.t), run.bodies[body].size()});
  }
  return slides;
}

/// The step of the maximum friction from which it falls to that at `slide`.
std::size_t breakaway_before(const std::vector<PlantBodyState>& states, std::size_t slide) {
  const auto force = [&](std::size_t step) { return states[step].friction.head<2>().norm(); };
  while (slide > 0 && force(slide - 1) > force(slide)) --slide;
  return slide;
}

}  // namespace

PlantParameters parameters_met(const PlantRun& run, const PlantBody& body, std::size_t index) {
  const std::vector<PlantBodyState>& states = run.bodies[index];
  double of_slides = 0.0, of_breakaways = 0.0, steps = 0.0;
  const std::vector<StepRange> slides = slides_of(run, index);
  for (const StepRange& slide : slides) {
    of_breakaways += states[breakaway_before(states, slide.begin)].load_factor;
    for (std::size_t step = slide.begin; step < slide.end; ++step) {
      of_slides += states[step].load_factor;
      ++steps;
    }
  }
  PlantParameters met = body.parameters;
  if (!(steps > 0.0)) return met;
  met.sliding_friction_coefficient *= of_slides / steps;
  met.limiting_static_friction *= of_breakaways / static_cast<double>(slides.size());
  return met;
}

Pose T_base_object_at(const PlantRun& run, const PlantBody& body, std::size_t index, double t) {
  const auto [before, fraction] = locate(run, t);
  const PlantBodyState& a = run.bodies[index][before];
  const PlantBodyState& b = run.bodies[index][before + 1];
  const Eigen::Vector2d p = a.p_base + fraction * (b.p_base - a.p_base);
  const double yaw = a.yaw + fraction * (b.yaw - a.yaw);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {p.x(), p.y(), body.T_base_object.translation().z()}};
}

Eigen::Vector3d p_base_tip_at(const PlantRun& run, double t) {
  const auto [before, fraction] = locate(run, t);
  return run.p_base_tip[before] + fraction * (run.p_base_tip[before + 1] - run.p_base_tip[before]);
}

Eigen::VectorXd arm_position_at(const PlantRun& run, double t) {
  PCAVR_REQUIRE(!run.arm.empty());
  const auto [before, fraction] = locate(run, t);
  return run.arm[before].q + fraction * (run.arm[before + 1].q - run.arm[before].q);
}

}  // namespace pcavr
