// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/collider.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btConvexPolyhedron.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPolyhedralContactClipping.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <Eigen/Geometry>

#include "prediction/convex_parts.hpp"
#include "prediction/upright_body.hpp"

namespace pcavr::detail {
namespace {

/// Contacts with a more vertical normal (its z component) bear weight and do not stop sliding.
constexpr double kMaxSideNormalZ = 0.7;
/// Contacts with the static mesh are found up to this gap [m]: 3 m/s at 1 kHz, less the grid.
constexpr double kStaticMargin = 3e-3;
constexpr double kGrid = 0.25e-3;      // [m] below a scan's noise: its contacts then do not change
constexpr double kGridAngle = 2.5e-3;  // [rad] the same at 0.1 m from the centre of mass
/// Points closer to each other [m] count as one.
constexpr double kMinApart = 1e-3;
/// Points found in one call before the reduction.
constexpr std::size_t kMaxFound = 2048;
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
  double max_depth = std::numeric_limits<double>::infinity();

  Points() { found.reserve(kMaxFound); }
  void setShapeIdentifiersA(int /*part*/, int /*index*/) override {}
  void setShapeIdentifiersB(int /*part*/, int /*index*/) override {}
  void addContactPoint(const btVector3& normal, const btVector3& point, btScalar gap) override {
    if (found.size() == kMaxFound || -gap > max_depth) return;
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
/// deepest one, and the ones furthest to either side, where 1 mm of depth counts as 10 mm to the
/// side.
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
        const double score = offset + 10.0 * found[i].depth;
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
  struct Body {
    std::vector<std::unique_ptr<btConvexHullShape>> hulls;
    double reach = 0.0;
    double foot = 0.0;  ///< height of its lowest point in base [m]
    // Cached contacts with the static mesh: a function of the grid's pose alone.
    std::array<double, 3> grid_pose{};
    std::vector<CollisionPoint> static_points;
    bool has_static_points = false;
  };
  explicit Content(const WorldOptions& world_options) : options(world_options) {}

  WorldOptions options;
  std::vector<Body> bodies;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> triangles;
  std::unique_ptr<btBvhTriangleMeshShape> mesh;
  // Work space, so that a query does not allocate.
  Points found;
  btVertexArray clip_in;
  btVertexArray clip_out;
  btVoronoiSimplexSolver simplex;

  void add(const WorldBody& body);
  void add(const TriangleMesh& static_mesh_base);
  void collide(const btConvexHullShape& a, const btTransform& T_a, const btConvexHullShape& b,
               const btTransform& T_b, double margin);
  [[nodiscard]] Axis axis_between(const btConvexShape& a, const btTransform& T_a,
                                  const btConvexShape& b, const btTransform& T_b, double margin);
  void collide(const btConvexHullShape& a, const btTransform& T_a, const btVector3* triangle,
               double margin);
  void search_static(Body& body, const btTransform& T_body);
};

void Collider::Content::add(const WorldBody& body) {
  const Eigen::Vector3d centre = body.T_base_object * body.model.centre_of_mass_object;
  const Pose T_body_object =
      Pose::from_translation({-centre.x(), -centre.y(), 0.0}) * body.T_base_object;
  Body& added = bodies.emplace_back();
  added.static_points.reserve(kMaxPoints);
  added.hulls = convex_parts(body.model.mesh_object, T_body_object, options.shape_tolerance,
                             static_cast<std::size_t>(options.max_convex_parts));
  added.foot = std::numeric_limits<double>::infinity();
  for (const auto& v : body.model.mesh_object.vertices) {
    const Eigen::Vector3d p = T_body_object * v.cast<double>();
    added.reach = std::max(added.reach, p.head<2>().norm());
    added.foot = std::min(added.foot, p.z());
  }
}

void Collider::Content::add(const TriangleMesh& static_mesh_base) {
  for (const auto& v : static_mesh_base.vertices) vertices.push_back(v.cast<double>());
  for (const auto& t : static_mesh_base.triangles) {
    const Eigen::Vector3d normal =
        (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
    if (!(std::abs(normal.z()) < kMaxSideNormalZ * normal.norm())) continue;
    for (const std::uint32_t index : t) indices.push_back(static_cast<int>(index));
  }
  if (indices.empty()) return;
  triangles = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(indices.size() / 3), indices.data(), static_cast<int>(3 * sizeof(int)),
      static_cast<int>(vertices.size()), vertices.front().data(),
      static_cast<int>(sizeof(Eigen::Vector3d)));
  mesh = std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true);
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

void Collider::Content::collide(const btConvexHullShape& a, const btTransform& T_a,
                                const btVector3* triangle, double margin) {
  btVector3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const btConvexPolyhedron& hull = *a.getConvexPolyhedron();
  // A back face belongs to another object, or to a scan of this body.
  if (normal.fuzzyZero() || normal.dot(T_a * hull.m_localCenter - triangle[0]) <= 0.0) return;
  normal.normalize();
  // The triangle's own normal as the axis: a scanned wall is many small triangles, for each of
  // which GJK would give one point, at ten times the cost.
  const btVector3 nearest =
      T_a * a.localGetSupportingVertexWithoutMargin(T_a.getBasis().transpose() * -normal);
  const btScalar gap = normal.dot(nearest - triangle[0]);
  if (gap > margin || gap < -options.max_scan_depth) return;
  clip_in.resize(0);
  for (int i = 0; i < 3; ++i) clip_in.push_back(triangle[i]);
  btPolyhedralContactClipping::clipFaceAgainstHull(normal, hull, T_a, clip_in, clip_out, -1e3,
                                                   margin, found);
}

void Collider::Content::search_static(Body& body, const btTransform& T_body) {
  struct Callback final : btTriangleCallback {
    Content* content = nullptr;
    const btConvexHullShape* hull = nullptr;
    const btTransform* T_body = nullptr;
    double min_top = 0.0;
    void processTriangle(btVector3* triangle, int /*part*/, int /*index*/) override {
      const double top = std::max({triangle[0].z(), triangle[1].z(), triangle[2].z()});
      if (top >= min_top) content->collide(*hull, *T_body, triangle, kStaticMargin);
    }
  };
  found.found.clear();
  found.max_depth = options.max_scan_depth;
  for (const auto& hull : body.hulls) {
    btVector3 low, high;
    hull->getAabb(T_body, low, high);
    Callback callback;
    callback.content = this;
    callback.hull = hull.get();
    callback.T_body = &T_body;
    callback.min_top = body.foot + options.min_obstacle_height;
    const btVector3 gap(kStaticMargin, kStaticMargin, 0.0);
    mesh->processAllTriangles(&callback, low - gap, high + gap);
  }
  body.static_points.clear();
  reduce_contacts(found.found, body.static_points);
}

Collider::Collider(const std::vector<WorldBody>& bodies, const TriangleMesh& static_mesh_base,
                   const WorldOptions& options)
    : content_(std::make_unique<Content>(options)) {
  for (const WorldBody& body : bodies) content_->add(body);
  content_->add(static_mesh_base);
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
  c.found.max_depth = std::numeric_limits<double>::infinity();
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
  if (!content_->mesh) return;
  Content::Body& body = content_->bodies[a];
  const std::array<double, 3> pose{std::round(planar.position.x() / kGrid) * kGrid,
                                   std::round(planar.position.y() / kGrid) * kGrid,
                                   std::round(planar.yaw / kGridAngle) * kGridAngle};
  PlanarState cached;
  cached.position = {pose[0], pose[1]};
  cached.yaw = pose[2];
  if (!body.has_static_points || body.grid_pose != pose) {
    content_->search_static(body, to_bullet(cached));
    body.grid_pose = pose;
    body.has_static_points = true;
  }
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

}  // namespace pcavr::detail
