// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulation/ray_scene.hpp"
#include "simulation/world.hpp"

namespace pcavr::simulation {

/// The result of one ray.
struct ShadedSample {
  float depth = 0.0F;  ///< ray parameter of the hit; 0 where nothing is hit
  /// Identifies the visible piece of surface: body, face, cell of print or texture, lit or in
  /// shadow. Two neighbours with the same key see one smooth piece of surface.
  std::uint64_t key = 0;
  Eigen::Vector3f radiance = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal_base = Eigen::Vector3f::Zero();  ///< of the triangle, toward the viewer
};

/// Casts rays and computes their radiance at one instant. Keeps references, which must outlive it.
/// Thread-safe.
class Shader {
 public:
  /// `pixel_angle` is the width of a pixel [rad], which limits the detail of textures.
  Shader(const World& world, const RayScene& scene, std::span<const Pose> T_base_body,
         float pixel_angle);

  /// `light_offsets` moves the shadow-casting light's centre for each ray, within its size [m].
  [[nodiscard]] std::array<ShadedSample, kPacket> shade(
      const RayPacket& rays, const std::array<Eigen::Vector3f, kPacket>& light_offsets) const;

 private:
  struct PlacedBody {
    Eigen::Matrix3f R_body_base;
    Eigen::Vector3f p_body_base;  ///< base's origin in the body
    std::vector<Eigen::Matrix3f> R_marker_body;
    std::vector<Eigen::Vector3f> p_marker_body;
  };
  struct Print {
    bool is_hit = false;
    bool is_white = true;
    std::uint32_t cell = 0;
  };

  [[nodiscard]] Print print_at(std::size_t body, const Eigen::Vector3f& p_body) const;
  [[nodiscard]] Eigen::Vector3f triangle_normal(const RayHit& hit) const;
  [[nodiscard]] std::array<bool, kPacket> shadows(
      const RayPacket& rays, const std::array<RayHit, kPacket>& hits,
      const std::array<Eigen::Vector3f, kPacket>& light_offsets) const;
  [[nodiscard]] Eigen::Vector3f lit(const Eigen::Vector3f& p_base, const Eigen::Vector3f& normal,
                                    const Eigen::Vector3f& to_viewer, const Eigen::Vector3f& albedo,
                                    float gloss, bool is_in_shadow) const;
  [[nodiscard]] ShadedSample shade_hit(const Eigen::Vector3f& origin,
                                       const Eigen::Vector3f& direction, const RayHit& hit,
                                       bool is_in_shadow) const;

  const World& world_;
  const RayScene& scene_;
  float pixel_angle_;
  std::vector<PlacedBody> placed_;
};

}  // namespace pcavr::simulation
