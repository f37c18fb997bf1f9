// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/perception/scene/scene_bundle.hpp"

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

struct ReplayInputs {
  fs::path recording, scene, tracked;
  ParametersArgument parameters;
};

Expected<std::vector<std::string>> replay_into(const OutputArgument& output,
                                               const ReplayInputs& inputs, ReplayOptions options,
                                               Settings& settings, const Observer& observer) {
  Expected<OutputFolder> folder = output.create(
      OutputKind::run, {inputs.recording, inputs.scene, inputs.tracked, inputs.parameters.file});
  if (!folder) return folder.error();
  options.configuration = settings.changed();
  options.parameters = inputs.parameters.table;
  options.parameters_file = inputs.parameters.file.string();
  if (!inputs.tracked.empty()) options.tracked = inputs.tracked;
  options.run_folder = folder->path();
  Expected<Recording> recording =
      read_with_warnings(inputs.recording, options.skip_bad, settings, observer);
  if (!recording) return recording.error();
  const Expected<SceneManifest> scene = read_scene_manifest(inputs.scene);
  if (!scene) return scene.error();
  const Expected<Replay> run = replay_and_release(*recording, *scene, options, observer);
  if (!run) return run.error();
  if (auto done = write_run(*run, *recording, *scene, folder->path()); !done) return done.error();
  if (auto done = folder->commit(); !done) return done.error();
  return run->teleop ? run->teleop->notes : std::vector<std::string>{kNothingPredicted};
}

std::vector<std::string> replay(const py::object& recording, const py::object& scene,
                                const py::object& output, const py::object& parameters,
                                const py::object& tracked, double forward_delay,
                                double backward_delay, bool corrections, bool identify_online,
                                bool trust_poses, bool skip_bad, bool replace, int threads,
                                const py::object& options, const py::object& progress) {
  Settings settings;
  settings.set(options);
  py::dict delays;
  delays["teleop.forward_delay"] = forward_delay;
  delays["teleop.backward_delay"] = backward_delay;
  settings.set(delays);
  ReplayOptions replay_options{.perception = settings.build.perception,
                               .trust_poses = trust_poses,
                               .skip_bad = skip_bad,
                               .parallelism = parallelism_of(threads),
                               .teleop = settings.replayed()};
  if (!corrections) replay_options.teleop.with_corrections = false;
  if (!identify_online) replay_options.teleop.identifies = false;
  const OutputArgument target{path_of(output, "output"), replace};
  const ReplayInputs inputs{path_of(recording, "recording"), path_of(scene, "scene"),
                            optional_path(tracked, "tracked"), parameters_of(parameters)};
  return run_interruptible(progress, [&](const Observer& observer) {
    return replay_into(target, inputs, std::move(replay_options), settings, observer);
  });
}

constexpr char kReplayDoc[] =
    R"(Runs a recording against a scene over a delayed link, as `pcavr replay`.

recording        folder with a recording.yaml
scene            folder from build
output           folder for the run; a new one, or with `replace` a run
parameters       a dict from object to Parameters, or a parameter file; None: defaults
tracked          folder with objects/NAME/tracked.txt; by default the recording's own, else the images
                 are tracked
forward_delay    [s] from operator to robot
backward_delay   [s] from robot to operator
corrections      False: the prediction is not corrected
identify_online  False: the parameters stay as given
trust_poses, skip_bad, threads, options, progress: see build

Returns the notes of the run. Releases the GIL; Ctrl-C ends it at the next progress. Raises Error with
file, line and place.)";

}  // namespace

void bind_replay(py::module_& module) {
  module.def("replay", &replay, py::arg("recording"), py::arg("scene"), py::arg("output"),
             py::kw_only(), py::arg("parameters") = py::none(), py::arg("tracked") = py::none(),
             py::arg("forward_delay") = TeleopOptions().forward_delay,
             py::arg("backward_delay") = TeleopOptions().backward_delay,
             py::arg("corrections") = true, py::arg("identify_online") = true,
             py::arg("trust_poses") = false, py::arg("skip_bad") = false,
             py::arg("replace") = false, py::arg("threads") = 0, py::arg("options") = py::none(),
             py::arg("progress") = py::none(), kReplayDoc);
}

}  // namespace pcavr::python
