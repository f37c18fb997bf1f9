// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "evaluated_recording.hpp"

#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {
namespace {

Expected<void> add_mesh(const std::string& name, const std::filesystem::path& file, double unit,
                        EvaluatedRecording& evaluated) {
  Expected<CadModel> model = read_cad_model(file, name, {}, unit);
  if (!model) return model.error();
  evaluated.meshes_object.emplace(name, std::move(model).value().mesh_object);
  return {};
}

Expected<void> read_manifest(const std::filesystem::path& recording,
                             EvaluatedRecording& evaluated) {
  const std::filesystem::path file = recording / "recording.yaml";
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Expected<Manifest> manifest = parse_manifest(*text, file.string());
  if (!manifest) return manifest.error();
  evaluated.camera = manifest->camera;
  for (const ObjectEntry& object : manifest->objects) {
    if (object.mesh.empty()) continue;
    const Expected<void> added =
        add_mesh(object.name, recording / object.mesh, object.mesh_unit, evaluated);
    if (!added) return added;
  }
  return {};
}

}  // namespace

Expected<EvaluatedRecording> read_evaluated_recording(const ComparisonSide& reference,
                                                      const ComparisonSide& subject,
                                                      const Observer& observer) {
  EvaluatedRecording evaluated;
  const std::filesystem::path& recording =
      reference.recording.empty() ? subject.recording : reference.recording;
  if (recording.empty()) {
    observer.on_warning(
        "the recording of these results was not found: completeness includes reference surface "
        "that "
        "no camera pose saw");
  } else {
    const Expected<void> read = read_manifest(recording, evaluated);
    if (!read) return read.error();
  }
  for (const ComparisonSide* side : {&reference, &subject}) {
    for (const auto& [name, file] : side->object_meshes) {
      if (evaluated.meshes_object.contains(name)) continue;
      const Expected<void> added = add_mesh(name, file, 1.0, evaluated);
      if (!added) return added.error();
    }
  }
  return evaluated;
}

}  // namespace pcavr
