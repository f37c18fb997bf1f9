// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "comparison_side.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

bool entry_exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// A folder's entries, sorted by name; empty where there is no such folder.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    entries.push_back(entry->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// Fills `trajectory` if the file exists.
Expected<void> read_if_present(const fs::path& file, Trajectory& trajectory) {
  if (!entry_exists(file)) return {};
  Expected<Trajectory> read = read_trajectory(file);
  if (!read) return read.error();
  trajectory = std::move(read).value();
  return {};
}

/// Adds the object's trajectory if the file exists and has a pose: an object that was never seen
/// has none.
Expected<void> add_object(const std::string& name, const fs::path& file,
                          std::map<std::string, Trajectory>& objects) {
  Trajectory trajectory;
  const Expected<void> done = read_if_present(file, trajectory);
  if (done && !trajectory.empty()) objects.emplace(name, std::move(trajectory));
  return done;
}

/// Fills the side's static surface if the file exists.
Expected<void> read_surface(const fs::path& file, ComparisonSide& side) {
  if (!entry_exists(file)) return {};
  Expected<TriangleMesh> mesh = read_mesh(file);
  if (!mesh) return mesh.error();
  if (mesh->triangles.empty()) {
    return Error{.message = "has no triangles", .file = file.string(), .hint = "create it again"};
  }
  side.surface_base = std::move(mesh).value();
  return {};
}

/// A recording by its path in a scene or run: relative to the working directory, or to its folder.
fs::path find_recording(const fs::path& named, const fs::path& folder) {
  for (const fs::path& candidate : {named, folder / named}) {
    if (!named.empty() && entry_exists(candidate / "recording.yaml")) return candidate;
  }
  return {};
}

Expected<ComparisonSide> read_truth(ComparisonSide side) {
  // The dot gives "truth/" and "truth" the same parent folder.
  const fs::path recording =
      fs::absolute(side.folder / ".").lexically_normal().parent_path().parent_path();
  if (entry_exists(recording / "recording.yaml")) side.recording = recording;
  Expected<void> done = read_if_present(side.folder / "camera.txt", side.camera);
  if (!done) return done.error();
  for (const fs::path& file : entries_of(side.folder / "objects")) {
    if (file.extension() != ".txt") continue;
    done = add_object(file.stem().string(), file, side.tracked);
    if (!done) return done.error();
  }
  done = read_surface(side.folder / "scene.ply", side);
  if (!done) return done.error();
  return side;
}

Expected<ComparisonSide> read_scene(ComparisonSide side) {
  const Expected<SceneManifest> manifest = read_scene_manifest(side.folder);
  if (!manifest) return manifest.error();
  side.recording = find_recording(manifest->recording, side.folder);
  for (const SceneObjectEntry& object : manifest->objects) {
    Placement& placed = side.placed[object.name];
    placed.T_base_object_start = object.T_base_object_start;
    const bool is_end_known = object.evidence != kByManifest || !object.is_movable;
    if (is_end_known) placed.T_base_object_end = object.T_base_object;
    side.object_meshes[object.name] = side.folder / object.mesh;
  }
  if (entry_exists(side.folder / "camera_trajectory.txt")) {
    Expected<Trajectory> camera = read_camera_trajectory(*manifest);
    if (!camera) return camera.error();
    side.camera = std::move(camera).value();
  }
  if (!manifest->is_scanned()) return side;
  const Expected<void> done = read_surface(side.folder / "mesh.ply", side);
  if (!done) return done.error();
  return side;
}

/// The recording that a run.yaml names.
Expected<fs::path> recording_of_run(const fs::path& file, const fs::path& folder) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  try {
    const YAML::Node recording = YAML::Load(*text)["recording"];
    return recording ? find_recording(recording.as<std::string>(), folder) : fs::path();
  } catch (const YAML::Exception& error) {
    return Error{.message = error.msg,
                 .file = file.string(),
                 .line = error.mark.line + 1,
                 .hint = "replay the recording again"};
  }
}

Expected<ComparisonSide> read_run(ComparisonSide side) {
  Expected<fs::path> recording = recording_of_run(side.folder / "run.yaml", side.folder);
  if (!recording) return recording.error();
  side.recording = std::move(recording).value();
  Expected<void> done = read_if_present(side.folder / "camera_trajectory.txt", side.camera);
  if (!done) return done.error();
  for (const fs::path& object : entries_of(side.folder / "objects")) {
    const std::string name = object.filename().string();
    done = add_object(name, object / "tracked.txt", side.tracked);
    if (!done) return done.error();
    done = add_object(name, object / "predicted.txt", side.predicted);
    if (!done) return done.error();
  }
  return side;
}

}  // namespace

std::string name_of(SideKind kind) {
  switch (kind) {
    case SideKind::scene:
      return "scene";
    case SideKind::run:
      return "run";
    case SideKind::tracking:
      return "tracking";
    case SideKind::parameters:
      return "parameter file";
    case SideKind::truth:
      break;
  }
  return "truth";
}

Expected<ComparisonSide> read_side(const fs::path& folder) {
  ComparisonSide side;
  side.folder = folder;
  if (entry_exists(folder / "scene.yaml")) {
    side.kind = SideKind::scene;
    return read_scene(std::move(side));
  }
  if (entry_exists(folder / "run.yaml")) {
    side.kind = SideKind::run;
    return read_run(std::move(side));
  }
  for (const char* file : {"camera.txt", "scene.ply", "objects"}) {
    if (entry_exists(folder / file)) return read_truth(std::move(side));
  }
  if (!entry_exists(folder)) {
    return Error{.message = "does not exist",
                 .file = folder.string(),
                 .hint = "give a scene, a run, or the truth folder of a recording"};
  }
  return Error{.message =
                   "is no scene, run or truth folder: it has no scene.yaml, run.yaml, camera.txt, "
                   "objects or scene.ply",
               .file = folder.string(),
               .hint = "give a scene, a run, or the truth folder of a recording"};
}

Expected<ComparisonSide> extract_tracking(ComparisonSide& run) {
  ComparisonSide tracking;
  tracking.kind = SideKind::tracking;
  tracking.folder = run.folder;
  tracking.recording = run.recording;
  tracking.tracked.swap(run.tracked);
  run.camera = {};
  const bool has_both =
      std::any_of(run.predicted.begin(), run.predicted.end(),
                  [&](const auto& object) { return tracking.tracked.contains(object.first); });
  if (!has_both) {
    return Error{.message = "has no object that is both predicted and tracked",
                 .file = run.folder.string(),
                 .hint = "give a reference: --truth, or --reference"};
  }
  return tracking;
}

}  // namespace pcavr
