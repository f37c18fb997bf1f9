// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/live_plant.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "simulation/plant_dynamics.hpp"
#include "simulation/plant_phases.hpp"
#include "simulation/sensor_streams.hpp"

namespace pcavr {

using namespace simulation;

void LivePlantSamples::clear() {
  tool.clear();
  wrench.clear();
  tracked.clear();
}

struct LivePlant::Content {
  /// A body, and what its tracker needs to know of its past.
  struct Body {
    BodyDynamics dynamics;
    double height;  ///< of its origin in base [m]
    TrackerError error;
    std::deque<PlantBodyState> past = {};  ///< over kRestingSteps, the oldest first
  };
  struct Wrench {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  };

  Content(const PlantCase& plant, std::uint64_t seed)
      : substeps(plant.substeps),
        arm(plant.tool),
        p_base_command(plant.tool.p_base_start),
        tool(seed),
        wrench(seed) {
    PCAVR_REQUIRE(substeps >= 1 && plant.tool.stiffness > 0.0 && plant.tool.bandwidth > 0.0);
    for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
      const PlantBody& body = plant.bodies[i];
      bodies.push_back({BodyDynamics(body, plant.tool.radius), body.T_base_object.translation().z(),
                        TrackerError(seed, i)});
    }
  }

  /// Mean wrench at the tip over the step.
  Wrench advance(const Eigen::Vector3d& p_base_next) {
    const double dt = kStep / substeps;
    const Eigen::Vector3d start = p_base_command;
    const Eigen::Vector3d v_base = (p_base_next - start) / kStep;
    Wrench sum;
    for (int i = 0; i < substeps; ++i) {
      Eigen::Vector3d load = Eigen::Vector3d::Zero();
      for (Body& body : bodies) {
        const TipLoad part = body.dynamics.advance(arm.tip(), dt);
        load += part.force;
        sum.torque += part.tip_torque / substeps;
      }
      sum.force += load / substeps;
      arm.advance(start + (i + 1) * dt * v_base, v_base, load, dt);
    }
    p_base_command = p_base_next;
    return sum;
  }

  void measure_tool(LivePlantSamples& samples) {
    if (steps % kStepsPerSample == 0) {
      samples.tool.push_back({time(), tool.measure(arm.tip().p_base)});
    }
  }

  void measure_wrench(const Wrench& mean, LivePlantSamples& samples) {
    // The first step of a sample waits for its second one.
    if (!first_half) {
      first_half = mean;
      return;
    }
    const WrenchSensor::Sample measured = wrench.measure(0.5 * (first_half->force + mean.force),
                                                         0.5 * (first_half->torque + mean.torque));
    first_half.reset();
    samples.wrench.push_back({time() - kStep, measured.force, measured.torque});
  }

  void track(LivePlantSamples& samples) {
    const bool is_frame = steps == std::llround(static_cast<double>(frames) / (kFrameRate * kStep));
    if (is_frame) ++frames;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Body& body = bodies[i];
      const PlantBodyState now = body.dynamics.state();
      body.past.push_back(now);
      if (body.past.size() > kRestingSteps + 1) body.past.pop_front();
      if (!is_frame) continue;
      const PlantBodyState& before = body.past.front();
      const bool is_at_rest = is_resting(before.p_base, before.yaw, now.p_base, now.yaw);
      const Vector6d noise = is_at_rest ? body.error.at_rest() : body.error.in_motion();
      const Eigen::Quaterniond q(Eigen::AngleAxisd(now.yaw, Eigen::Vector3d::UnitZ()));
      const Pose T_base_object(q, {now.p_base.x(), now.p_base.y(), body.height});
      samples.tracked.push_back({time(), i, T_base_object * Pose::exp(noise),
                                 is_at_rest ? kRestingPositionStd : kMovingPositionStd,
                                 is_at_rest ? kRestingRotationStd : kMovingRotationStd,
                                 is_at_rest});
    }
  }

  void keep_state() {
    const double t = kStep * static_cast<double>(run.p_base_tip.size());
    run.p_base_tip.push_back(arm.tip().p_base);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      run.bodies[i].push_back(bodies[i].dynamics.state());
      phases[i].add(t, bodies[i].dynamics.phase_inputs());
    }
  }

  [[nodiscard]] double time() const { return kStep * static_cast<double>(steps); }

  int substeps;
  SpringArm arm;
  Eigen::Vector3d p_base_command;
  std::vector<Body> bodies;
  ToolSensor tool;
  WrenchSensor wrench;
  std::optional<Wrench> first_half = {};  ///< of a wrench sample
  long long steps = 0;
  long long frames = 0;
  PlantRun run;
  std::vector<PhaseRecorder> phases;  ///< by body, while the run is kept
};

LivePlant::LivePlant(const PlantCase& plant, std::uint64_t seed)
    : content_(std::make_unique<Content>(plant, seed)) {}
LivePlant::LivePlant(LivePlant&&) noexcept = default;
LivePlant& LivePlant::operator=(LivePlant&&) noexcept = default;
LivePlant::~LivePlant() = default;

void LivePlant::step(const Eigen::Vector3d& p_base_command, LivePlantSamples& samples) {
  Content& c = *content_;
  if (!is_finite()) return;
  if (!c.phases.empty()) c.keep_state();
  c.measure_tool(samples);
  c.track(samples);
  const Content::Wrench mean =
      c.advance(p_base_command.allFinite() ? p_base_command : c.p_base_command);
  ++c.steps;
  if (is_finite()) c.measure_wrench(mean, samples);
}

bool LivePlant::is_finite() const {
  const Content& c = *content_;
  return c.arm.tip().p_base.allFinite() &&
         std::all_of(c.bodies.begin(), c.bodies.end(),
                     [](const Content::Body& body) { return body.dynamics.is_finite(); });
}

void LivePlant::skip(long long steps) {
  if (content_->phases.empty()) return;
  for (long long i = 0; i < steps; ++i) content_->keep_state();
}

void LivePlant::keep_run() {
  Content& c = *content_;
  c.run = {};
  c.run.bodies.resize(c.bodies.size());
  c.phases.clear();
  for (std::size_t i = 0; i < c.bodies.size(); ++i) c.phases.emplace_back(i);
}

PlantRun LivePlant::run() const {
  PlantRun run = content_->run;
  run.phases = merge_by_time(content_->phases);
  return run;
}

double LivePlant::t() const { return content_->time(); }
Eigen::Vector3d LivePlant::p_base_tip() const { return content_->arm.tip().p_base; }
std::size_t LivePlant::size() const { return content_->bodies.size(); }
PlantBodyState LivePlant::body(std::size_t index) const {
  return content_->bodies.at(index).dynamics.state();
}

}  // namespace pcavr
