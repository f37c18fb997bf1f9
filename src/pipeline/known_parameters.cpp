// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/known_parameters.hpp"

namespace pcavr {

Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                          const std::optional<ParameterTable>& told,
                                          const std::string& file) {
  ParameterTable known;
  for (const SceneObjectEntry& object : scene.objects) {
    if (!object.is_movable) continue;
    ObjectParameters& parameters = known[object.name];
    if (told && told->contains(object.name)) parameters = told->at(object.name);
    if (!parameters.mass && object.mass) parameters.mass = ParameterValue{*object.mass};
  }
  if (!told) return known;
  for (const auto& [name, parameters] : *told) {
    if (known.contains(name)) continue;
    return Error{.message = "the scene has no movable object '" + name + "'",
                 .file = file,
                 .place = name,
                 .hint = "take it out, or name the scene that these parameters are for"};
  }
  return known;
}

}  // namespace pcavr
