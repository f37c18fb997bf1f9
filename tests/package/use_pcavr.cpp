// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <pcavr/pipeline/build_scene.hpp>

int main() {
  pcavr::Recording nothing;
  nothing.folder = "nowhere";
  const auto scene = pcavr::build_scene(nothing, {});
  std::puts(scene ? "a scene from nothing?" : scene.error().to_string().c_str());
  return scene ? 1 : 0;
}
