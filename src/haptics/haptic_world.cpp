// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_world.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pcavr/core/check.hpp"

#include "haptics/ball.hpp"
#include "haptics/body_shape.hpp"
#include "haptics/falling_body.hpp"
#include "haptics/friction_cone.hpp"
#include "haptics/supports.hpp"
#include "prediction/contact_force.hpp"
#include "prediction/tip_contact.hpp"

namespace pcavr {
namespace {

/// The ball's surfaces: the scan, the supports, and then the bodies.
constexpr std::size_t kFirstBody = 2;
/// [m/s] at which the tool sinks into a body at most: a hand that was put somewhere else pushes a
/// body away, and does not hit it.
constexpr double kSinking = 1.0;
/// [m/s] by which the ball is faster than the hand while it lags behind it and nothing is between
/// them: it fell back where its way over a rough surface or around a body was the longer one.
constexpr double kCatchingUp = 0.5;
/// Of what all bodies together are held by: a tool that pushes harder moves nothing that it did not
/// move before.
constexpr double kPushing = 2.0;
/// [N] that a hand pushes with at most.
constexpr double kStrongestHand = 200.0;
/// Of a body's thickness, beyond which its other side would be the nearer one.
constexpr double kHalf = 0.45;
/// Cosine between the normals where the tip is nearest and where the ball rests: of one face.
constexpr double kSameFace = 0.7;
/// A tip that is too deep is drawn back in such steps.
constexpr double kLess = 0.9;
constexpr int kMaxTries = 8;
/// [m] Where the tool of the prediction is while it pushes nothing: far from everything.
const Eigen::Vector3d kAway(0.0, 0.0, 1e4);
/// [m] Where a body that fell lies in the prediction, and how far from the next one.
constexpr double kAside = 1e4;
/// [m] A tip that is farther from base along any axis is taken for an error.
constexpr double kFarthest = 1e3;
/// How often the ball is moved out of bodies that came upon it.
constexpr int kMaxEvasions = 12;

bool is_told(const Eigen::Vector3d& p) noexcept { return (p.array().abs() <= kFarthest).all(); }

}  // namespace

struct HapticWorld::Content {
  struct Body {
    explicit Body(detail::BodyShape body_shape) : shape(std::move(body_shape)) {}

    detail::BodyShape shape;
    double max_depth = 0.0;      ///< [m] to which the tool sinks in
    bool has_support = false;    ///< it stood above one at the start
    bool is_under_tool = false;  ///< the ball rests on it
    Pose T_base_object;          ///< after the latest step
    std::optional<detail::FallingBody> fall;
  };

  Content(const HapticWorldModel& model, PredictedWorld predicted);

  void reset(const Eigen::Vector3d& tip) noexcept;
  void step(const ToolCommand& command, double dt) noexcept;

 private:
  [[nodiscard]] bool has_room(const Eigen::Vector3d& centre) const noexcept;
  [[nodiscard]] bool is_near(const Body& body, const Eigen::Vector3d& p) const noexcept;
  [[nodiscard]] std::optional<detail::ClosestSurface::Answer> closest(const Body& body,
                                                                      const Eigen::Vector3d& p,
                                                                      double reach) const noexcept;
  [[nodiscard]] auto closest(const Body& body, const Eigen::Vector3d& p) const noexcept {
    return closest(body, p, ball.radius());
  }
  [[nodiscard]] bool is_resting_on_body() const noexcept;
  [[nodiscard]] bool may_catch_up() const noexcept;
  void follow(double moved, double dt) noexcept;
  void sink_in(double dt) noexcept;
  [[nodiscard]] Eigen::Vector3d sunk_towards(const Eigen::Vector3d& along, double deep,
                                             double most) const noexcept;
  [[nodiscard]] bool is_through_its_face(const Eigen::Vector3d& p) const noexcept;
  void let_go() noexcept;
  void move_bodies(double dt) noexcept;
  void drop(std::size_t i) noexcept;
  void evade() noexcept;
  void feel(const Eigen::Vector3d& device, double dt) noexcept;
  void publish_bodies() noexcept;

 public:
  PredictedWorld world;
  std::vector<BodyState> start;
  std::vector<BodyState> work;  ///< so that a body can be put aside without the heap
  detail::Supports supports;
  detail::Ball ball;
  RenderedForce force;
  double gravity;
  double friction;
  double min_force;
  double top = 0.0;  ///< [m] above everything
  std::vector<Body> bodies;
  HapticWorldState state;

  bool is_placed = false;
  double carried = 0.0;  ///< [m] by which bodies under the tool moved in the latest step
  Eigen::Vector3d sunk = Eigen::Vector3d::Zero();  ///< from the ball to the prediction's tip
  Eigen::Vector3d scan_normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d hip = Eigen::Vector3d::Zero();
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip = kAway;                        ///< of the prediction
  Eigen::Vector3d tip_before = kAway;                 ///< a step earlier
  Eigen::Vector3d on_scan = Eigen::Vector3d::Zero();  ///< where the scan alone would hold the hand
};

HapticWorld::Content::Content(const HapticWorldModel& model, PredictedWorld predicted)
    : world(std::move(predicted)),
      start(world.state()),
      work(start),
      supports(model.supports_base),
      ball(model.world.tool_radius),
      force(model.force),
      gravity(model.world.gravity),
      friction(model.scan_friction),
      min_force(model.force.min_force) {
  ball.add_static(model.world.static_mesh_base);
  const TriangleMesh level = supports.surface_base();
  ball.add_static(level);
  for (const TriangleMesh* mesh : {&model.world.static_mesh_base, &level}) {
    for (const Eigen::Vector3f& v : mesh->vertices) top = std::max(top, static_cast<double>(v.z()));
  }
  double held = 0.0;
  for (const WorldBody& body : model.world.bodies) held += holding_force(body.physics.friction);
  for (const WorldBody& body : model.world.bodies) {
    ball.add_moving(body.model.mesh_object);
    Body& added = bodies.emplace_back(detail::shape_of(body));
    const double push = std::min(kPushing * held, kStrongestHand);
    const double pushed = detail::depth_at(body.physics.contact, push);
    added.max_depth = std::min(pushed, ball.radius() + kHalf * added.shape.thinnest);
    const Eigen::Vector3d centre = body.T_base_object * added.shape.centre_of_mass;
    added.has_support = supports.bear(centre.head<2>(), added.shape.foot);
    const Eigen::Vector3d middle = body.T_base_object * added.shape.middle;
    top = std::max(top, middle.z() + added.shape.reach);
  }
  top += 2.0 * ball.radius();
  state.bodies.resize(bodies.size());
  reset({0.0, 0.0, top});
}

bool HapticWorld::Content::is_near(const Body& body, const Eigen::Vector3d& p) const noexcept {
  if (body.fall) return false;
  const double reach = body.shape.reach + 2.0 * ball.radius();
  return (body.T_base_object * body.shape.middle - p).squaredNorm() < reach * reach;
}

/// The body's surface seen from `p`, in base, where it is nearer than `reach`, or `p` inside.
std::optional<detail::ClosestSurface::Answer> HapticWorld::Content::closest(
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

bool HapticWorld::Content::has_room(const Eigen::Vector3d& centre) const noexcept {
  return ball.has_room(centre) && std::none_of(bodies.begin(), bodies.end(), [&](const Body& body) {
           return closest(body, centre).has_value();
         });
}

void HapticWorld::Content::reset(const Eigen::Vector3d& wanted) noexcept {
  world.set_state(start);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].fall.reset();
    bodies[i].is_under_tool = false;
    bodies[i].T_base_object = world.T_base_object(i);
    ball.place(kFirstBody + i, bodies[i].T_base_object);
  }
  is_placed = is_told(wanted);
  Eigen::Vector3d centre = is_placed ? wanted : Eigen::Vector3d(0.0, 0.0, top);
  while (centre.z() < top && !has_room(centre)) centre.z() += 0.5 * ball.radius();
  ball.put(centre);
  hip = centre;
  let_go();
  state.force_base.setZero();
  state.is_engaged = false;
  state.touches_scan = false;
  state.touched_body = -1;
  state.p_base_hip = hip;
  state.p_base_proxy = centre;
  publish_bodies();
}

/// Whether the tool would be free where the hand is, and could go there straight.
bool HapticWorld::Content::may_catch_up() const noexcept {
  if (is_resting_on_body() || ball.centre() == hip || ball.is_kept_apart(hip)) return false;
  return std::none_of(bodies.begin(), bodies.end(),
                      [&](const Body& body) { return closest(body, hip).has_value(); });
}

/// The ball after the hand, which `moved` [m].
void HapticWorld::Content::follow(double moved, double dt) noexcept {
  goal = detail::held_back(hip, ball.centre(), scan_normal, friction);
  const double budget = moved + carried + (may_catch_up() ? kCatchingUp * dt : 0.0);
  if (!(budget > 0.0)) return;
  ball.follow(goal, budget, budget);
  scan_normal = ball.static_normal(hip);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    body.is_under_tool = is_near(body, ball.centre()) && ball.rests_on(kFirstBody + i, goal);
  }
}

bool HapticWorld::Content::is_resting_on_body() const noexcept {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return body.is_under_tool; });
}

/// Where the prediction's tip is: at the ball, or sunk from there into what the ball rests on.
void HapticWorld::Content::sink_in(double dt) noexcept {
  tip_before = tip;
  tip = ball.centre();
  on_scan = ball.centre();
  if (!is_resting_on_body()) {
    sunk.setZero();
  } else {
    double deepest = std::numeric_limits<double>::infinity();
    for (const Body& body : bodies) {
      if (body.is_under_tool) deepest = std::min(deepest, body.max_depth);
    }
    double left = deepest;
    on_scan = ball.beyond_the_moving(goal, left);
    const Eigen::Vector3d way = on_scan - ball.centre();
    const double length = way.norm();
    sunk = sunk_towards(way, std::min(length, deepest), kSinking * dt);
    // The prediction would take the tip for one that was put there, and the body out of its way.
    const Eigen::Vector3d moved = ball.centre() + sunk - tip_before;
    if (moved.norm() > detail::kFastestTip * dt) sunk.setZero();
    tip += sunk;
    // What the hand is deeper than a body lets the tool sink in is not the scan's to bear.
    const double beyond = length > 0.0 ? (hip - on_scan).dot(way) / length : 0.0;
    if (left <= 0.0 && beyond > 0.0) on_scan += beyond / length * way;
  }
  if (tip_before == kAway) tip_before = tip;
}

/// How the tip is sunk when it would be so deep [m] along a direction: it turns and sinks by `most`
/// [m] in this cycle, so that where the direction swings the tip does not leap. Only so far that
/// what it came through is still what is nearest: near an edge that is less than in the middle of a
/// face. It does not waver there, for it stays as deep as it was.
Eigen::Vector3d HapticWorld::Content::sunk_towards(const Eigen::Vector3d& along, double deep,
                                                   double most) const noexcept {
  const double before = sunk.norm();
  const Eigen::Vector3d held = before > deep ? Eigen::Vector3d(deep / before * sunk) : sunk;
  const Eigen::Vector3d change = deep * along.stableNormalized() - held;
  const double size = change.norm();
  const Eigen::Vector3d wanted = held + (size > most ? most / size : 1.0) * change;
  double depth = wanted.norm();
  if (depth <= ball.radius()) return wanted;
  const Eigen::Vector3d direction = wanted / depth;
  for (int tries = 0; tries < kMaxTries && depth > ball.radius(); ++tries) {
    if (is_through_its_face(ball.centre() + depth * direction)) return depth * direction;
    depth = depth > before ? before : kLess * depth;
  }
  return std::min(depth, ball.radius()) * direction;
}

bool HapticWorld::Content::is_through_its_face(const Eigen::Vector3d& p) const noexcept {
  return std::all_of(bodies.begin(), bodies.end(), [&](const Body& body) {
    if (!body.is_under_tool) return true;
    const auto at_tip = closest(body, p);
    const auto at_ball = closest(body, ball.centre(), 2.0 * ball.radius());
    return !at_tip || !at_ball || at_tip->normal.dot(at_ball->normal) > kSameFace;
  });
}

void HapticWorld::Content::let_go() noexcept {
  hip = ball.centre();
  goal = hip;
  on_scan = hip;
  scan_normal.setZero();
  tip = kAway;
  tip_before = kAway;
  sunk.setZero();
  carried = 0.0;
  for (Body& body : bodies) body.is_under_tool = false;
}

void HapticWorld::Content::drop(std::size_t i) noexcept {
  Body& body = bodies[i];
  const Eigen::Vector3d centre = body.T_base_object * body.shape.centre_of_mass;
  const auto edge = supports.nearest_edge(centre.head<2>(), body.shape.foot);
  if (!edge) return;
  const BodyState& last = world.state()[i];
  body.fall.emplace(detail::FallingBody::Start{body.T_base_object, body.shape.centre_of_mass,
                                               last.planar.twist.head<2>(),
                                               body.shape.gyration_radius, *edge});
  body.is_under_tool = false;
  ball.remove(kFirstBody + i);
  std::copy(world.state().begin(), world.state().end(), work.begin());
  work[i] = BodyState{};
  work[i].planar.position = {kAside * static_cast<double>(i + 1), kAside};
  world.set_state(work);
}

void HapticWorld::Content::move_bodies(double dt) noexcept {
  world.step(tip_before, tip, dt);
  carried = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    if (body.fall) {
      body.fall->step(gravity, dt);
      body.T_base_object = body.fall->T_base_object();
      continue;
    }
    const Pose T_before = body.T_base_object;
    body.T_base_object = world.T_base_object(i);
    ball.place(kFirstBody + i, body.T_base_object);
    const Eigen::Vector2d centre = world.state()[i].planar.position;
    if (body.has_support && !supports.bear(centre, body.shape.foot)) drop(i);
    if (body.is_under_tool) {
      const Eigen::Vector3d carried_to = body.T_base_object * (T_before.inverse() * ball.centre());
      carried = std::max(carried, (carried_to - ball.centre()).norm());
    }
  }
}

/// Out of the way of bodies that came upon the ball.
void HapticWorld::Content::evade() noexcept {
  for (int round = 0; round < kMaxEvasions; ++round) {
    bool is_clear = true;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto answer = closest(bodies[i], ball.centre());
      if (!answer) continue;
      const double overlap = ball.radius() - answer->distance;
      if (overlap <= detail::kTouching) continue;
      const Eigen::Vector3d before = ball.centre();
      ball.evade(before + (overlap + detail::kTouching) * answer->normal, kFirstBody + i);
      carried = std::max(carried, (ball.centre() - before).norm());
      is_clear = false;
    }
    if (is_clear) return;
  }
}

void HapticWorld::Content::feel(const Eigen::Vector3d& device, double dt) noexcept {
  Eigen::Vector3d of_bodies = Eigen::Vector3d::Zero();
  double strongest = -1.0;
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  state.touched_body = -1;
  for (std::size_t i = 0; i < bodies.size() && state.is_engaged; ++i) {
    const Eigen::Vector3d& there = world.state()[i].tool_force_base;
    of_bodies -= there;
    if (const auto answer = closest(bodies[i], hip)) out = answer->normal;
    if (!bodies[i].is_under_tool || there.norm() <= strongest) continue;
    strongest = there.norm();
    state.touched_body = static_cast<int>(i);
  }
  const bool is_apart = state.is_engaged && ball.is_kept_apart(hip);
  if (is_apart && out.isZero(0.0)) out = (ball.centre() - hip).stableNormalized();
  // A body that runs away from the tool, or what the ball has not reached yet.
  if (of_bodies.norm() < min_force) of_bodies = min_force * out;
  const Eigen::Vector3d lift = on_scan - hip;
  state.touches_scan = is_apart && lift.norm() > detail::kTouching;
  state.force_base = force.step(device, device + lift, state.touches_scan, dt, of_bodies);
}

void HapticWorld::Content::publish_bodies() noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyState& last = world.state()[i];
    HapticBodyState& shown = state.bodies[i];
    shown.T_base_object = bodies[i].T_base_object;
    shown.tool_force_base = last.tool_force_base;
    shown.phase = last.phase;
    shown.is_outside_model = bodies[i].fall.has_value();
  }
}

void HapticWorld::Content::step(const ToolCommand& command, double dt) noexcept {
  if (!(dt > 0.0) || !std::isfinite(dt)) return;
  if (!is_placed && is_told(command.p_base_tip)) reset(command.p_base_tip);
  state.is_engaged = command.is_engaged && is_told(command.p_base_tip);
  if (state.is_engaged) {
    const double moved = (command.p_base_tip - hip).norm();
    hip = command.p_base_tip;
    follow(moved, dt);
    sink_in(dt);
  } else {
    let_go();
  }
  move_bodies(dt);
  evade();
  if (!state.is_engaged) hip = ball.centre();
  feel(command.p_base_tip, dt);
  state.p_base_hip = hip;
  state.p_base_proxy = ball.centre();
  publish_bodies();
}

HapticWorld::HapticWorld(std::unique_ptr<Content> content) : content_(std::move(content)) {}
HapticWorld::HapticWorld(HapticWorld&&) noexcept = default;
HapticWorld& HapticWorld::operator=(HapticWorld&&) noexcept = default;
HapticWorld::~HapticWorld() = default;

Expected<HapticWorld> HapticWorld::create(const HapticWorldModel& model) {
  PCAVR_REQUIRE(std::isfinite(model.scan_friction) && model.scan_friction >= 0.0,
                model.scan_friction);
  auto predicted = PredictedWorld::create(model.world);
  if (!predicted) return predicted.error();
  return HapticWorld(std::make_unique<Content>(model, std::move(predicted).value()));
}

std::size_t HapticWorld::size() const { return content_->bodies.size(); }
const std::string& HapticWorld::name(std::size_t body) const { return content_->world.name(body); }
void HapticWorld::reset(const Eigen::Vector3d& p_base_tip) noexcept { content_->reset(p_base_tip); }
void HapticWorld::step(const ToolCommand& command, double dt) noexcept {
  content_->step(command, dt);
}
const HapticWorldState& HapticWorld::state() const { return content_->state; }

}  // namespace pcavr
