// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/shader.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/hashed_noise.hpp"

namespace pcavr::simulation {
namespace {

constexpr float kPaperThickness = 1e-4F;  ///< a point closer to a tag's plane is on the tag [m]
constexpr float kWhitePaper = 0.88F;      ///< albedo of office paper, and of toner on it
constexpr float kBlackToner = 0.05F;
/// Shadow rays start this far above the surface, against self-shadowing by rounding [m].
constexpr float kShadowBias = 2e-4F;

}  // namespace

Shader::Shader(const World& world, const RayScene& scene, std::span<const Pose> T_base_body,
               float pixel_angle)
    : world_(world), scene_(scene), pixel_angle_(pixel_angle) {
  for (std::size_t i = 0; i < T_base_body.size(); ++i) {
    const Pose T_body_base = T_base_body[i].inverse();
    PlacedBody placed{.R_body_base = T_body_base.rotation_matrix().cast<float>(),
                      .p_body_base = T_body_base.translation().cast<float>(),
                      .R_marker_body = {},
                      .p_marker_body = {}};
    for (const Decal& decal : world.bodies[i].decals) {
      const Pose T_marker_body = decal.T_body_marker.inverse();
      placed.R_marker_body.push_back(T_marker_body.rotation_matrix().cast<float>());
      placed.p_marker_body.push_back(T_marker_body.translation().cast<float>());
    }
    placed_.push_back(std::move(placed));
  }
}

Shader::Print Shader::print_at(std::size_t body, const Eigen::Vector3f& p_body) const {
  const std::vector<Decal>& decals = world_.bodies[body].decals;
  for (std::size_t i = 0; i < decals.size(); ++i) {
    const Decal& decal = decals[i];
    const Eigen::Vector3f p =
        placed_[body].R_marker_body[i] * p_body + placed_[body].p_marker_body[i];
    if (std::abs(p.z()) > kPaperThickness) continue;
    const int inner = decal.picture.cells - 2 * decal.picture.border;
    const float cell = static_cast<float>(decal.size) / static_cast<float>(inner);
    // The paper is one cell wider than the picture on each side: the quiet zone.
    const float half = 0.5F * cell * static_cast<float>(decal.picture.cells);
    if (std::max(std::abs(p.x()), std::abs(p.y())) > half + cell) continue;
    const int column = static_cast<int>(std::floor((p.x() + half) / cell));
    const int row = static_cast<int>(std::floor((half - p.y()) / cell));
    const int cells = decal.picture.cells;
    const bool is_outside = column < 0 || row < 0 || column >= cells || row >= cells;
    const bool is_white =
        is_outside || decal.picture.is_white[static_cast<std::size_t>(row * cells + column)];
    return {.is_hit = true,
            .is_white = is_white,
            .cell = static_cast<std::uint32_t>(2 * i + (is_white ? 2 : 3))};
  }
  return {};
}

Eigen::Vector3f Shader::triangle_normal(const RayHit& hit) const {
  return placed_[hit.body].R_body_base.transpose() *
         world_.bodies[hit.body].surface.normal[hit.triangle];
}

std::array<bool, kPacket> Shader::shadows(
    const RayPacket& rays, const std::array<RayHit, kPacket>& hits,
    const std::array<Eigen::Vector3f, kPacket>& light_offsets) const {
  const auto light = std::find_if(world_.lights.begin(), world_.lights.end(),
                                  [](const Light& candidate) { return candidate.casts_shadow; });
  if (light == world_.lights.end()) return {};
  RayPacket to_light;
  to_light.count = rays.count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays.count); ++i) {
    to_light.origin[i] = rays.origin[i];
    if (hits[i].body != RayHit::kNone) {
      to_light.origin[i] += hits[i].t * rays.direction[i] + kShadowBias * triangle_normal(hits[i]);
    }
    to_light.direction[i] = light->p_base + light_offsets[i] - to_light.origin[i];
  }
  return scene_.is_blocked(to_light);
}

Eigen::Vector3f Shader::lit(const Eigen::Vector3f& p_base, const Eigen::Vector3f& normal,
                            const Eigen::Vector3f& to_viewer, const Eigen::Vector3f& albedo,
                            float gloss, bool is_in_shadow) const {
  Eigen::Vector3f sum = world_.ambient.cwiseProduct(albedo);
  for (const Light& light : world_.lights) {
    if (light.casts_shadow && is_in_shadow) continue;
    const Eigen::Vector3f to_light = light.p_base - p_base;
    const float distance = to_light.norm();
    const float facing = normal.dot(to_light) / distance;
    if (facing <= 0.0F) continue;
    // Weaker attenuation than a point light's.
    const float strength = light.reach / (0.3F * light.reach + 0.7F * distance);
    // Lambertian diffuse reflection, and a Blinn-Phong highlight.
    Eigen::Vector3f reflected = facing * albedo;
    if (gloss > 0.0F) {
      const Eigen::Vector3f half = (to_light / distance + to_viewer).normalized();
      reflected.array() += gloss * std::pow(std::max(0.0F, normal.dot(half)), 40.0F);
    }
    sum += strength * light.color.cwiseProduct(reflected);
  }
  return sum;
}

ShadedSample Shader::shade_hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                               const RayHit& hit, bool is_in_shadow) const {
  const Body& body = world_.bodies[hit.body];
  const PlacedBody& placed = placed_[hit.body];
  const Eigen::Vector3f p_base = origin + hit.t * direction;
  const Eigen::Vector3f p_body = placed.R_body_base * p_base + placed.p_body_base;
  const Eigen::Vector3f to_viewer = -direction.normalized();
  Eigen::Vector3f flat = triangle_normal(hit);
  if (flat.dot(to_viewer) < 0.0F) flat = -flat;
  const auto& corners = body.surface.corner_normals[hit.triangle];
  const Eigen::Vector3f round =
      placed.R_body_base.transpose() *
      ((1.0F - hit.u - hit.v) * corners[0] + hit.u * corners[1] + hit.v * corners[2]).normalized();
  const Material& material = body.materials[body.surface.material[hit.triangle]];
  const Print print = print_at(hit.body, p_body);
  TextureSample texture;
  if (print.is_hit) {
    texture.albedo.setConstant(print.is_white ? kWhitePaper : kBlackToner);
  } else {
    // A slanted footprint is longer in one direction; the geometric mean of both blurs less than
    // the longer one.
    const float footprint = hit.t * pixel_angle_ / std::sqrt(std::max(0.05F, flat.dot(to_viewer)));
    texture = sample_texture(material, p_body, footprint);
  }
  ShadedSample sample;
  sample.depth = hit.t;
  sample.normal_base = flat;
  sample.radiance = lit(p_base, round, to_viewer, texture.albedo,
                        print.is_hit ? 0.0F : material.gloss, is_in_shadow);
  sample.key =
      hash((static_cast<std::uint64_t>(hit.body) << 32) | body.surface.facet[hit.triangle],
           (static_cast<std::uint64_t>(print.cell) << 32) | texture.cell, is_in_shadow ? 1 : 2);
  return sample;
}

std::array<ShadedSample, kPacket> Shader::shade(
    const RayPacket& rays, const std::array<Eigen::Vector3f, kPacket>& light_offsets) const {
  const std::array<RayHit, kPacket> hits = scene_.cast(rays);
  const std::array<bool, kPacket> in_shadow = shadows(rays, hits, light_offsets);
  std::array<ShadedSample, kPacket> samples;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays.count); ++i) {
    if (hits[i].body == RayHit::kNone) {
      samples[i].radiance = world_.ambient;
      continue;
    }
    samples[i] = shade_hit(rays.origin[i], rays.direction[i], hits[i], in_shadow[i]);
  }
  return samples;
}

}  // namespace pcavr::simulation
