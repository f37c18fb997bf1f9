// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/perception/scene/palette.hpp"
#include "pcavr/perception/scene/scene.hpp"

namespace pcavr {

/// The colour of each object of a scene, seen or not: that on the page.
[[nodiscard]] inline std::vector<Rgb8> object_colors(const Scene& scene) {
  std::vector<Rgb8> colors;
  std::size_t movable = 0;
  for (const SceneObject& object : scene.objects) {
    colors.push_back(object.is_movable ? object_color(movable++) : kFixedObjectColor);
  }
  return colors;
}

}  // namespace pcavr
