// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/perception/texture/options.cpp for meanings, ranges and defaults.
struct TextureOptions {
  TextureOptions();

  bool enabled;
  int max_views;
  int max_view_memory;      ///< [MiB]
  double view_translation;  ///< [m]
  double view_rotation;     ///< [rad]
  double view_interval;     ///< [s]
  int atlas_width;          ///< [px]
  int atlas_height;         ///< [px]
  int bodies_edge;          ///< [px]
  double texels_per_pixel;
  double best_view_exponent;
  double mask_distance;  ///< [px]
  double color_outlier;  ///< of 255
  bool register_color;
  bool fill_support;
  int jpeg_quality;
};

/// The options "texture".
[[nodiscard]] OptionSection section_of(TextureOptions& options);

}  // namespace pcavr
