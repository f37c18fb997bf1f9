// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/collider.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <BulletCollision/CollisionShapes/btConvexPolyhedron.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPolyhedralContactClipping.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <Eigen/Geometry>

#include "physics/prediction/convex_parts.hpp"
#include "physics/prediction/scan_points.hpp"

namespace pcavr::detail {
namespace {

/// Contacts with a more vertical normal (its z component) bear weight and do not stop sliding.
constexpr double kMaxSideNormalZ = 0.7;
/// Contacts with the static mesh are found up to this gap [m]: 3 m/s at 1 kHz, less the grid.
constexpr double kStaticMargin = 3e-3;
constexpr double kGrid = 0.25e-3;      // [m] below a scan's noise: its contacts then do not change
constexpr double kGridAngle = 2.5e-3;  // [rad] the same at 0.1 m from the centre of mass
/// Cosine between the normals of body and scan from which they are in contact: those of a scan with
/// noise are off by up to 60 degrees.
constexpr double kMinFacingCosine = 0.3;
/// Points of the static mesh near a body whose depths are kept with its contacts.
constexpr std::size_t kMaxNear = 8192;
/// Points that limit one motion; bisection of that motion; a tolerance against rounding [m].
constexpr std::size_t kMaxLimiting = 512;
constexpr int kBisections = 6;
constexpr double kDepthTolerance = 1e-9;
constexpr double kTouching = 1e-6;  // [m] distances beyond that are not needed of points outside
/// Points closer to each other [m] count as one.
constexpr double kMinApart = 1e-3;
/// Points found in one call before the reduction.
constexpr std::size_t kMaxFound = 4096;
/// Corners of a clipped face: those of two hulls at most.
constexpr int kMaxClipCorners = 256;

Eigen::Vector3d from_bullet(const btVector3& p) { return {p.x(), p.y(), p.z()}; }

btTransform to_bullet(const PlanarState& planar) {
  return btTransform(btQuaternion(btVector3(0.0, 0.0, 1.0), planar.yaw),
                     btVector3(planar.position.x(), planar.position.y(), 0.0));
}

/// Collects the points that Bullet reports, up to kMaxFound.
struct Points final : btDiscreteCollisionDetectorInterface::Result {
  std::vector<CollisionPoint> found;

  Points() { found.reserve(kMaxFound); }
  void setShapeIdentifiersA(int /*part*/, int /*index*/) override {}
  void setShapeIdentifiersB(int /*part*/, int /*index*/) override {}
  void addContactPoint(const btVector3& normal, const btVector3& point, btScalar gap) override {
    if (found.size() == kMaxFound) return;
    found.push_back({from_bullet(point), from_bullet(normal), -gap});
  }
};

/// Keeps the separating axis only.
struct Axis final : btDiscreteCollisionDetectorInterface::Result {
  bool is_found = false;
  btVector3 normal;
  btScalar gap = 0.0;

  void setShapeIdentifiersA(int /*part*/, int /*index*/) override {}
  void setShapeIdentifiersB(int /*part*/, int /*index*/) override {}
  void addContactPoint(const btVector3& the_normal, const btVector3& /*point*/,
                       btScalar the_gap) override {
    is_found = true;
    normal = the_normal;
    gap = the_gap;
  }
};

/// Contact reduction: in the plane a few points suffice: of each direction of the normal the
/// deepest one, and the ones furthest to either side, where 1 mm of depth counts as 100 mm to the
/// side: with less, points with a gap hide those that bear, and the body creeps from one to
/// another.
void reduce_contacts(std::vector<CollisionPoint>& found, std::vector<CollisionPoint>& points) {
  std::array<bool, kMaxFound> is_used{};
  std::size_t room = Collider::kMaxPoints;
  while (room > 0) {
    std::size_t first = kMaxFound;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!is_used[i] && (first == kMaxFound || found[i].depth > found[first].depth)) first = i;
    }
    if (first == kMaxFound) return;
    const Eigen::Vector3d normal = found[first].normal;
    const Eigen::Vector2d along(-normal.y(), normal.x());
    std::array<std::size_t, 2> ends{first, first};
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    std::array<double, 2> best{kNone, kNone};
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (is_used[i] || found[i].normal.dot(normal) < 0.9) continue;
      is_used[i] = true;
      for (std::size_t side = 0; side < 2; ++side) {
        const double offset = (side == 0 ? 1.0 : -1.0) * along.dot(found[i].p_base.head<2>());
        const double score = offset + 100.0 * found[i].depth;
        if (score > best[side]) {
          best[side] = score;
          ends[side] = i;
        }
      }
    }
    if (ends[1] == ends[0]) ends[1] = first;
    points.push_back(found[first]);
    --room;
    for (const std::size_t i : ends) {
      const bool is_apart = (found[i].p_base - found[first].p_base).head<2>().norm() > kMinApart;
      if (!is_apart || room == 0) continue;
      points.push_back(found[i]);
      --room;
    }
  }
}

}  // namespace

struct Collider::Content {
  /// A point of the static mesh closer than kStaticMargin to a body, and its depth [m] inside it.
  struct NearPoint {
    Eigen::Vector3d p_base;
    double depth = 0.0;
  };
  /// A point that gets too deep in a motion, and the depth [m] that it may have.
  struct LimitingPoint {
    Eigen::Vector3d p_base;
    double max_depth = 0.0;
  };
  struct Body {
    Body() = default;
    Body(Body&&) = default;  // so that a vector does not look for a copy

    std::vector<std::unique_ptr<btConvexHullShape>> hulls;
    double reach = 0.0;
    const ClosestSurface* surface = nullptr;
    ScanPoints scan;
    // Cached contacts with the static mesh: a function of the grid's pose alone.
    PlanarState grid_pose;
    std::vector<CollisionPoint> static_points;
    std::vector<NearPoint> near;
    double max_depth = 0.0;     ///< [m] of the near points
    bool has_all_near = false;  ///< false: there were more than kMaxNear
    bool has_static_points = false;
  };
  explicit Content(const WorldOptions& world_options) : options(world_options) {}

  WorldOptions options;
  std::vector<Body> bodies;
  // Work space, so that a query does not allocate.
  Points found;
  btVertexArray clip_in;
  btVertexArray clip_out;
  btVoronoiSimplexSolver simplex;
  std::vector<LimitingPoint> limiting;

  void add(const WorldBody& body, const UprightBody& upright, const TriangleMesh& static_mesh_base);
  void collide(const btConvexHullShape& a, const btTransform& T_a, const btConvexHullShape& b,
               const btTransform& T_b, double margin);
  [[nodiscard]] Axis axis_between(const btConvexShape& a, const btTransform& T_a,
                                  const btConvexShape& b, const btTransform& T_b, double margin);
  void search_static(Body& body);
  void update_static(Body& body, const PlanarState& planar);
  void find_limiting(const Body& body, const PlanarState& before, const PlanarState& after);
};

namespace {

Eigen::Vector3d in_body_axes(const PlanarState& planar, const Eigen::Vector3d& p_base) {
  Eigen::Vector3d p = p_base;
  p.head<2>() =
      Eigen::Rotation2Dd(-planar.yaw) * Eigen::Vector2d(p_base.head<2>() - planar.position);
  return p;
}

PlanarState interpolated(const PlanarState& from, const PlanarState& to, double share) {
  PlanarState result = from;
  result.position += share * (to.position - from.position);
  result.yaw += share * (to.yaw - from.yaw);
  return result;
}

/// [m] by which any point of the body moves between two states, at most.
template <typename Body>
double max_travel(const Body& body, const PlanarState& from, const PlanarState& to) {
  return (to.position - from.position).norm() + body.reach * std::abs(to.yaw - from.yaw);
}

/// Calls visit(point) for the points of the static mesh closer than `margin` [m] to the body's
/// bounding box.
template <typename Body, typename Visit>
void visit_around(const Body& body, const PlanarState& planar, double margin, const Visit& visit) {
  Eigen::AlignedBox3d box = body.surface->bounds();
  box.min().array() -= margin;
  box.max().array() += margin;
  const Eigen::Rotation2Dd turn(planar.yaw);
  Eigen::AlignedBox2d area;
  for (const auto corner :
       {Eigen::AlignedBox3d::BottomLeftFloor, Eigen::AlignedBox3d::BottomRightFloor,
        Eigen::AlignedBox3d::TopLeftFloor, Eigen::AlignedBox3d::TopRightFloor}) {
    area.extend(planar.position + turn * Eigen::Vector2d(box.corner(corner).template head<2>()));
  }
  body.scan.visit_in(area, [&](const ScanPoints::Point& point) {
    if (box.contains(in_body_axes(planar, point.p_base))) visit(point);
  });
}

}  // namespace

void Collider::Content::add(const WorldBody& body, const UprightBody& upright,
                            const TriangleMesh& static_mesh_base) {
  const Eigen::Vector3d centre = body.T_base_object * body.model.centre_of_mass_object;
  const Pose T_body_object =
      Pose::from_translation({-centre.x(), -centre.y(), 0.0}) * body.T_base_object;
  Body& added = bodies.emplace_back();
  added.static_points.reserve(kMaxPoints);
  added.hulls = convex_parts(body.model.mesh_object, T_body_object, options.shape_tolerance,
                             static_cast<std::size_t>(options.max_convex_parts));
  for (const auto& v : body.model.mesh_object.vertices) {
    const Eigen::Vector3d p = T_body_object * v.cast<double>();
    added.reach = std::max(added.reach, p.head<2>().norm());
  }
  added.surface = &upright.surface();
  if (!upright.is_movable()) return;
  added.scan = ScanPoints(upright.surface(), upright.start(), static_mesh_base, options);
  if (!added.scan.is_empty()) added.near.reserve(kMaxNear);
}

Axis Collider::Content::axis_between(const btConvexShape& a, const btTransform& T_a,
                                     const btConvexShape& b, const btTransform& T_b,
                                     double margin) {
  btGjkPairDetector detector(&a, &b, a.getShapeType(), b.getShapeType(), 0.0, 0.0, &simplex,
                             nullptr);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = T_a;
  input.m_transformB = T_b;
  input.m_maximumDistanceSquared = margin * margin;
  Axis axis;
  detector.getClosestPoints(input, axis, nullptr);
  return axis;
}

void Collider::Content::collide(const btConvexHullShape& a, const btTransform& T_a,
                                const btConvexHullShape& b, const btTransform& T_b, double margin) {
  const btConvexPolyhedron& hull_a = *a.getConvexPolyhedron();
  const btConvexPolyhedron& hull_b = *b.getConvexPolyhedron();
  btVector3 normal;
  if (!btPolyhedralContactClipping::findSeparatingAxis(hull_a, hull_b, T_a, T_b, normal, found)) {
    const Axis axis = axis_between(a, T_a, b, T_b, margin);
    if (!axis.is_found || axis.gap > margin) return;
    normal = axis.normal;
  }
  if (std::abs(normal.z()) > kMaxSideNormalZ) return;
  clip_in.resize(0);
  btPolyhedralContactClipping::clipHullAgainstHull(normal, hull_a, hull_b, T_a, T_b, -1e3, margin,
                                                   clip_in, clip_out, found);
}

/// Contacts along the normal of the body's surface: that of a noisy scan scatters by as much as
/// its noise over the distance of its points.
void Collider::Content::search_static(Body& body) {
  const Eigen::Rotation2Dd turn(body.grid_pose.yaw);
  found.found.clear();
  body.near.clear();
  body.max_depth = -kStaticMargin;
  body.has_all_near = true;
  visit_around(body, body.grid_pose, kStaticMargin, [&](const ScanPoints::Point& point) {
    const Eigen::Vector3d& p_base = point.p_base;
    const auto closest = body.surface->closest(in_body_axes(body.grid_pose, p_base), kStaticMargin);
    if (!closest || -closest->distance > options.max_scan_depth) return;
    if (body.near.size() == kMaxNear) {
      body.has_all_near = false;
      return;
    }
    const double depth = -closest->distance;
    body.near.push_back({p_base, depth});
    body.max_depth = std::max(body.max_depth, depth);
    if (std::abs(closest->normal.z()) > kMaxSideNormalZ) return;
    if (found.found.size() == kMaxFound) return;
    Eigen::Vector3d normal = -closest->normal;
    normal.head<2>() = turn * normal.head<2>();
    // At a body's edge the nearest face may be one that this surface does not face.
    if (std::abs(normal.dot(point.normal_base.cast<double>())) < kMinFacingCosine) return;
    found.found.push_back({p_base, normal, depth});
  });
  body.static_points.clear();
  reduce_contacts(found.found, body.static_points);
}

void Collider::Content::update_static(Body& body, const PlanarState& planar) {
  PlanarState pose;
  pose.position = (planar.position / kGrid).array().round() * kGrid;
  pose.yaw = std::round(planar.yaw / kGridAngle) * kGridAngle;
  if (body.has_static_points && body.grid_pose.position == pose.position &&
      body.grid_pose.yaw == pose.yaw) {
    return;
  }
  body.grid_pose = pose;
  body.has_static_points = true;
  search_static(body);
}

/// The points that get deeper than they may between two states.
void Collider::Content::find_limiting(const Body& body, const PlanarState& before,
                                      const PlanarState& after) {
  limiting.clear();
  const auto check = [&](const Eigen::Vector3d& p_base) {
    const auto at_end = body.surface->closest(in_body_axes(after, p_base), kTouching);
    if (!at_end || -at_end->distance <= options.max_scan_penetration) return;
    const auto at_begin = body.surface->closest(in_body_axes(before, p_base), kTouching);
    const double depth = at_begin ? -at_begin->distance : 0.0;
    if (depth > options.max_scan_depth || limiting.size() == kMaxLimiting) return;
    const double max_depth = std::max(depth, options.max_scan_penetration) + kDepthTolerance;
    if (-at_end->distance > max_depth) limiting.push_back({p_base, max_depth});
  };
  const double travel = max_travel(body, body.grid_pose, after);
  if (!body.has_all_near || travel > kStaticMargin) {
    visit_around(body, after, 0.0, [&](const ScanPoints::Point& point) { check(point.p_base); });
    return;
  }
  for (const NearPoint& point : body.near) {
    if (point.depth + travel > options.max_scan_penetration) check(point.p_base);
  }
}

Collider::Collider(const std::vector<WorldBody>& bodies, const std::vector<UprightBody>& upright,
                   const TriangleMesh& static_mesh_base, const WorldOptions& options)
    : content_(std::make_unique<Content>(options)) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    content_->add(bodies[i], upright[i], static_mesh_base);
  }
  content_->limiting.reserve(kMaxLimiting);
  content_->clip_in.reserve(kMaxClipCorners);
  content_->clip_out.reserve(kMaxClipCorners);
}
Collider::~Collider() = default;

bool Collider::has_shape(std::size_t body) const { return !content_->bodies[body].hulls.empty(); }
double Collider::reach(std::size_t body) const { return content_->bodies[body].reach; }

void Collider::between(std::size_t a, const PlanarState& planar_a, std::size_t b,
                       const PlanarState& planar_b, double margin,
                       std::vector<CollisionPoint>& points) {
  Content& c = *content_;
  const btTransform T_a = to_bullet(planar_a);
  const btTransform T_b = to_bullet(planar_b);
  c.found.found.clear();
  for (const auto& hull_a : c.bodies[a].hulls) {
    for (const auto& hull_b : c.bodies[b].hulls) {
      btVector3 low_a, high_a, low_b, high_b;
      hull_a->getAabb(T_a, low_a, high_a);
      hull_b->getAabb(T_b, low_b, high_b);
      const btVector3 gap(margin, margin, 0.0);
      if (!TestAabbAgainstAabb2(low_a - gap, high_a + gap, low_b, high_b)) continue;
      c.collide(*hull_a, T_a, *hull_b, T_b, margin);
    }
  }
  reduce_contacts(c.found.found, points);
}

void Collider::with_static(std::size_t a, const PlanarState& planar,
                           std::vector<CollisionPoint>& points) {
  Content::Body& body = content_->bodies[a];
  if (body.scan.is_empty()) return;
  content_->update_static(body, planar);
  const PlanarState& cached = body.grid_pose;
  for (CollisionPoint point : body.static_points) {
    const Eigen::Vector2d arm = point.p_base.head<2>() - cached.position;
    const double rotation = planar.yaw - cached.yaw;
    const Eigen::Vector2d displacement = planar.position - cached.position +
                                         Eigen::Vector2d(-rotation * arm.y(), rotation * arm.x());
    point.depth -= point.normal.head<2>().dot(displacement);
    point.p_base.head<2>() += displacement;
    points.push_back(point);
  }
}

double Collider::collision_free_share(std::size_t a, const PlanarState& before,
                                      const PlanarState& after) {
  Content& c = *content_;
  Content::Body& body = c.bodies[a];
  if (body.scan.is_empty()) return 1.0;
  c.update_static(body, before);
  const double travel = max_travel(body, body.grid_pose, after);
  const bool is_clear = body.has_all_near && travel <= kStaticMargin &&
                        body.max_depth + travel <= c.options.max_scan_penetration;
  if (is_clear) return 1.0;
  c.find_limiting(body, before, after);
  if (c.limiting.empty()) return 1.0;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    const PlanarState there = interpolated(before, after, middle);
    const bool is_free =
        std::all_of(c.limiting.begin(), c.limiting.end(), [&](const Content::LimitingPoint& point) {
          const auto closest = body.surface->closest(in_body_axes(there, point.p_base), kTouching);
          return !closest || -closest->distance <= point.max_depth;
        });
    (is_free ? low : high) = middle;
  }
  return low;
}

}  // namespace pcavr::detail
