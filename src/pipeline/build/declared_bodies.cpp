// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "declared_bodies.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace pcavr {

std::vector<std::size_t> bodies_with_tags(const std::vector<DeclaredBody>& bodies,
                                          const std::set<MarkerId>& ids) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::vector<TagPlacement>& tags = bodies[i].tags;
    if (std::any_of(tags.begin(), tags.end(),
                    [&](const TagPlacement& tag) { return ids.contains(tag.id); })) {
      found.push_back(i);
    }
  }
  return found;
}

Expected<std::vector<DeclaredBody>> load_movable_bodies(const Recording& recording,
                                                        const CadOptions& options) {
  std::vector<DeclaredBody> bodies;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (!entry.is_movable) continue;
    if (entry.mesh.empty()) {
      return Error{.message = "the movable object has no CAD mesh",
                   .file = (recording.folder / "recording.yaml").string(),
                   .place = "objects: " + entry.name,
                   .hint = "add mesh: with its .obj, .stl, .ply or .glb file"};
    }
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, options, entry.mesh_unit);
    if (!model) return model.error();
    bodies.push_back({entry, std::move(*model), object_placements(recording.manifest, entry.name)});
  }
  return bodies;
}

Expected<std::vector<DeclaredBody>> load_immovable_bodies(const Recording& recording,
                                                          const CadOptions& options) {
  std::vector<DeclaredBody> bodies;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (entry.is_movable || entry.mesh.empty() || !entry.T_base_object) continue;
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, options, entry.mesh_unit);
    if (!model) return model.error();
    bodies.push_back({entry, std::move(*model), {}});
  }
  return bodies;
}

void report_simplified(const CadModel& model, const Observer& observer) {
  if (!model.simplification) return;
  observer.on_warning(fmt::format(
      "{}: CAD mesh of {} triangles simplified to {}, error at most {:.3f} mm; volume and centre "
      "of mass are those of the full mesh",
      model.name, model.simplification->full_triangles, model.mesh_object.triangles.size(),
      1e3 * model.simplification->max_error));
}

std::vector<MarkerEntry> scene_tags(const Manifest& manifest) {
  std::vector<MarkerEntry> tags = manifest.markers;
  std::erase_if(tags, [&](const MarkerEntry& tag) {
    return tag.role == MarkerRole::object &&
           std::any_of(manifest.objects.begin(), manifest.objects.end(),
                       [&](const ObjectEntry& object) {
                         return object.name == tag.object && !object.is_movable;
                       });
  });
  return tags;
}

}  // namespace pcavr
