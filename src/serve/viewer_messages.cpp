// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "viewer_messages.hpp"

#include <algorithm>
#include <array>

#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr {
namespace {

constexpr std::array<float, 4> kBodyColor{0.55F, 0.65F, 0.8F, 1.0F};

}  // namespace

std::vector<cdr::MeshMarker> scene_markers(const ViewerScene& scene,
                                           const std::vector<std::string>& names,
                                           const std::vector<std::string>& frames) {
  std::vector<cdr::MeshMarker> markers;
  if (!scene.scan_base.triangles.empty()) {
    markers.push_back({.name = "scan", .frame = "base", .mesh = &scene.scan_base});
  }
  for (std::size_t i = 0; i < std::min(frames.size(), scene.bodies_object.size()); ++i) {
    markers.push_back({.name = names[i],
                       .frame = frames[i],
                       .mesh = &scene.bodies_object[i],
                       .color = kBodyColor});
  }
  return markers;
}

std::vector<cdr::Parameter> parameter_rows(const ParameterTable& parameters) {
  std::vector<cdr::Parameter> rows;
  for (const auto& [object, known] : parameters) {
    for (const auto& [key, parameter] : list_parameters(known)) {
      rows.push_back({object, key, parameter.value, parameter.std});
    }
  }
  return rows;
}

}  // namespace pcavr
