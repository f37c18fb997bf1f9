// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/known_parameters.hpp"

#include "pcavr/physics/contact/material.hpp"

namespace pcavr {
namespace {

constexpr double kMaterialExponent = 1.5;  // [Hertz 1882]

Material material_of(const MaterialEntry& entry) {
  return {entry.youngs_modulus, entry.poisson_ratio};
}

}  // namespace

std::optional<double> hertz_stiffness_of(const Manifest& manifest, const ObjectEntry& object) {
  if (!object.material || !manifest.tool_material || !manifest.tool_radius) return std::nullopt;
  const double radius = *manifest.tool_radius;
  const double tau = object.material->radius ? sphere_on_sphere(radius, *object.material->radius)
                                             : sphere_on_plane(radius);
  return hertz_stiffness(material_of(*manifest.tool_material), material_of(*object.material), tau);
}

Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                          const std::optional<ParameterTable>& given,
                                          const std::string& file) {
  ParameterTable known;
  for (const SceneObjectEntry& object : scene.objects) {
    ObjectParameters& parameters = known[object.name];
    if (given && given->contains(object.name)) parameters = given->at(object.name);
    if (!parameters.mass && object.mass) parameters.mass = ParameterValue{*object.mass};
    if (!parameters.contact_stiffness && object.hertz_stiffness) {
      parameters.contact_stiffness = ParameterValue{*object.hertz_stiffness};
      parameters.contact_exponent = ParameterValue{kMaterialExponent};
      parameters.sources.given.insert(parameters.sources.given.end(),
                                      {"contact.stiffness", "contact.exponent"});
    }
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
