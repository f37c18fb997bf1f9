// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "command_arguments.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "settings.hpp"
#include "threads.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

Expected<void> use_sensor(const fs::path& camera_file, PerceptionOptions& options) {
  if (camera_file.empty()) return {};
  const Expected<CameraFile> sensor = read_camera_file(camera_file);
  if (!sensor) return sensor.error();
  if (!sensor->depth_noise) {
    return Error{.message = "the camera file has no depth noise",
                 .file = camera_file.string(),
                 .place = "depth_noise",
                 .hint = "add it, or omit sensor"};
  }
  options.depth_noise = *sensor->depth_noise;
  return {};
}

Expected<SceneManifest> build_into(const OutputArgument& output, const fs::path& recording_folder,
                                   const fs::path& sensor, Settings& settings,
                                   const Observer& observer) {
  BuildOptions& options = settings.build;
  // First, so that an output that can't be written fails before the long work.
  Expected<OutputFolder> folder = output.create(OutputKind::scene, {recording_folder, sensor});
  if (!folder) return folder.error();
  auto configuration = settings.changed();
  if (auto used = use_sensor(sensor, options.perception); !used) return used.error();
  const Expected<Recording> recording =
      read_with_warnings(recording_folder, options.skip_bad, settings, observer);
  if (!recording) return recording.error();
  Expected<Scene> scene = build_scene(*recording, options, observer);
  if (!scene) return scene.error();
  scene->configuration = std::move(configuration);
  if (auto done = write_scene(*scene, folder->path(), options.parallelism); !done) {
    return done.error();
  }
  if (auto done = folder->commit(); !done) return done.error();
  return read_scene_manifest(output.folder);
}

SceneManifest build(const py::object& recording, const py::object& output,
                    std::optional<double> voxel, const py::object& sensor, bool trust_poses,
                    bool skip_bad, bool replace, int threads, const py::object& options,
                    const py::object& progress) {
  Settings settings;
  settings.set(options);
  if (voxel) {
    py::dict voxel_option;
    voxel_option["reconstruction.fusion.voxel_size"] = *voxel;
    settings.set(voxel_option);
  }
  settings.build.trust_poses = trust_poses;
  settings.build.skip_bad = skip_bad;
  settings.build.parallelism = parallelism_of(threads);
  const OutputArgument target{path_of(output, "output"), replace};
  const fs::path folder = path_of(recording, "recording");
  const fs::path sensor_file = optional_path(sensor, "sensor");
  return run_interruptible(progress, [&](const Observer& observer) {
    return build_into(target, folder, sensor_file, settings, observer);
  });
}

constexpr char kBuildDoc[] = R"(Builds a scene from a recording, as `pcavr build`: the same bytes.

recording    folder with a recording.yaml
output       folder for the scene; a new one, or with `replace` a scene
voxel        edge of a voxel of the mesh [m]
sensor       camera file with the sensor's depth noise
trust_poses  takes groundtruth.txt as exact
skip_bad     skips bad rows and frames instead of raising
threads      0: all cores
options      a dict from "section.key" to number, as `pcavr --print-config` lists them
progress     called with stage, done and total (0: unknown); what it raises ends the call

Returns the Scene. Releases the GIL; Ctrl-C ends it at the next progress, and nothing is left behind.
Doubtful inputs are warnings of category DataWarning. Raises Error with file, line and place.)";

void bind_scene(py::module_& module) {
  py::class_<SceneObjectEntry>(module, "SceneObject", "An object of a scene.")
      .def_readonly("name", &SceneObjectEntry::name, "As in the recording.")
      .def_readonly("mesh", &SceneObjectEntry::mesh, "Relative to the scene's folder.")
      .def_property_readonly(
          "pose", [](const SceneObjectEntry& self) { return array_of(self.T_base_object); },
          "(7,) x y z [m] qx qy qz qw in base.")
      .def_property_readonly(
          "start_pose",
          [](const SceneObjectEntry& self) { return array_of(self.T_base_object_start); },
          "(7,) in base at the recording's start.")
      .def_readonly("position_std", &SceneObjectEntry::position_std, "[m]")
      .def_readonly("rotation_std", &SceneObjectEntry::rotation_std, "[rad]")
      .def_readonly("evidence", &SceneObjectEntry::evidence, "What placed it.")
      .def_readonly("mass", &SceneObjectEntry::mass, "[kg]; None: not weighed.")
      .def_readonly("is_movable", &SceneObjectEntry::is_movable, "False: it keeps its pose.");
  py::class_<SceneManifest>(module, "Scene", "A scene folder, as its scene.yaml describes it.")
      .def_readonly("folder", &SceneManifest::folder, "As it was given.")
      .def_readonly("recording", &SceneManifest::recording, "As it was given to build.")
      .def_readonly("voxel_size", &SceneManifest::voxel_size, "[m]")
      .def_readonly("objects", &SceneManifest::objects, "A list of SceneObject.")
      .def_property_readonly(
          "not_found",
          [](const SceneManifest& self) {
            std::vector<std::string> lines;
            for (const NotFoundObject& object : self.not_found) lines.push_back(object.to_string());
            return lines;
          },
          "A line for each object that no frame showed.")
      .def_property_readonly("is_scanned", &SceneManifest::is_scanned,
                             "False: it is from a recording without images.");
  module.def(
      "read_scene",
      [](const py::object& folder) {
        return value_of(read_scene_manifest(path_of(folder, "folder")));
      },
      py::arg("folder"), "Reads the Scene in a folder; raises Error with file and line.");
}

}  // namespace

void bind_build(py::module_& module) {
  bind_scene(module);
  module.def("build", &build, py::arg("recording"), py::arg("output"), py::kw_only(),
             py::arg("voxel") = py::none(), py::arg("sensor") = py::none(),
             py::arg("trust_poses") = false, py::arg("skip_bad") = false,
             py::arg("replace") = false, py::arg("threads") = 0, py::arg("options") = py::none(),
             py::arg("progress") = py::none(), kBuildDoc);
}

}  // namespace pcavr::python
