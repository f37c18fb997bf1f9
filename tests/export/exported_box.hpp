// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/results/export/export_world.hpp"

#include "scene/scene_builder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {

/// [kg] Mass of the box of a_box_on_a_table().
inline constexpr double kBoxMass = 1.5;

/// Possible findings of identification for a box: a linear contact of 20 kN/m, 0.3 of friction.
inline ObjectParameters identified_box(double exponent = 1.0) {
  ObjectParameters known;
  known.mass = ParameterValue{kBoxMass, 0.01};
  known.sliding_friction_coefficient = ParameterValue{0.3, 0.004};
  known.limiting_static_friction = ParameterValue{5.0, 0.05};
  known.viscous_friction = ParameterValue{5.0, 1.0};
  known.friction_radius = ParameterValue{0.031, 0.002};
  known.tool_friction_coefficient = ParameterValue{0.2, 0.02};
  known.contact_stiffness = ParameterValue{exponent == 1.0 ? 2e4 : 4e5, 100.0};
  known.contact_exponent = ParameterValue{exponent};
  known.contact_damping = ParameterValue{exponent == 1.0 ? 50.0 : 8e5};
  return known;
}

/// The scene of a_box_on_a_table() on the disk, and what export makes of it.
class ExportedBox {
 public:
  explicit ExportedBox(const std::string& name = "box")
      : ExportedBox(named_box(a_box_on_a_table(), name)) {}

  explicit ExportedBox(const Scene& scene) {
    folder_ = temporary_.path() / "scene";
    std::filesystem::create_directories(folder_);
    const Expected<void> written = write_scene(scene, folder_, {1});
    PCAVR_REQUIRE(written.has_value());
    manifest_ = *read_scene_manifest(folder_);
  }
  [[nodiscard]] Expected<ExportedWorld> world(const ParameterTable& table,
                                              ExportOptions options = {}) const {
    options.tool_radius = 0.005;
    return make_exported_world(manifest_, table, options);
  }
  [[nodiscard]] std::filesystem::path target() const {
    std::filesystem::create_directories(temporary_.path() / "world");
    return temporary_.path() / "world";
  }
  [[nodiscard]] const SceneManifest& manifest() const { return manifest_; }

  /// The scene with another name of its box.
  static Scene named_box(Scene scene, const std::string& name) {
    scene.objects.front().model.name = name;
    for (SupportPlane& plane : scene.support_planes) plane.objects = {name};
    return scene;
  }

 private:
  TemporaryFolder temporary_;
  std::filesystem::path folder_;
  SceneManifest manifest_;
};

}  // namespace pcavr
