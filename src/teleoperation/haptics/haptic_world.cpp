// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/contact/contact_inertia.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "teleoperation/haptics/haptic_world_content.hpp"

namespace pcavr {
namespace {

/// Largest penetration, as a share of a body's thickness: beyond half of it the opposite face would
/// be nearer.
constexpr double kMaxThicknessShare = 0.45;

/// Bodies of the haptic world's own.
class OwnBodies final : public PushedBodies {
 public:
  explicit OwnBodies(PredictedWorld world) : world_(std::move(world)) {}

  [[nodiscard]] std::size_t size() const override { return world_.size(); }
  [[nodiscard]] const std::string& name(std::size_t body) const override {
    return world_.name(body);
  }
  [[nodiscard]] const std::vector<BodyState>& state() const override { return world_.state(); }
  [[nodiscard]] Pose T_base_object(std::size_t body) const override {
    return world_.T_base_object(body);
  }
  void set_state(const std::vector<BodyState>& state) override { world_.set_state(state); }
  void step(const Eigen::Vector3d& p_base_before, const Eigen::Vector3d& p_base_tip,
            double dt) noexcept override {
    world_.step(p_base_before, p_base_tip, dt);
  }
  void rest(const Eigen::Vector3d&, double dt) noexcept override { world_.step(dt); }

 private:
  PredictedWorld world_;
};

}  // namespace

HapticWorld::Content::Content(const HapticWorldModel& model, std::unique_ptr<PushedBodies> pushed)
    : world(std::move(pushed)),
      start(world->state()),
      work(start),
      supports(model.supports_base, model.options.support_height_tolerance),
      floor(model.world.static_mesh_base, model.supports_base,
            model.options.support_height_tolerance),
      proxy(model.world.tool_radius),
      force(model.force),
      acceleration(model.options.acceleration_time, model.force.max_acceleration),
      gravity(model.world.gravity),
      max_tip_speed(model.world.options.max_tip_speed),
      options(model.options),
      min_force(model.force.min_force) {
  proxy.add_static(model.world.static_mesh_base);
  const TriangleMesh support_mesh = supports.surface_base();
  proxy.add_static(support_mesh);
  proxy.add_static(model.guard_mesh_base);
  for (const TriangleMesh* mesh :
       {&model.world.static_mesh_base, &support_mesh, &model.guard_mesh_base}) {
    for (const Eigen::Vector3f& v : mesh->vertices) top = std::max(top, static_cast<double>(v.z()));
  }
  double static_limit = 0.0;
  for (const WorldBody& body : model.world.bodies) {
    if (body.is_movable) static_limit += static_friction_limit(body.physics.friction);
  }
  for (const WorldBody& body : model.world.bodies) {
    proxy.add_moving(body.model.mesh_object);
    Body& added = bodies.emplace_back(detail::shape_of(body));
    added.contact_mass = body.physics.contact_mass;
    const double max_push =
        body.is_movable ? std::min(options.max_push_ratio * static_limit, options.max_push_force)
                        : options.max_push_force;
    const double penetration_at_max = static_penetration(body.physics.contact, max_push);
    added.max_penetration = std::min(
        penetration_at_max, proxy.radius() + kMaxThicknessShare * added.shape.min_thickness);
    const Eigen::Vector3d centre = body.T_base_object * added.shape.centre_of_mass;
    added.has_support = world->can_set_state() && body.is_movable &&
                        supports.is_supported(centre.head<2>(), added.shape.bottom);
    const Eigen::Vector3d bounding_centre = body.T_base_object * added.shape.bounding_centre;
    top = std::max(top, bounding_centre.z() + added.shape.bounding_radius);
  }
  top += 2.0 * proxy.radius();
  state.bodies.resize(bodies.size());
  reset({0.0, 0.0, top});
  state.can_undo_reset = false;
}

void HapticWorld::Content::compute_force(const Eigen::Vector3d& device, double dt) noexcept {
  Eigen::Vector3d body_force = Eigen::Vector3d::Zero();
  double max_tool_force = -1.0;
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  state.touched_body.reset();
  for (std::size_t i = 0; i < bodies.size() && state.is_engaged; ++i) {
    const Eigen::Vector3d& tool_force = world->state()[i].tool_force_base;
    body_force -= tool_force;
    if (bodies[i].contact_mass > 0.0) {
      body_force -= inertial_force(acceleration.value(), tool_force, bodies[i].contact_mass);
    }
    if (const auto answer = closest(bodies[i], hip)) out = answer->normal;
    if (!bodies[i].is_under_tool || tool_force.norm() <= max_tool_force) continue;
    max_tool_force = tool_force.norm();
    state.touched_body = i;
  }
  const bool is_penetrating = state.is_engaged && proxy.is_separated_from(hip);
  if (is_penetrating && out.isZero(0.0)) out = (proxy.centre() - hip).stableNormalized();
  // Penetration without a force: the body moves away, or the proxy has not reached the surface yet.
  if (body_force.norm() < min_force) body_force = min_force * out;
  const Eigen::Vector3d correction = static_proxy - hip;
  state.touches_scan = is_penetrating && correction.norm() > detail::kContactSlack;
  state.force_base = force.step(device, device + correction, state.touches_scan, dt, body_force);
}

void HapticWorld::Content::step(const ToolCommand& command, double dt) noexcept {
  if (!(dt > 0.0) || !std::isfinite(dt)) return;
  if (!is_placed && is_valid_tip(command.p_base_tip)) reset(command.p_base_tip);
  state.is_engaged = command.is_engaged && is_valid_tip(command.p_base_tip);
  if (state.is_engaged) {
    const double displacement = (command.p_base_tip - hip).norm();
    hip = command.p_base_tip;
    acceleration.add(hip, dt);
    follow(displacement, dt);
    update_tip(dt);
  } else {
    release();
  }
  move_bodies(dt);
  resolve_overlap();
  if (!state.is_engaged) hip = proxy.centre();
  compute_force(command.p_base_tip, dt);
  state.p_base_hip = hip;
  state.p_base_proxy = proxy.centre();
  if (state.touched_body) state.can_undo_reset = false;
  publish_bodies();
}

HapticWorld::HapticWorld(std::unique_ptr<Content> content) : content_(std::move(content)) {}
HapticWorld::HapticWorld(HapticWorld&&) noexcept = default;
HapticWorld& HapticWorld::operator=(HapticWorld&&) noexcept = default;
HapticWorld::~HapticWorld() = default;

Expected<HapticWorld> HapticWorld::create(const HapticWorldModel& model) {
  auto predicted = PredictedWorld::create(model.world);
  if (!predicted) return predicted.error();
  return create(model, std::make_unique<OwnBodies>(std::move(predicted).value()));
}

Expected<HapticWorld> HapticWorld::create(const HapticWorldModel& model,
                                          std::unique_ptr<PushedBodies> bodies) {
  const HapticWorldOptions& options = model.options;
  PCAVR_REQUIRE(std::isfinite(options.scan_friction) && options.scan_friction >= 0.0,
                options.scan_friction);
  PCAVR_REQUIRE(options.max_penetration_speed > 0.0 && options.catch_up_speed >= 0.0);
  PCAVR_REQUIRE(options.max_push_force > 0.0 && options.max_push_ratio > 0.0);
  PCAVR_REQUIRE(options.acceleration_time > 0.0, options.acceleration_time);
  PCAVR_REQUIRE(bodies != nullptr && bodies->size() == model.world.bodies.size());
  return HapticWorld(std::make_unique<Content>(model, std::move(bodies)));
}

std::size_t HapticWorld::size() const { return content_->bodies.size(); }
const std::string& HapticWorld::name(std::size_t body) const { return content_->world->name(body); }
void HapticWorld::reset(const Eigen::Vector3d& p_base_tip) noexcept { content_->reset(p_base_tip); }
void HapticWorld::undo_reset(const Eigen::Vector3d& p_base_tip) noexcept {
  content_->undo_reset(p_base_tip);
}
void HapticWorld::step(const ToolCommand& command, double dt) noexcept {
  content_->step(command, dt);
}
const HapticWorldState& HapticWorld::state() const { return content_->state; }

}  // namespace pcavr
