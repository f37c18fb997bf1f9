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
                              ExportFormat{"sdf", &write_sdf}, ExportFormat{"usd", &write_usd}};

/// Formats of geometry alone.
constexpr std::array kPlainFormats{
    std::pair{"gltf", PlainFormat::gltf}, std::pair{"ply", PlainFormat::ply},
    std::pair{"obj", PlainFormat::obj}, std::pair{"stl", PlainFormat::stl},
    std::pair{"pcd", PlainFormat::pcd}};

const ExportFormat& format_of(const std::string& name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const ExportFormat& each) { return each.name == name; });
  if (found == kFormats.end()) {
    raise_error({.message = "'" + name + "' is not a format",
                 .place = "format",
                 .hint = "give mjcf, urdf, sdf, usd, gltf, ply, obj, stl or pcd"});
  }
  return *found;
}

std::optional<PlainFormat> plain_format_of(const std::string& name) {
  for (const auto& [plain, value] : kPlainFormats) {
    if (name == plain) return value;
  }
  return std::nullopt;
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
  if (auto done = folder->commit(); !done) return done.error();
  return std::vector<std::string>();
}

/// Geometry has neither friction nor motion: such arguments are a mistake of the caller.
void check_plain(bool has_numbers) {
  if (!has_numbers) return;
  raise_error({.message = "has geometry alone",
               .place = "format",
               .hint = "leave out parameters, motion, speed and tool_radius, or give a format for "
                       "engines: mjcf, urdf, sdf or usd"});
}

std::vector<std::string> export_scene(const py::object& scene, const py::object& output,
                                      const std::string& format, const py::object& parameters,
                                      const py::object& motion, std::optional<double> speed,
                                      std::optional<double> tool_radius, bool assume) {
  const OutputArgument target{path_of(output, "output"), false};
  if (const std::optional<PlainFormat> plain = plain_format_of(format)) {
    check_plain(!parameters.is_none() || !motion.is_none() || speed || tool_radius);
    const fs::path folder = path_of(scene, "scene");
    return run_interruptible(py::none(),
                             [&](const Observer&) { return export_plain(target, *plain, folder); });
  }
  const ExportFormat& chosen = format_of(format);
  const ExportInputs inputs{path_of(scene, "scene"), optional_path(motion, "motion"),
                            parameters_of(parameters)};
  ExportOptions options{.assumes = assume, .speed = speed, .tool_radius = tool_radius};
  return run_interruptible(py::none(), [&](const Observer&) {
    return export_into(target, chosen, inputs, std::move(options));
  });
}

constexpr char kExportDoc[] =
    R"(Writes a scene with identified friction for a physics engine, as `pcavr export`.

scene        folder from build
output       a new or an empty folder
format       'mjcf', 'urdf', 'sdf' or 'usd'; geometry alone: 'gltf', 'ply', 'obj', 'stl' or 'pcd'
parameters   a dict from object to Parameters, or a parameter file
motion       recording whose tool's motion is written, for MuJoCo with a script that plays it
speed        [m/s] at which the bodies will slide: the coefficients hold there
tool_radius  [m] of the tool's spherical tip
assume       takes defaults for masses and friction that are not known

Returns the warnings. Releases the GIL. Raises Error, also for a movable object without mass or
friction unless `assume`.)";

}  // namespace

void bind_export(py::module_& module) {
  module.def("export", &export_scene, py::arg("scene"), py::arg("output"), py::arg("format"),
             py::kw_only(), py::arg("parameters") = py::none(), py::arg("motion") = py::none(),
             py::arg("speed") = py::none(), py::arg("tool_radius") = py::none(),
             py::arg("assume") = false, kExportDoc);
}

}  // namespace pcavr::python
