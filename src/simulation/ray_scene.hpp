// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

inline constexpr int kPacket = 8;  ///< rays cast together (SIMD); neighbours are coherent

/// Up to kPacket rays in base. Directions need not be of unit length.
struct RayPacket {
  int count = 0;
  std::array<Eigen::Vector3f, kPacket> origin;
  std::array<Eigen::Vector3f, kPacket> direction;
};

struct RayHit {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  float t = 0.0F;              ///< hit point: origin + t direction
  std::uint32_t body = kNone;  ///< index into World::bodies; kNone where nothing is hit
  std::uint32_t triangle = 0;
  float u = 0.0F;  ///< barycentric weight of the second corner
  float v = 0.0F;  ///< barycentric weight of the third corner
};

/// Bounding volume hierarchies (BVH) of a world's bodies, each in its own frame. They are built
/// before the parallel part, so that their structure, and which triangle a ray through an edge
/// hits, does not depend on the number of threads that render. Const members are thread-safe.
class RayBodies {
 public:
  explicit RayBodies(const World& world);
  ~RayBodies();
  RayBodies(const RayBodies&) = delete;
  RayBodies& operator=(const RayBodies&) = delete;

 private:
  friend class RayScene;
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

/// The bodies at their poses at one instant (instancing). Keeps a reference to `bodies`, which must
/// outlive it.
class RayScene {
 public:
  /// `T_base_body` has a pose for each of the world's bodies.
  RayScene(const RayBodies& bodies, std::span<const Pose> T_base_body);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// The first surface along each ray.
  [[nodiscard]] std::array<RayHit, kPacket> cast(const RayPacket& rays) const;

  /// Occlusion test: true where a surface lies between a ray's origin and origin + direction.
  [[nodiscard]] std::array<bool, kPacket> is_blocked(const RayPacket& rays) const;

 private:
  struct Instances;
  std::unique_ptr<Instances> instances_;
};

}  // namespace pcavr::simulation
