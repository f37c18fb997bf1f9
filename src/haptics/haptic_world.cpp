// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_world.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/contact/contact_inertia.hpp"
#include "pcavr/contact/hunt_crossley.hpp"
#include "pcavr/core/check.hpp"

#include "haptics/body_shape.hpp"
#include "haptics/falling_body.hpp"
#include "haptics/floor_heights.hpp"
#include "haptics/friction_cone.hpp"
#include "haptics/proxy_sphere.hpp"
#include "haptics/supports.hpp"
#include "haptics/tip_acceleration.hpp"

namespace pcavr {
namespace {

/// The proxy's surfaces: the scan, the supports, the guards, and then the bodies.
constexpr std::size_t kFirstBody = 3;
/// Of a body's thickness: beyond half of it the opposite face would be nearer.
constexpr double kMaxThicknessShare = 0.45;
/// Cosine between the normals nearest to the tip and at the proxy's contact: on the same face.
constexpr double kMinSameFaceCosine = 0.7;
/// Backtracking of a tip that has penetrated too far: to 0.43 of its depth.
constexpr double kBacktrackFactor = 0.9;
constexpr int kMaxBacktracks = 8;
/// Of the maximum penetration, at which the force on a body no longer grows.
constexpr double kSaturatedShare = 0.99;
/// [m] A tip farther from the origin along any axis is invalid.
constexpr double kMaxTipCoordinate = 1e3;
/// Iterations that move the proxy out of overlapping bodies: bounds a cycle's time where they
/// squeeze it.
constexpr int kMaxOverlapIterations = 12;
/// Of a body, that a reset must undo to be undone itself [m], [rad].
constexpr double kMinUndoneTranslation = 1e-4;
constexpr double kMinUndoneRotation = 1e-3;

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

bool is_valid_tip(const Eigen::Vector3d& p) noexcept {
  return (p.array().abs() <= kMaxTipCoordinate).all();
}

}  // namespace

struct HapticWorld::Content {
  struct Body {
    explicit Body(detail::BodyShape body_shape) : shape(std::move(body_shape)) {}

    detail::BodyShape shape;
    double max_penetration = 0.0;  ///< [m] of the tool
    double contact_mass = 0.0;     ///< [kg] see BodyPhysics
    bool has_support = false;      ///< initially
    bool is_under_tool = false;    ///< the proxy is in contact with it
    bool is_saturated = false;     ///< the tip is as deep in it as it may be, the hand deeper
    Pose T_base_object;            ///< after the latest step
    std::optional<detail::FallingBody> fall;
    std::optional<detail::FallingBody> fall_before_reset;
  };

  Content(const HapticWorldModel& model, std::unique_ptr<PushedBodies> pushed);

  void reset(const Eigen::Vector3d& tip) noexcept;
  void undo_reset(const Eigen::Vector3d& tip) noexcept;
  void step(const ToolCommand& command, double dt) noexcept;

 private:
  void set_bodies(const std::vector<BodyState>& bodies_at) noexcept;
  [[nodiscard]] bool have_moved() const noexcept;
  void place_tip(const Eigen::Vector3d& wanted_tip) noexcept;
  [[nodiscard]] bool is_collision_free(const Eigen::Vector3d& centre) const noexcept;
  [[nodiscard]] bool is_near(const Body& body, const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] std::optional<detail::ClosestSurface::Result> closest(const Body& body,
                                                                      const Eigen::Vector3d& p,
                                                                      double reach) const noexcept;
  [[nodiscard]] auto closest(const Body& body, const Eigen::Vector3d& p) const noexcept {
    return closest(body, p, proxy.radius());
  }
  [[nodiscard]] bool is_resting_on_body() const noexcept;
  [[nodiscard]] bool may_catch_up() const noexcept;
  void follow(double displacement, double dt) noexcept;
  void update_tip(double dt) noexcept;
  [[nodiscard]] Eigen::Vector3d limited_penetration(const Eigen::Vector3d& direction,
                                                    double desired,
                                                    double max_change) const noexcept;
  [[nodiscard]] bool is_through_contact_face(const Eigen::Vector3d& p) const noexcept;
  void release() noexcept;
  void move_bodies(double dt) noexcept;
  void start_falling(std::size_t i) noexcept;
  void resolve_overlap() noexcept;
  void compute_force(const Eigen::Vector3d& device, double dt) noexcept;
  void publish_bodies() noexcept;

 public:
  std::unique_ptr<PushedBodies> world;
  std::vector<BodyState> start;
  std::vector<BodyState> before_reset;
  std::vector<BodyState> work;  ///< buffer, so that removing a body does not allocate
  detail::Supports supports;
  detail::FloorHeights floor;  ///< what the scan shows below the supports
  detail::ProxySphere proxy;
  RenderedForce force;
  detail::TipAcceleration acceleration;
  double gravity;
  double max_tip_speed;
  HapticWorldOptions options;
  double min_force;
  double top = 0.0;  ///< [m] above everything
  std::vector<Body> bodies;
  HapticWorldState state;

  bool is_placed = false;
  double body_displacement = 0.0;  ///< [m] of the bodies under the tool in the latest step
  Eigen::Vector3d penetration =
      Eigen::Vector3d::Zero();  ///< [m] from the proxy to the prediction's tip
  Eigen::Vector3d scan_normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> tip;         ///< [m] of the prediction; empty while disengaged
  std::optional<Eigen::Vector3d> tip_before;  ///< a step earlier
  Eigen::Vector3d static_proxy =
      Eigen::Vector3d::Zero();  ///< [m] the proxy's centre among static surfaces only
};

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

bool HapticWorld::Content::is_near(const Body& body, const Eigen::Vector3d& p) const noexcept {
  if (body.fall) return false;
  const double reach = body.shape.bounding_radius + 2.0 * proxy.radius();
  return (body.T_base_object * body.shape.bounding_centre - p).squaredNorm() < reach * reach;
}

/// The closest point of the body's surface to `p`, in base, where it is nearer than `reach` or `p`
/// is inside.
std::optional<detail::ClosestSurface::Result> HapticWorld::Content::closest(
    const Body& body, const Eigen::Vector3d& p, double reach) const noexcept {
  if (!is_near(body, p)) return std::nullopt;
  const Pose& T = body.T_base_object;
  const Eigen::Vector3d p_object = T.rotation().conjugate() * (p - T.translation());
  auto answer = body.shape.surface.closest(p_object, reach);
  if (answer) {
    answer->point = T * answer->point;
    answer->normal = T.rotation() * answer->normal;
  }
  return answer;
}

bool HapticWorld::Content::is_collision_free(const Eigen::Vector3d& centre) const noexcept {
  return proxy.is_collision_free(centre) &&
         std::none_of(bodies.begin(), bodies.end(),
                      [&](const Body& body) { return closest(body, centre).has_value(); });
}

void HapticWorld::Content::reset(const Eigen::Vector3d& wanted_tip) noexcept {
  // A second reset in a row must not lose what the first one undid.
  const bool is_repeated = state.can_undo_reset;
  if (!is_repeated) {
    before_reset = world->state();
    for (Body& body : bodies) body.fall_before_reset = body.fall;
  }
  set_bodies(start);
  state.can_undo_reset = is_repeated || have_moved();
  place_tip(wanted_tip);
}

/// Whether the latest reset has moved any body; state.bodies are as before it.
bool HapticWorld::Content::have_moved() const noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Pose& before = state.bodies[i].T_base_object;
    const Pose& now = bodies[i].T_base_object;
    if (translation_distance(before, now) > kMinUndoneTranslation) return true;
    if (rotation_distance(before, now) > kMinUndoneRotation) return true;
  }
  return false;
}

void HapticWorld::Content::undo_reset(const Eigen::Vector3d& wanted_tip) noexcept {
  if (!state.can_undo_reset) return;
  for (BodyState& body : before_reset) {
    body.planar.twist.setZero();
    body.planar.phase = FrictionPhase::static_contact;
    body.penetration = 0.0;
    body.phase = MotionPhase::free;
    body.is_blocked = false;
    body.is_saturated = false;
    body.tangential_deflection_base.setZero();
    body.tool_force_base.setZero();
  }
  set_bodies(before_reset);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].fall = bodies[i].fall_before_reset;
    if (!bodies[i].fall) continue;
    bodies[i].T_base_object = bodies[i].fall->T_base_object();
    proxy.remove(kFirstBody + i);
  }
  place_tip(wanted_tip);
  state.can_undo_reset = false;
}

void HapticWorld::Content::set_bodies(const std::vector<BodyState>& bodies_at) noexcept {
  world->set_state(bodies_at);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].fall.reset();
    bodies[i].is_under_tool = false;
    bodies[i].T_base_object = world->T_base_object(i);
    proxy.set_pose(kFirstBody + i, bodies[i].T_base_object);
  }
}

void HapticWorld::Content::place_tip(const Eigen::Vector3d& wanted_tip) noexcept {
  is_placed = is_valid_tip(wanted_tip);
  Eigen::Vector3d centre = is_placed ? wanted_tip : Eigen::Vector3d(0.0, 0.0, top);
  while (centre.z() < top && !is_collision_free(centre)) centre.z() += 0.5 * proxy.radius();
  proxy.set_centre(centre);
  hip = centre;
  release();
  state.force_base.setZero();
  state.is_engaged = false;
  state.touches_scan = false;
  state.touched_body.reset();
  state.p_base_hip = hip;
  state.p_base_proxy = centre;
  publish_bodies();
}

/// Whether the tool would be collision-free at the HIP and on the straight path to it.
bool HapticWorld::Content::may_catch_up() const noexcept {
  if (is_resting_on_body() || proxy.centre() == hip || proxy.is_separated_from(hip)) return false;
  return std::none_of(bodies.begin(), bodies.end(),
                      [&](const Body& body) { return closest(body, hip).has_value(); });
}

/// Moves the proxy after the HIP, which moved by `displacement` [m].
void HapticWorld::Content::follow(double displacement, double dt) noexcept {
  goal = detail::friction_limited_goal(hip, proxy.centre(), scan_normal, options.scan_friction);
  const double budget =
      displacement + body_displacement + (may_catch_up() ? options.catch_up_speed * dt : 0.0);
  if (!(budget > 0.0)) return;
  proxy.follow(goal, budget, budget);
  scan_normal = proxy.static_normal(hip);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    body.is_under_tool = is_near(body, proxy.centre()) && proxy.rests_on(kFirstBody + i, goal);
  }
}

bool HapticWorld::Content::is_resting_on_body() const noexcept {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return body.is_under_tool; });
}

/// The prediction's tip: at the proxy's centre, plus a penetration into the body that it touches.
void HapticWorld::Content::update_tip(double dt) noexcept {
  tip_before = tip;
  tip = proxy.centre();
  for (Body& body : bodies) body.is_saturated = false;
  static_proxy = proxy.centre();
  if (!is_resting_on_body()) {
    penetration.setZero();
  } else {
    double max_penetration = std::numeric_limits<double>::infinity();
    for (const Body& body : bodies) {
      if (body.is_under_tool) max_penetration = std::min(max_penetration, body.max_penetration);
    }
    double budget = max_penetration;
    static_proxy = proxy.centre_ignoring_moving(goal, budget);
    const Eigen::Vector3d direction = static_proxy - proxy.centre();
    const double length = direction.norm();
    penetration = limited_penetration(direction, std::min(length, max_penetration),
                                      options.max_penetration_speed * dt);
    // A faster tip counts as placed anew in the prediction, which would move the body away.
    const bool has_jumped =
        !tip_before || (proxy.centre() + penetration - *tip_before).norm() > max_tip_speed * dt;
    if (has_jumped) penetration.setZero();
    *tip += penetration;
    // The HIP's depth beyond the body's maximum penetration makes no force from the scan.
    const double excess = length > 0.0 ? (hip - static_proxy).dot(direction) / length : 0.0;
    if (budget <= 0.0 && excess > 0.0) static_proxy += excess / length * direction;
    const bool is_deepest = penetration.norm() >= kSaturatedShare * max_penetration;
    for (Body& body : bodies) {
      body.is_saturated =
          body.is_under_tool && is_deepest && (hip - proxy.centre()).norm() > max_penetration;
    }
  }
  if (!tip_before) tip_before = tip;
}

/// The penetration for a desired one of `desired` [m] along `direction`: changes by at most
/// `max_change` [m] in this cycle, so that the tip does not jump where the direction does.
/// Backtracks until the face that the tip came through is still the nearest: near an edge that is
/// less than in the middle of a face. It does not oscillate there, because it may stay as deep
/// as it was.
Eigen::Vector3d HapticWorld::Content::limited_penetration(const Eigen::Vector3d& direction,
                                                          double desired,
                                                          double max_change) const noexcept {
  const double before = penetration.norm();
  const Eigen::Vector3d start_at =
      before > desired ? Eigen::Vector3d(desired / before * penetration) : penetration;
  const Eigen::Vector3d change = desired * direction.stableNormalized() - start_at;
  const double change_norm = change.norm();
  const Eigen::Vector3d next =
      start_at + (change_norm > max_change ? max_change / change_norm : 1.0) * change;
  double depth = next.norm();
  if (depth <= proxy.radius()) return next;
  const Eigen::Vector3d unit = next / depth;
  for (int i = 0; i < kMaxBacktracks && depth > proxy.radius(); ++i) {
    if (is_through_contact_face(proxy.centre() + depth * unit)) return depth * unit;
    depth = depth > before ? before : kBacktrackFactor * depth;
  }
  return std::min(depth, proxy.radius()) * unit;
}

bool HapticWorld::Content::is_through_contact_face(const Eigen::Vector3d& p) const noexcept {
  return std::all_of(bodies.begin(), bodies.end(), [&](const Body& body) {
    if (!body.is_under_tool) return true;
    const auto at_tip = closest(body, p);
    const auto at_proxy = closest(body, proxy.centre(), 2.0 * proxy.radius());
    return !at_tip || !at_proxy || at_tip->normal.dot(at_proxy->normal) > kMinSameFaceCosine;
  });
}

void HapticWorld::Content::release() noexcept {
  hip = proxy.centre();
  goal = hip;
  static_proxy = hip;
  scan_normal.setZero();
  acceleration.reset();
  tip.reset();
  tip_before.reset();
  penetration.setZero();
  body_displacement = 0.0;
  for (Body& body : bodies) {
    body.is_under_tool = false;
    body.is_saturated = false;
  }
}

void HapticWorld::Content::start_falling(std::size_t i) noexcept {
  Body& body = bodies[i];
  const Eigen::Vector3d centre = body.T_base_object * body.shape.centre_of_mass;
  const auto edge = supports.nearest_edge(centre.head<2>(), body.shape.bottom);
  if (!edge) return;
  const BodyState& latest = world->state()[i];
  body.fall.emplace(detail::FallingBody::Start{
      body.T_base_object, body.shape.centre_of_mass, latest.planar.twist.head<2>(),
      body.shape.gyration_radius, *edge, options.max_tilt, options.max_fall_height,
      body.shape.surface.bounds()});
  body.is_under_tool = false;
  proxy.remove(kFirstBody + i);
  std::copy(world->state().begin(), world->state().end(), work.begin());
  work[i] = BodyState{};
  work[i].is_present = false;
  world->set_state(work);
}

void HapticWorld::Content::move_bodies(double dt) noexcept {
  if (tip) {
    world->step(*tip_before, *tip, dt);
  } else {
    world->rest(proxy.centre(), dt);
  }
  body_displacement = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    if (body.fall) {
      body.fall->step(gravity, dt, floor);
      body.T_base_object = body.fall->T_base_object();
      continue;
    }
    const Pose T_before = body.T_base_object;
    body.T_base_object = world->T_base_object(i);
    proxy.set_pose(kFirstBody + i, body.T_base_object);
    const Eigen::Vector2d centre = world->state()[i].planar.position;
    if (body.has_support && !supports.is_supported(centre, body.shape.bottom)) start_falling(i);
    if (body.is_under_tool) {
      const Eigen::Vector3d moved_centre =
          body.T_base_object * (T_before.inverse() * proxy.centre());
      body_displacement = std::max(body_displacement, (moved_centre - proxy.centre()).norm());
    }
  }
}

/// Moves the proxy out of bodies that overlap it.
void HapticWorld::Content::resolve_overlap() noexcept {
  for (int round = 0; round < kMaxOverlapIterations; ++round) {
    bool is_clear = true;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto answer = closest(bodies[i], proxy.centre());
      if (!answer) continue;
      const double overlap = proxy.radius() - answer->distance;
      if (overlap <= detail::kContactSlack) continue;
      const Eigen::Vector3d before = proxy.centre();
      proxy.resolve_overlap(before + (overlap + detail::kContactSlack) * answer->normal,
                            kFirstBody + i);
      body_displacement = std::max(body_displacement, (proxy.centre() - before).norm());
      is_clear = false;
    }
    if (is_clear) return;
  }
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

void HapticWorld::Content::publish_bodies() noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyState& latest = world->state()[i];
    HapticBodyState& published = state.bodies[i];
    published.T_base_object = bodies[i].fall ? bodies[i].T_base_object : world->shown(i);
    published.tool_force_base = latest.tool_force_base;
    published.phase = latest.phase;
    published.is_outside_model = bodies[i].fall.has_value();
    published.is_blocked = latest.is_blocked && state.is_engaged;
    published.is_saturated = bodies[i].is_saturated || latest.is_saturated;
  }
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
