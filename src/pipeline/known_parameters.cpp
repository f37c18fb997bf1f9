// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/known_parameters.hpp"

namespace pcavr {

Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                          const std::optional<ParameterTable>& given,
                                          const std::string& file) {
  ParameterTable known;
  for (const SceneObjectEntry& object : scene.objects) {
    ObjectParameters& parameters = known[object.name];
    if (given && given->contains(object.name)) parameters = given->at(object.name);
    if (!parameters.mass && object.mass) parameters.mass = ParameterValue{*object.mass};
  }
  if (!given) return known;
  for (const auto& [name, parameters] : *given) {
    if (known.contains(name)) continue;
    return Error{.message = "the scene has no object '" + name + "'",
                 .file = file,
                 .place = name,
                 .hint = "remove it, or give the scene that these parameters are for"};
  }
  return known;
}

}  // namespace pcavr
