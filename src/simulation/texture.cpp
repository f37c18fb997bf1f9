// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/texture.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr::simulation {
namespace {

struct Cell {
  std::int32_t x, y, z;
};

/// std::floor as an integer, which is a slow library call on baseline x86-64 (no SSE4.1).
std::int32_t floor_of(float value) {
  const auto towards_zero = static_cast<std::int32_t>(value);
  return towards_zero - (value < static_cast<float>(towards_zero) ? 1 : 0);
}

/// Distance from the nearest integer.
float distance_to_integer(float value) {
  return std::abs(value - static_cast<float>(floor_of(value + 0.5F)));
}

Cell cell_of(const Eigen::Vector3f& p) {
  return {floor_of(p.x()), floor_of(p.y()), floor_of(p.z())};
}

/// Hash of a lattice point to 32 bits; the finaliser is MurmurHash3's [Appleby 2011].
std::uint32_t lattice(const Cell& c, std::uint32_t seed) {
  std::uint32_t h = seed + 0x9e3779b9U * static_cast<std::uint32_t>(c.x) +
                    0x7f4a7c15U * static_cast<std::uint32_t>(c.y) +
                    0x94d049bbU * static_cast<std::uint32_t>(c.z);
  h = (h ^ (h >> 16)) * 0x85ebca6bU;
  h = (h ^ (h >> 13)) * 0xc2b2ae35U;
  return h ^ (h >> 16);
}

float unit(std::uint32_t h) { return static_cast<float>(h >> 8) * 0x1.0p-24F; }

/// Value noise [Perlin's lattice noise with values at the lattice points], 0 to 1, mean 0.5.
float value_noise(const Eigen::Vector3f& p, std::uint32_t seed) {
  const Cell c = cell_of(p);
  const auto weight = [](float t) { return t * t * (3.0F - 2.0F * t); };
  const float x = weight(p.x() - static_cast<float>(c.x));
  const float y = weight(p.y() - static_cast<float>(c.y));
  const float z = weight(p.z() - static_cast<float>(c.z));
  const auto edge = [&](std::int32_t dy, std::int32_t dz) {
    const float a = unit(lattice({c.x, c.y + dy, c.z + dz}, seed));
    const float b = unit(lattice({c.x + 1, c.y + dy, c.z + dz}, seed));
    return a + (b - a) * x;
  };
  const auto face = [&](std::int32_t dz) {
    const float a = edge(0, dz);
    return a + (edge(1, dz) - a) * y;
  };
  const float near = face(0);
  return near + (face(1) - near) * z;
}

/// Fades out features that are too small for a pixel of this footprint (antialiasing).
float fade_weight(float feature, float footprint) {
  return std::clamp(feature / footprint - 1.0F, 0.0F, 1.0F);
}

/// Fractal Brownian motion: octaves of value noise about 0, within about +-1; each half as large
/// and about half as strong.
float fractal(const Eigen::Vector3f& p, float scale, int octaves, float footprint,
              std::uint32_t seed) {
  float sum = 0.0F;
  float amplitude = 1.0F;
  for (int i = 0; i < octaves; ++i) {
    const float weight = fade_weight(scale, footprint);
    if (weight <= 0.0F) break;
    sum += amplitude * weight *
           (2.0F * value_noise(p / scale, seed + 7919U * static_cast<std::uint32_t>(i)) - 1.0F);
    amplitude *= 0.55F;
    scale *= 0.5F;
  }
  return sum;
}

Eigen::Vector3f mix(const Material& m, float fraction) {
  const Eigen::Vector3f color = m.base + (m.accent - m.base) * std::clamp(fraction, 0.0F, 1.0F);
  return color;
}

TextureSample wood(const Material& m, const Eigen::Vector3f& p, float footprint) {
  // Boards along x of width `scale`, each from another part of the solid wood texture.
  const std::int32_t board = floor_of(p.y() / m.scale);
  const std::uint32_t tone = lattice({board, 0, 0}, m.seed);
  const Eigen::Vector3f q(p.x() * 0.12F + 10.0F * unit(tone), p.y(), p.z());
  const float warp = fractal(q, 0.06F, 2, footprint, m.seed + tone);
  const float rings = 0.5F + 0.5F * std::sin(6.2832F * (q.y() / 0.024F + 1.6F * warp));
  const float grain = fractal(Eigen::Vector3f(p.x() * 0.06F, p.y(), p.z()), 0.006F, 3, footprint,
                              m.seed + tone + 1U);
  const float ring_weight = fade_weight(0.012F, footprint);
  float fraction =
      0.30F + 0.25F * unit(tone) + 0.35F * ring_weight * (rings * rings - 0.375F) + 0.22F * grain;
  const float to_seam = m.scale * distance_to_integer(p.y() / m.scale);
  if (to_seam < 0.0007F) fraction = 1.0F;
  const auto cell = to_seam < 0.0007F ? 1U : 2U + (static_cast<std::uint32_t>(board) & 0xffU);
  return {mix(m, fraction), cell};
}

TextureSample plaster(const Material& m, const Eigen::Vector3f& p, float footprint) {
  const float stain = fractal(p, m.scale, 6, footprint, m.seed);
  return {mix(m, 0.5F + 0.45F * stain), 0};
}

TextureSample fabric(const Material& m, const Eigen::Vector3f& p, float footprint) {
  const float thread = 0.1F * m.scale;
  const float weight = fade_weight(0.5F * thread, footprint);
  const Eigen::Vector3f q = p * (6.2832F / thread);
  const float weave = std::sin(q.x() + q.z()) * std::sin(q.y() - q.z());
  const float stain = fractal(p, m.scale, 5, footprint, m.seed);
  return {mix(m, 0.45F + 0.25F * weight * weave + 0.4F * stain), 0};
}

TextureSample patches(const Material& m, const Eigen::Vector3f& p, float footprint) {
  const float weight = fade_weight(m.scale, footprint);
  const Eigen::Vector3f q = p / m.scale + Eigen::Vector3f::Constant(0.37F);
  // Rows are shifted against each other, like bricks.
  const float shift = unit(lattice({0, cell_of(q).y, cell_of(q).z}, m.seed + 1U));
  const std::uint32_t h = lattice(cell_of({q.x() + shift, q.y(), q.z()}), m.seed);
  const float stain = fractal(p, 0.5F * m.scale, 4, footprint, m.seed + 2U);
  const float fraction = 0.5F + weight * (unit(h) - 0.5F) + 0.25F * stain;
  return {mix(m, fraction), weight > 0.0F ? 1U + (h & 0xffffU) : 0U};
}

TextureSample terrazzo(const Material& m, const Eigen::Vector3f& p, float footprint) {
  // One sphere of another colour in each cell of the lattice.
  const Eigen::Vector3f q = p / m.scale;
  const Cell c = cell_of(q);
  const std::uint32_t h = lattice(c, m.seed);
  const float radius = 0.12F + 0.22F * unit(lattice(c, m.seed + 1U));
  const auto coordinate = [&](std::uint32_t salt) {
    return radius + (1.0F - 2.0F * radius) * unit(lattice(c, m.seed + salt));
  };
  const Eigen::Vector3f centre(static_cast<float>(c.x) + coordinate(2U),
                               static_cast<float>(c.y) + coordinate(3U),
                               static_cast<float>(c.z) + coordinate(4U));
  const float weight = fade_weight(radius * m.scale, footprint);
  const bool is_in_sphere = weight > 0.0F && (q - centre).squaredNorm() < radius * radius;
  const float stain = 0.2F * fractal(p, m.scale, 4, footprint, m.seed + 5U);
  if (!is_in_sphere) return {mix(m, 0.15F + stain), 0};
  return {mix(m, 0.15F + weight * (0.35F + 0.5F * unit(h)) + stain), 1U + (h & 0xffffU)};
}

TextureSample tiles(const Material& m, const Eigen::Vector3f& p, float footprint) {
  const Eigen::Vector3f q = p / m.scale;
  const Cell c = cell_of(q);
  const float joint = 0.004F / m.scale;
  const float stain = fractal(p, 0.3F * m.scale, 6, footprint, m.seed);
  if (distance_to_integer(q.x()) < joint || distance_to_integer(q.y()) < joint) {
    const float weight = fade_weight(0.008F, footprint);
    return {mix(m, 0.4F + 0.6F * weight), 1U};
  }
  const std::uint32_t h = lattice({c.x, c.y, 0}, m.seed);
  return {mix(m, 0.4F * unit(h) + 0.15F + 0.3F * stain), 2U + (h & 0xffffU)};
}

}  // namespace

TextureSample sample_texture(const Material& material, const Eigen::Vector3f& p_body,
                             float footprint) {
  switch (material.texture) {
    case Texture::wood:
      return wood(material, p_body, footprint);
    case Texture::plaster:
      return plaster(material, p_body, footprint);
    case Texture::fabric:
      return fabric(material, p_body, footprint);
    case Texture::patches:
      return patches(material, p_body, footprint);
    case Texture::terrazzo:
      return terrazzo(material, p_body, footprint);
    case Texture::tiles:
      return tiles(material, p_body, footprint);
    case Texture::plain:
      break;
  }
  return {material.base, 0};
}

}  // namespace pcavr::simulation
