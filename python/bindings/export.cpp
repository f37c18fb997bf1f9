// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/known_parameters.hpp"
#include "pcavr/pipeline/lerobot_dataset.hpp"
#include "pcavr/results/export/export_world.hpp"
#include "pcavr/results/export/plain_scene.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "command_arguments.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "settings.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

struct ExportFormat {
  const char* name;
  Expected<void> (*write)(ExportedWorld& world, const fs::path& folder);
};
constexpr std::array kFormats{ExportFormat{"mjcf", &write_mjcf}, ExportFormat{"urdf", &write_urdf},
                              ExportFormat{"sdf", &write_sdf}, ExportFormat{"usd", &write_usd},
                              ExportFormat{"moveit", &write_moveit}};

const ExportFormat& format_of(const std::string& name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const ExportFormat& each) { return each.name == name; });
  if (found == kFormats.end()) {
    raise_error({.message = "'" + name + "' is not a format",
                 .place = "format",
                 .hint = "give mjcf, urdf, sdf, usd, moveit, gltf, ply, obj, stl, pcd or 3dtiles"});
  }
  return *found;
}

struct ExportInputs {
  fs::path scene, motion;
  ParametersArgument parameters;
};

/// The motion of a recording's tool, with where it starts and its tip's radius.
Expected<Trajectory> use_motion(const fs::path& recording_folder, ExportOptions& options) {
  if (recording_folder.empty()) return Trajectory();
  const Expected<Recording> recording = read_recording(recording_folder);
  if (!recording) return recording.error();
  if (recording->tool.empty()) {
    return Error{.message = "the recording has no tool motion",
                 .file = recording_folder.string(),
                 .hint = "give one with a tool.csv, or omit motion"};
  }
  options.T_base_tool = recording->tool.poses().front().pose;
  if (!options.tool_radius) options.tool_radius = recording->manifest.tool_radius;
  return recording->tool;
}

Expected<std::vector<std::string>> export_into(const OutputArgument& output,
                                               const ExportFormat& format,
                                               const ExportInputs& inputs, ExportOptions options) {
  Expected<OutputFolder> folder =
      output.create(std::nullopt, {inputs.scene, inputs.parameters.file, inputs.motion});
  if (!folder) return folder.error();
  const Expected<SceneManifest> scene = read_scene_manifest(inputs.scene);
  if (!scene) return scene.error();
  const Expected<ParameterTable> table =
      known_parameters(*scene, inputs.parameters.table, inputs.parameters.file.string());
  if (!table) return table.error();
  const Expected<Trajectory> motion = use_motion(inputs.motion, options);
  if (!motion) return motion.error();
  Expected<ExportedWorld> world = make_exported_world(*scene, *table, options);
  if (!world) return world.error();
  Expected<void> done = format.write(*world, folder->path());
  if (done && !motion->empty()) done = write_motion(*motion, folder->path());
  const bool has_runners = !motion->empty() && format.write == &write_mjcf;
  if (done && has_runners) done = write_mujoco_runners(folder->path());
  if (done) done = write_export_manifest(*world, *table, format.name, folder->path());
  if (done) done = folder->commit();
  if (!done) return done.error();
  return world->warnings;
}

Expected<std::vector<std::string>> export_plain(const OutputArgument& output, PlainFormat format,
                                                const fs::path& scene_folder) {
  Expected<OutputFolder> folder = output.create(std::nullopt, {scene_folder});
  if (!folder) return folder.error();
  const Expected<SceneManifest> scene = read_scene_manifest(scene_folder);
  if (!scene) return scene.error();
  const Expected<PlainScene> written = write_plain_scene(*scene, format, folder->path());
  if (!written) return written.error();
  if (const auto done = folder->commit(); !done) return done.error();
  return std::vector<std::string>();
}

/// What has no effect on a format is refused, as by the command.
void check_effects(const ExportInputs& inputs, const ExportOptions& options,
                   const std::string& format) {
  const bool is_plain = plain_format_of(format).has_value();
  const bool has_friction =
      inputs.parameters.table || !inputs.parameters.file.empty() || options.assumes;
  const bool has_motion = !inputs.motion.empty() || options.speed || options.tool_radius;
  if ((is_plain && has_friction) || ((is_plain || format == "moveit") && has_motion)) {
    raise_error({.message = "'" + format + "' has neither friction nor motion",
                 .place = "format",
                 .hint = "leave out motion, speed and tool_radius; of geometry alone also "
                         "parameters and assume"});
  }
}

std::vector<std::string> export_scene(const py::object& scene, const py::object& output,
                                      const std::string& format, const py::object& parameters,
                                      const py::object& motion, std::optional<double> speed,
                                      std::optional<double> tool_radius, bool assume) {
  const OutputArgument target{path_of(output, "output"), false};
  const ExportInputs inputs{path_of(scene, "scene"), optional_path(motion, "motion"),
                            parameters_of(parameters)};
  ExportOptions options{.assumes = assume, .speed = speed, .tool_radius = tool_radius};
  check_effects(inputs, options, format);
  if (const auto plain = plain_format_of(format)) {
    return run_interruptible(
        py::none(), [&](const Observer&) { return export_plain(target, *plain, inputs.scene); });
  }
  const ExportFormat& chosen = format_of(format);
  options.geometry_only = chosen.write == &write_moveit;
  return run_interruptible(py::none(), [&](const Observer&) {
    return export_into(target, chosen, inputs, std::move(options));
  });
}

constexpr char kExportDoc[] =
    R"(Writes a scene with identified friction for a physics engine, as `pcavr export`.

scene        folder from build
output       a new or an empty folder
format       'mjcf', 'urdf', 'sdf' or 'usd'; 'moveit', a planning scene; geometry alone, without the
             arguments below: 'gltf', 'ply', 'obj', 'stl', 'pcd', '3dtiles'
parameters   a dict from object to Parameters, or a parameter file
motion       recording whose tool's motion is written, for MuJoCo with a script that plays it
speed        [m/s] at which the bodies will slide: the coefficients hold there
tool_radius  [m] of the tool's spherical tip
assume       takes defaults for masses and friction that are not known

Returns the warnings. Releases the GIL. Raises Error, also for a movable object without mass or
friction unless `assume`.)";

struct DatasetInputs {
  std::vector<fs::path> recordings, scenes;
  ParametersArgument parameters;
};

Expected<std::size_t> export_recordings(const OutputArgument& output, const DatasetInputs& inputs,
                                        const LerobotOptions& options, const Observer& observer) {
  std::vector<fs::path> paths = inputs.recordings;
  paths.insert(paths.end(), inputs.scenes.begin(), inputs.scenes.end());
  paths.push_back(inputs.parameters.file);
  Expected<OutputFolder> folder = output.create(std::nullopt, paths);
  if (!folder) return folder.error();
  IdentificationOptions identification;
  identification.compares_estimators = false;
  std::vector<LerobotEpisode> episodes;
  for (std::size_t i = 0; i < inputs.recordings.size(); ++i) {
    observer.on_progress("episodes", i, inputs.recordings.size());
    const Expected<Recording> recording =
        read_with_warnings(inputs.recordings[i], false, Settings(), observer);
    if (!recording) return recording.error();
    IdentificationSources sources;
    if (!inputs.scenes.empty()) sources.scene = inputs.scenes[inputs.scenes.size() == 1 ? 0 : i];
    Expected<LerobotEpisode> episode = make_lerobot_episode(
        *recording, sources, inputs.parameters.table.value_or(ParameterTable()), identification,
        options, observer);
    if (!episode) return episode.error();
    episodes.push_back(*std::move(episode));
    if (episodes.back().rate != episodes.front().rate) break;  // which is an error below
  }
  const Expected<LerobotSummary> summary =
      write_lerobot_dataset(episodes, folder->path(), observer);
  if (!summary) return summary.error();
  if (const auto done = folder->commit(); !done) return done.error();
  observer.on_progress("episodes", episodes.size(), episodes.size());
  return summary->frames;
}

std::vector<fs::path> paths_of(const py::object& list, const std::string& name) {
  std::vector<fs::path> paths;
  if (list.is_none()) return paths;
  if (py::isinstance<py::str>(list) || py::hasattr(list, "__fspath__"))
    return {path_of(list, name)};
  for (const py::handle each : list)
    paths.push_back(path_of(py::reinterpret_borrow<py::object>(each), name));
  return paths;
}

std::size_t export_lerobot(const py::object& recordings, const py::object& output,
                           const py::object& parameters, const py::object& scenes,
                           std::optional<int> fps, const std::string& task,
                           const py::object& progress) {
  const OutputArgument target{path_of(output, "output"), false};
  const DatasetInputs inputs{paths_of(recordings, "recordings"), paths_of(scenes, "scenes"),
                             parameters_of(parameters)};
  const std::size_t count = inputs.scenes.size();
  if (inputs.recordings.empty() || (count > 1 && count != inputs.recordings.size())) {
    raise_error({.message = "there are " + std::to_string(inputs.recordings.size()) +
                            " recordings and " + std::to_string(count) + " scenes",
                 .place = "recordings",
                 .hint = "give one or more, and no scene, one for all, or one for each"});
  }
  constexpr int kMaxRate = 1000;
  if (fps && (*fps < 1 || *fps > kMaxRate)) {
    raise_error({.message = std::to_string(*fps) + " is not between 1 and 1000",
                 .place = "fps",
                 .hint = "give frames a second"});
  }
  return run_interruptible(progress, [&](const Observer& observer) {
    return export_recordings(target, inputs, {.rate = fps, .task = task}, observer);
  });
}

constexpr char kLerobotDoc[] =
    R"(Writes recordings as the episodes of a LeRobot data set v3.0, as `pcavr export --to lerobot`.

recordings   a folder, or a list of folders
output       a new or an empty folder
parameters   a dict from object to Parameters, or a parameter file; else what each recording shows
scenes       of recordings with images: the scene of all, or a list with one for each
fps          frames a second; by default the images' rate, or 50
task         what is done, in words; by default 'push NAME'
progress     function of (stage, done, total)

Returns the number of frames. Releases the GIL. Raises Error.)";

}  // namespace

void bind_export(py::module_& module) {
  module.def("export", &export_scene, py::arg("scene"), py::arg("output"), py::arg("format"),
             py::kw_only(), py::arg("parameters") = py::none(), py::arg("motion") = py::none(),
             py::arg("speed") = py::none(), py::arg("tool_radius") = py::none(),
             py::arg("assume") = false, kExportDoc);
  module.def("export_lerobot", &export_lerobot, py::arg("recordings"), py::arg("output"),
             py::kw_only(), py::arg("parameters") = py::none(), py::arg("scenes") = py::none(),
             py::arg("fps") = py::none(), py::arg("task") = "", py::arg("progress") = py::none(),
             kLerobotDoc);
}

}  // namespace pcavr::python
