// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/predicted_world.hpp"

#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "physics/prediction/neighbourhood.hpp"

namespace pcavr {

struct PredictedWorld::Content {
  std::vector<detail::UprightBody> bodies;
  std::vector<BodyState> states;
  detail::Neighbourhood neighbourhood;
  double tool_radius;
  double max_tip_speed;

  explicit Content(const WorldModel& model)
      : bodies(upright_bodies(model)),
        neighbourhood(model.bodies, bodies, model.static_mesh_base, model.options),
        tool_radius(model.tool_radius),
        max_tip_speed(model.options.max_tip_speed) {
    for (const detail::UprightBody& body : bodies) states.emplace_back().planar = body.start();
  }

  static std::vector<detail::UprightBody> upright_bodies(const WorldModel& model) {
    std::vector<detail::UprightBody> result;
    result.reserve(model.bodies.size());
    for (const WorldBody& body : model.bodies) {
      result.emplace_back(body, model.gravity, model.options.max_contact_force);
    }
    return result;
  }
};

PredictedWorld::PredictedWorld(std::unique_ptr<Content> content) : content_(std::move(content)) {}
PredictedWorld::PredictedWorld(PredictedWorld&&) noexcept = default;
PredictedWorld& PredictedWorld::operator=(PredictedWorld&&) noexcept = default;
PredictedWorld::~PredictedWorld() = default;

Expected<PredictedWorld> PredictedWorld::create(WorldModel model) {
  PCAVR_REQUIRE(std::isfinite(model.tool_radius) && model.tool_radius > 0.0, model.tool_radius);
  PCAVR_REQUIRE(std::isfinite(model.gravity) && model.gravity > 0.0, model.gravity);
  const WorldOptions& options = model.options;
  PCAVR_REQUIRE(options.max_tip_speed > 0.0 && options.max_contact_force > 0.0);
  PCAVR_REQUIRE(options.body_penetration > 0.0 && options.max_separation_speed > 0.0);
  PCAVR_REQUIRE(options.max_scan_penetration > 0.0, options.max_scan_penetration);
  PCAVR_REQUIRE(options.body_friction >= 0.0, options.body_friction);
  PCAVR_REQUIRE(options.shape_tolerance > 0.0 && options.max_convex_parts >= 1);
  for (const WorldBody& body : model.bodies) {
    if (!body.model.mesh_object.triangles.empty()) continue;
    return Error{.message = "a body needs a CAD surface", .place = body.model.name};
  }
  auto content = std::make_unique<Content>(model);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (content->neighbourhood.has_shape(i)) continue;
    return Error{.message = "all vertices of its mesh lie in one plane",
                 .place = model.bodies[i].model.name,
                 .hint = "give it a closed CAD mesh"};
  }
  return PredictedWorld(std::move(content));
}

std::size_t PredictedWorld::size() const { return content_->bodies.size(); }

const std::string& PredictedWorld::name(std::size_t body) const {
  PCAVR_REQUIRE(body < size(), body, size());
  return content_->bodies[body].name();
}

const BodyPhysics& PredictedWorld::physics(std::size_t body) const {
  PCAVR_REQUIRE(body < size(), body, size());
  return content_->bodies[body].physics();
}

void PredictedWorld::set_physics(std::size_t body, const BodyPhysics& physics) {
  PCAVR_REQUIRE(body < size(), body, size());
  content_->bodies[body].set_physics(physics);
}

const std::vector<BodyState>& PredictedWorld::state() const { return content_->states; }

void PredictedWorld::set_state(const std::vector<BodyState>& state) {
  PCAVR_REQUIRE(state.size() == size(), state.size(), size());
  std::copy(state.begin(), state.end(), content_->states.begin());
}

void PredictedWorld::set_pose(std::size_t body, const Pose& T_base_object) {
  PCAVR_REQUIRE(body < size(), body, size());
  BodyState& state = content_->states[body];
  state.planar = content_->bodies[body].at_rest_in(T_base_object, state.planar.yaw);
}

Pose PredictedWorld::T_base_object(std::size_t body) const {
  PCAVR_REQUIRE(body < size(), body, size());
  return pose_of(body, content_->states[body]);
}

Pose PredictedWorld::pose_of(std::size_t body, const BodyState& state) const {
  PCAVR_REQUIRE(body < size(), body, size());
  return content_->bodies[body].pose_of(state.planar);
}

void PredictedWorld::step(const Eigen::Vector3d& p_base_before, const Eigen::Vector3d& p_base_tip,
                          double dt) noexcept {
  if (!(dt > 0.0) || !p_base_tip.allFinite() || !p_base_before.allFinite()) return;
  const detail::TipPath tip{p_base_before, p_base_tip, content_->tool_radius,
                            content_->max_tip_speed};
  content_->neighbourhood.step(content_->bodies, tip, dt, content_->states);
}

void PredictedWorld::step(double dt) noexcept {
  if (!(dt > 0.0)) return;
  content_->neighbourhood.step(content_->bodies, detail::TipPath{.is_present = false}, dt,
                               content_->states);
}

}  // namespace pcavr
