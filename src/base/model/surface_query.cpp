// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <new>
#include <system_error>
#include <type_traits>
#include <vector>

#include <embree3/rtcore.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/base/model/triangle.hpp"

namespace pcavr {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// Embree prunes in single precision, with an error of a few units in the last place: a radius
/// larger by this factor keeps all equally near triangles.
constexpr float kRadiusFactor = 1.0F + 1e-6F;

/// Keeps triangles that are equally near but for rounding.
constexpr double kBoxFactor = 1.0 + 1e-9;

/// Squared distance from a triangle's bounding box, which is never more than from the triangle, and
/// quicker to compute.
double squared_distance_from_box(const model::Triangle& corners, const Eigen::Vector3d& point) {
  const Eigen::Array3d low = corners.a.cwiseMin(corners.b).cwiseMin(corners.c);
  const Eigen::Array3d high = corners.a.cwiseMax(corners.b).cwiseMax(corners.c);
  return (low - point.array()).max(point.array() - high).max(0.0).matrix().squaredNorm();
}

void require_valid(const TriangleMesh& mesh) {
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    PCAVR_REQUIRE(vertex.allFinite(), vertex.x(), vertex.y(), vertex.z());
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      PCAVR_REQUIRE(index < mesh.vertices.size(), index, mesh.vertices.size());
    }
  }
}

Eigen::Vector3f unit_normal(const model::Triangle& triangle) {
  const Eigen::Vector3d doubled_area = triangle.doubled_area_normal();
  const double norm = doubled_area.norm();
  if (!(norm > 0.0)) return Eigen::Vector3f::Zero();
  return (doubled_area / norm).cast<float>();
}

}  // namespace

/// Embree's bounding volume hierarchy (BVH) with the mesh data.
struct SurfaceQuery::Tree {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Eigen::Vector3f> normals;  ///< per triangle
  Eigen::AlignedBox3f bounds;
  Device device;
  Scene scene;

  explicit Tree(const TriangleMesh& mesh);
  [[nodiscard]] model::Triangle corners(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {vertices[a].cast<double>(), vertices[b].cast<double>(), vertices[c].cast<double>()};
  }
};

SurfaceQuery::Tree::Tree(const TriangleMesh& mesh)
    : vertices(mesh.vertices), triangles(mesh.triangles), bounds(pcavr::bounds(mesh.vertices)) {
  normals.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) normals.push_back(unit_normal(corners(i)));
  // Embree loads vertices 16 bytes at a time: one more keeps the last load inside the buffer.
  vertices.emplace_back(Eigen::Vector3f::Zero());

  device.reset(rtcNewDevice(nullptr));
  if (device == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) {
    throw std::bad_alloc();
  }
  PCAVR_REQUIRE(device != nullptr, rtcGetDeviceError(nullptr));
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             vertices.data(), 0, sizeof(Eigen::Vector3f), mesh.vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(),
                             0, sizeof(triangles[0]), triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  const RTCError error = rtcGetDeviceError(device.get());
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  // The mesh is valid: the remaining cause is that Embree's scheduler could not start a thread.
  if (error == RTC_ERROR_UNKNOWN) {
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
  }
  PCAVR_REQUIRE(error == RTC_ERROR_NONE, static_cast<int>(error), triangles.size());
}

SurfaceQuery::SurfaceQuery(const TriangleMesh& mesh) {
  require_valid(mesh);
  tree_ = std::make_unique<Tree>(mesh);
}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

const Eigen::AlignedBox3f& SurfaceQuery::bounds() const { return tree_->bounds; }

std::optional<SurfaceQuery::Closest> SurfaceQuery::closest(const Eigen::Vector3f& point,
                                                           float radius) const {
  PCAVR_REQUIRE(radius >= 0.0F, radius);
  if (tree_->triangles.empty() || !point.allFinite()) return std::nullopt;

  struct Search {
    const Tree* tree;
    Eigen::Vector3d point;
    double squared_distance;
    bool found = false;
    std::uint32_t triangle = 0;
    Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  };
  Search search{tree_.get(), point.cast<double>(), static_cast<double>(radius) * radius};

  // Ties are broken by the lower index, so that the result does not depend on the traversal order.
  const RTCPointQueryFunction visit = [](RTCPointQueryFunctionArguments* arguments) {
    auto& best = *static_cast<Search*>(arguments->userPtr);
    const std::uint32_t triangle = arguments->primID;
    const model::Triangle corners = best.tree->corners(triangle);
    if (squared_distance_from_box(corners, best.point) > kBoxFactor * best.squared_distance)
      return false;
    const Eigen::Vector3d nearest = model::closest_point(corners, best.point);
    const double squared_distance = (nearest - best.point).squaredNorm();
    if (squared_distance > best.squared_distance) return false;
    if (best.found && squared_distance == best.squared_distance && triangle > best.triangle) {
      return false;
    }
    best.found = true;
    best.squared_distance = squared_distance;
    best.triangle = triangle;
    best.nearest = nearest;
    arguments->query->radius = static_cast<float>(std::sqrt(squared_distance)) * kRadiusFactor;
    return true;
  };

  RTCPointQuery query{};
  query.x = point.x();
  query.y = point.y();
  query.z = point.z();
  query.radius = radius * kRadiusFactor;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(tree_->scene.get(), &query, &context, visit, &search);
  if (!search.found) return std::nullopt;
  return Closest{search.nearest.cast<float>(), tree_->normals[search.triangle],
                 static_cast<float>(std::sqrt(search.squared_distance)), search.triangle};
}

std::optional<SurfaceQuery::Hit> SurfaceQuery::cast(const Eigen::Vector3f& origin,
                                                    const Eigen::Vector3f& direction) const {
  const float length = direction.norm();
  if (!(length > 0.0F) || !std::isfinite(length) || !origin.allFinite()) return std::nullopt;
  const Eigen::Vector3f unit = direction / length;
  RTCRayHit query{};
  query.ray.org_x = origin.x();
  query.ray.org_y = origin.y();
  query.ray.org_z = origin.z();
  query.ray.dir_x = unit.x();
  query.ray.dir_y = unit.y();
  query.ray.dir_z = unit.z();
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = 0xFFFFFFFFU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(tree_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{query.ray.tfar, tree_->normals[query.hit.primID], query.hit.primID, query.hit.u,
             query.hit.v};
}

}  // namespace pcavr
