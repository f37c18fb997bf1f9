// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/ray_scene.hpp"

#include <cstring>
#include <limits>
#include <new>

#include <embree3/rtcore.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr::simulation {
namespace {

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using Scene = std::unique_ptr<RTCSceneTy, SceneDeleter>;

Scene build_bvh(RTCDevice device, const TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Eigen::Vector3f), mesh.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh.triangles.size());
  // The sizes are valid, so that out of memory is the only possible cause.
  if (vertices == nullptr || triangles == nullptr) throw std::bad_alloc();
  std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(Eigen::Vector3f));
  std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  rtcCommitGeometry(geometry);
  Scene scene(rtcNewScene(device));
  // Rays occasionally pass between adjacent triangles without this flag.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

alignas(32) constexpr int kLaneMasks[kPacket + 1][kPacket] = {
    {0, 0, 0, 0, 0, 0, 0, 0},         {-1, 0, 0, 0, 0, 0, 0, 0},
    {-1, -1, 0, 0, 0, 0, 0, 0},       {-1, -1, -1, 0, 0, 0, 0, 0},
    {-1, -1, -1, -1, 0, 0, 0, 0},     {-1, -1, -1, -1, -1, 0, 0, 0},
    {-1, -1, -1, -1, -1, -1, 0, 0},   {-1, -1, -1, -1, -1, -1, -1, 0},
    {-1, -1, -1, -1, -1, -1, -1, -1},
};

void fill(RTCRay8& to, const RayPacket& from, float max_distance) {
  for (int i = 0; i < kPacket; ++i) {
    const auto k = static_cast<std::size_t>(i < from.count ? i : 0);
    to.org_x[i] = from.origin[k].x();
    to.org_y[i] = from.origin[k].y();
    to.org_z[i] = from.origin[k].z();
    to.dir_x[i] = from.direction[k].x();
    to.dir_y[i] = from.direction[k].y();
    to.dir_z[i] = from.direction[k].z();
    to.tnear[i] = 0.0F;
    to.tfar[i] = max_distance;
    to.time[i] = 0.0F;
    to.mask[i] = 0xffffffffU;
    to.id[i] = 0;
    to.flags[i] = 0;
  }
}

}  // namespace

struct RayBodies::Trees {
  Device device;
  std::vector<Scene> scenes;  // released before the device
};

RayBodies::RayBodies(const World& world) : trees_(std::make_unique<Trees>()) {
  // "threads=1" is not used: Embree would then limit TBB of the whole process to one thread.
  trees_->device.reset(rtcNewDevice(nullptr));
  if (trees_->device == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) {
    throw std::bad_alloc();
  }
  PCAVR_REQUIRE(trees_->device != nullptr, rtcGetDeviceError(nullptr));
  for (const Body& body : world.bodies) {
    trees_->scenes.push_back(build_bvh(trees_->device.get(), body.surface.mesh));
  }
}

RayBodies::~RayBodies() = default;

struct RayScene::Instances {
  Scene scene;
};

RayScene::RayScene(const RayBodies& bodies, std::span<const Pose> T_base_body)
    : instances_(std::make_unique<Instances>()) {
  const RayBodies::Trees& trees = *bodies.trees_;
  PCAVR_REQUIRE(T_base_body.size() == trees.scenes.size(), T_base_body.size());
  Scene scene(rtcNewScene(trees.device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < trees.scenes.size(); ++i) {
    const RTCGeometry instance = rtcNewGeometry(trees.device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, trees.scenes[i].get());
    const Eigen::Matrix4f matrix = T_base_body[i].matrix().cast<float>();
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(scene.get(), instance, static_cast<unsigned>(i));
    rtcReleaseGeometry(instance);
  }
  rtcCommitScene(scene.get());
  instances_->scene = std::move(scene);
}

RayScene::~RayScene() = default;

std::array<RayHit, kPacket> RayScene::cast(const RayPacket& rays) const {
  alignas(32) RTCRayHit8 query;
  fill(query.ray, rays, std::numeric_limits<float>::infinity());
  for (int i = 0; i < kPacket; ++i) {
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(kLaneMasks[rays.count], instances_->scene.get(), &context, &query);
  std::array<RayHit, kPacket> hits;
  for (int i = 0; i < rays.count; ++i) {
    if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[static_cast<std::size_t>(i)] = {.t = query.ray.tfar[i],
                                         .body = query.hit.instID[0][i],
                                         .triangle = query.hit.primID[i],
                                         .u = query.hit.u[i],
                                         .v = query.hit.v[i]};
  }
  return hits;
}

std::array<bool, kPacket> RayScene::is_blocked(const RayPacket& rays) const {
  alignas(32) RTCRay8 query;
  fill(query, rays, 1.0F);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded8(kLaneMasks[rays.count], instances_->scene.get(), &context, &query);
  std::array<bool, kPacket> blocked{};
  for (int i = 0; i < rays.count; ++i) blocked[static_cast<std::size_t>(i)] = query.tfar[i] < 0.0F;
  return blocked;
}

}  // namespace pcavr::simulation
