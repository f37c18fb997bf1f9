// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace pcavr::simulation {

enum class Texture { plain, wood, plaster, fabric, patches, terrazzo, tiles };

/// A solid texture: its colour is a function of the point in the body's frame, so that it needs no
/// UV parametrisation and is fixed to the body.
struct Material {
  Texture texture = Texture::plain;
  Eigen::Vector3f base = Eigen::Vector3f::Constant(0.5F);    ///< albedo, linear RGB, 0 to 1
  Eigen::Vector3f accent = Eigen::Vector3f::Constant(0.5F);  ///< second colour of the texture
  float scale = 0.05F;                                       ///< size of its largest features [m]
  float gloss = 0.0F;                                        ///< strength of the highlight, 0 to 1
  std::uint32_t seed = 0;
};

struct TextureSample {
  Eigen::Vector3f albedo;
  std::uint32_t cell = 0;  ///< differs where the colour jumps, so that such edges are supersampled
};

/// `footprint` is the size of the pixel on the surface [m]: features below twice that are faded to
/// their mean (Nyquist), so that one sample per pixel does not alias.
[[nodiscard]] TextureSample sample_texture(const Material& material, const Eigen::Vector3f& p_body,
                                           float footprint);

}  // namespace pcavr::simulation
