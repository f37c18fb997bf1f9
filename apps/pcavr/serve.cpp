// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/robots/arm/identified_arm.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/page_recorder.hpp"
#include "pcavr/serve/replay_content.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"
#include "pcavr/serve/session_recorder.hpp"
#include "pcavr/teleoperation/devices/open_device.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

#include "commands.hpp"
#include "damping_option.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "page_server.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

constexpr InputRange kTimeScale{"time scale", 0.1, 1.0, "", "slower: nothing seems to move"};

struct ServeArguments {
  std::string scene;
  std::string recording;
  std::string tracked;
  std::string damping_law;  ///< empty: the file's damping
  std::string identified;   ///< report of identify robot
  std::string tiles;        ///< folder of 3D Tiles; empty: the levels of detail
  bool is_torque_driven = false;
  double time_scale = 0.0;  ///< 0: not given
  OutputOption record;      ///< folder of the recording; empty: none
  std::string recordings;   ///< folder of those that pages start; empty: beside the scene
  PageArguments page;
};

/// The inputs, read before anything is served.
struct ServeInputs {
  SceneManifest scene;
  std::optional<ParameterTable> parameters;
  std::optional<Recording> recording;
};

/// Serves the replay's paths where there is a replay, and the scene's.
class ServedContent final : public ContentSource {
 public:
  ServedContent(SceneContent scene, std::optional<ReplayContent> replay)
      : scene_(std::move(scene)), replay_(std::move(replay)) {}

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const override {
    if (replay_) {
      Expected<std::shared_ptr<const Content>> found = replay_->find(path);
      if (!found || *found) return found;
    }
    return scene_.find(path);
  }

 private:
  SceneContent scene_;
  std::optional<ReplayContent> replay_;
};

Expected<ServeInputs> read_inputs(const ServeArguments& arguments,
                                  const Configuration& configuration, const Observer& observer) {
  Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  ServeInputs inputs{std::move(*scene), {}, {}};
  if (!arguments.page.parameters.empty()) {
    std::vector<std::string> notes;
    Expected<ParameterTable> parameters =
        read_parameters_with_damping(arguments.page.parameters, arguments.damping_law, notes);
    if (!parameters) return parameters.error();
    for (const std::string& note : notes) observer.on_warning(note);
    inputs.parameters = std::move(*parameters);
  }
  if (!arguments.recording.empty()) {
    Expected<Recording> recording =
        read_with_warnings(arguments.recording, false, configuration, observer);
    if (!recording) return recording.error();
    inputs.recording = std::move(*recording);
  }
  return inputs;
}

Expected<ServedContent> make_content(const ServeInputs& inputs, const ServeArguments& arguments,
                                     const Configuration& configuration, const Observer& observer) {
  ContentOptions content = configuration.content;
  content.tiles = arguments.tiles;
  Expected<SceneContent> scene =
      SceneContent::create(inputs.scene, inputs.parameters, observer, Parallelism::max(), content);
  if (!scene) return scene.error();
  if (!inputs.recording) return ServedContent(std::move(*scene), {});
  ReplayOptions options;
  options.perception = configuration.perception();
  options.teleop = configuration.teleop;
  options.parameters = inputs.parameters;
  options.parameters_file = arguments.page.parameters;
  if (!arguments.tracked.empty()) options.tracked = arguments.tracked;
  const Expected<Replay> replay =
      replay_recording(*inputs.recording, inputs.scene, options, observer);
  if (!replay) return replay.error();
  Expected<ReplayContent> shown = ReplayContent::create(*inputs.recording, inputs.scene, *replay,
                                                        observer, configuration.content);
  if (!shown) return shown.error();
  return ServedContent(std::move(*scene), std::move(*shown));
}

/// Drives the arm by torques with --torque-driven or --identified.
Expected<void> drive_if_requested(const SceneArm& arm, const ServeArguments& arguments,
                                  const Configuration& configuration, LiveArm& live) {
  if (!arguments.identified.empty()) {
    const Expected<IdentifiedArm> found = read_identified_arm(arguments.identified, arm.model);
    if (!found) return found.error();
    if (found->model.dof != arm.model.dof) {
      return Error{.message = "identifies fewer joints than the arm has",
                   .file = arguments.identified,
                   .hint = "identify all joints"};
    }
    drive_by_torques(live, found->model, found->joints, configuration.arm_drive);
  } else if (arguments.is_torque_driven) {
    if (!arm.model.has_inertia()) {
      return Error{.message = "the arm's description has no masses",
                   .file = arm.model.file.string(),
                   .hint = "give what pcavr identify robot found with --identified"};
    }
    drive_by_torques(live, arm.model, {}, configuration.arm_drive);
  }
  return {};
}

/// Null where the scene has no arm.
Expected<std::unique_ptr<LiveArm>> make_served_arm(const SceneManifest& manifest,
                                                   const SceneWorld& scene,
                                                   const ServeArguments& arguments,
                                                   const Configuration& configuration) {
  const Expected<std::optional<SceneArm>> arm = read_scene_arm(manifest);
  if (!arm) return arm.error();
  if (!*arm) {
    if (!arguments.is_torque_driven && arguments.identified.empty()) {
      return std::unique_ptr<LiveArm>();
    }
    return Error{.message = "has no arm to drive by torques",
                 .file = arguments.scene,
                 .hint = "omit --torque-driven and --identified"};
  }
  auto live = std::make_unique<LiveArm>(make_live_arm(**arm, scene, configuration.arm));
  const Expected<void> driven = drive_if_requested(**arm, arguments, configuration, *live);
  if (!driven) return driven.error();
  return live;
}

Expected<std::unique_ptr<LiveWorld>> make_live(const SceneManifest& manifest,
                                               const SceneWorld& scene,
                                               const ServeArguments& arguments,
                                               const Configuration& configuration) {
  Expected<HapticWorld> haptic = HapticWorld::create(scene.model);
  if (!haptic) return haptic.error();
  Expected<std::unique_ptr<Device>> device = make_device(arguments.page, configuration);
  if (!device) return device.error();
  Expected<std::unique_ptr<LiveArm>> arm =
      make_served_arm(manifest, scene, arguments, configuration);
  if (!arm) return arm.error();
  LiveWorldOptions options = configuration.live;
  options.p_base_tool_start = scene.p_base_tool_start;
  options.full_scale_force = scene.full_scale_force;
  if (arguments.time_scale > 0.0) options.time_scale = arguments.time_scale;
  return std::make_unique<LiveWorld>(std::move(*haptic), std::move(*device), options,
                                     std::move(*arm));
}

/// Null unless one is wanted. Its folder is in place from now on, and grows: neither a signal nor a
/// full disk takes what was done before.
Expected<std::unique_ptr<SessionRecorder>> start_recording(const SceneManifest& scene,
                                                           const ServeArguments& arguments,
                                                           const std::vector<std::string>& names) {
  if (arguments.record.folder.empty()) return std::unique_ptr<SessionRecorder>();
  Expected<OutputFolder> folder =
      create_output(arguments.record, OutputKind::recording, {arguments.scene});
  if (!folder) return folder.error();
  auto recorder =
      std::make_unique<SessionRecorder>(scene, names, arguments.page.server.tool_radius);
  const Expected<void> prepared = recorder->prepare(folder->path());
  if (!prepared) return prepared.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  recorder->start(arguments.record.folder);
  return recorder;
}

/// Ends the recording, and adds what was written to the result.
Expected<void> finish(SessionRecorder& recorder, const ServeArguments& arguments,
                      CommandResult& result) {
  const Expected<SessionRecorder::Summary> summary = recorder.finish();
  if (!summary) return summary.error();
  const std::string& folder = arguments.record.folder;
  result.summary += fmt::format("recorded {:.1f} s to {}", summary->duration, folder);
  if (summary->dropped > 0) result.summary += fmt::format(", {} samples lost", summary->dropped);
  result.summary +=
      fmt::format("\nnext: pcavr replay {} --scene {} -o RUN\n", folder, arguments.scene);
  result.json["recording"] = folder;
  result.json["recorded_s"] = summary->duration;
  result.json["samples_dropped"] = summary->dropped;
  return {};
}

/// What pages record by; null for a replay.
std::unique_ptr<PageRecorder> make_page_recorder(const ServeInputs& inputs,
                                                 const ServeArguments& arguments,
                                                 LiveWorld& world) {
  if (inputs.recording) return nullptr;
  std::filesystem::path folder = arguments.recordings;
  if (folder.empty()) {
    std::filesystem::path scene = std::filesystem::absolute(arguments.scene).lexically_normal();
    if (!scene.has_filename()) scene = scene.parent_path();
    folder = scene.parent_path() / (scene.filename().string() + "_recordings");
  }
  auto recorder = std::make_unique<PageRecorder>(
      inputs.scene, world.names(), arguments.page.server.tool_radius, std::move(folder),
      [&world](SessionRecorder* next) { world.switch_recorder(next); });
  world.offer(*recorder);
  return recorder;
}

/// Ends what a page records, and adds to the result what no page was sent any more.
void finish(PageRecorder& recorder, CommandResult& result) {
  recorder.finish();
  while (const auto message = recorder.take_message()) {
    result.summary += message->text + '\n';
    result.json["recordings"].push_back(message->text);
    result.is_failure = result.is_failure || message->is_error;
  }
}

Expected<CommandResult> run(LiveServer& server, LiveWorld& world, const ServeArguments& arguments,
                            std::size_t triangles, const Observer& observer) {
  const Expected<std::vector<std::string>> notes = world.start();
  if (!notes) return notes.error();
  for (const std::string& note : *notes) observer.on_warning(note);
  const Expected<void> printed = print_startup_message(server, world, arguments.page, triangles);
  if (!printed) return printed.error();
  server.run();
  world.stop();
  const WorldSnapshot& last = world.newest();
  CommandResult result;
  result.summary = "stopped after " + std::to_string(last.cycles) + " cycles, " +
                   std::to_string(last.late_cycles) + " of them late\n";
  result.json = {{"cycles", last.cycles}, {"late_cycles", last.late_cycles}};
  add_cycle_times(world.times(), result.json);
  return result;
}

Expected<CommandResult> serve(ServeArguments arguments, const Configuration& configuration,
                              const Observer& observer) {
  ServerOptions& options = arguments.page.server;
  options.is_replay = !arguments.recording.empty();
  // Errors are reported before the long work.
  const Expected<void> possible = prepare_server(arguments.page, configuration);
  if (!possible) return possible.error();
  const Expected<ServeInputs> inputs = read_inputs(arguments, configuration, observer);
  if (!inputs) return inputs.error();
  options.scene = scene_name(inputs->scene);
  std::optional<double> tool_radius;
  if (inputs->recording) tool_radius = inputs->recording->manifest.tool_radius;
  Expected<SceneWorld> scene = make_page_world(inputs->scene, inputs->parameters, tool_radius,
                                               arguments.page, configuration, observer);
  if (!scene) return scene.error();
  options.tool_radius = scene->model.world.tool_radius;
  Expected<std::unique_ptr<LiveWorld>> world =
      make_live(inputs->scene, *scene, arguments, configuration);
  if (!world) return world.error();
  const std::unique_ptr<PageRecorder> page_recorder =
      make_page_recorder(*inputs, arguments, **world);
  const Expected<ServedContent> content = make_content(*inputs, arguments, configuration, observer);
  if (!content) return content.error();
  Expected<ViewerScene> viewer = make_viewer_scene(inputs->scene, scene->model, inputs->parameters);
  if (!viewer) return viewer.error();
  Expected<LiveServer> server = LiveServer::open(options, **world, *content, std::move(*viewer));
  if (!server) return server.error();
  Expected<std::unique_ptr<SessionRecorder>> recorder =
      start_recording(inputs->scene, arguments, (*world)->names());
  if (!recorder) return recorder.error();
  if (*recorder) (*world)->record(**recorder);
  Expected<CommandResult> result = run(*server, **world, arguments, scene->triangles, observer);
  (*world)->stop();  // after an error, too: its thread refers to the recorder
  if (result && page_recorder) finish(*page_recorder, *result);
  if (!result || !*recorder) return result;
  const Expected<void> written = finish(**recorder, arguments, *result);
  if (!written) return written.error();
  return result;
}

void add_network_options(CLI::App& command, ServerOptions& network, PageArguments& arguments) {
  add_whole<std::uint16_t>(command, "--port", network.port, 0,
                           std::numeric_limits<std::uint16_t>::max(), "TCP port; 0: any free port")
      ->capture_default_str();
  command
      .add_option("--host", network.host,
                  "Address to listen on; other than a loopback address needs --tls and the pairing "
                  "code that is printed at the start")
      ->capture_default_str();
  command.add_flag(
      "--tls", arguments.with_tls,
      "Use https, with a self-signed certificate that is created once for this machine");
  command.add_option("--certificate", arguments.certificate,
                     "Use https with your own certificate chain (PEM)");
  command.add_option("--key", arguments.key, "Private key of the certificate (PEM)");
  add_number(command, "--rate", network.rate, ranges::kStateRate,
             "Rate of state messages to each page [Hz]")
      ->capture_default_str();
  command.add_option("--page", arguments.page, "Folder of the built web page");
}

}  // namespace

void add_serve(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "serve", "Serve a scene to browsers and VR headsets, with simulation and haptics at 1 kHz");
  command->footer(
      "Example:\n  pcavr serve my_scene --parameters my_parameters.yaml\n"
      "With --json: one line with port and addresses once it accepts connections, and the "
      "result at the end.");
  auto arguments = std::make_shared<ServeArguments>();
  command->add_option("scene", arguments->scene, "Scene from pcavr build")->required();
  command->add_option("--replay", arguments->recording, "Replay this recording in the scene");
  command
      ->add_option("--tracked", arguments->tracked,
                   "Run whose tracking the replay uses instead of tracking again")
      ->needs("--replay");
  command->add_option("--parameters", arguments->page.parameters,
                      "Parameter file from pcavr identify");
  add_damping_law(*command, arguments->damping_law, "--parameters");
  command->add_option("--tiles", arguments->tiles,
                      "Folder from pcavr export --to 3dtiles: the page loads of the scan what is "
                      "seen, for scenes too large to load whole");
  add_network_options(*command, configuration.network, arguments->page);
  command
      ->add_option(
          "--device", arguments->page.device,
          "Haptic or input device that moves the tool: page, " + std::string(kDeviceChoices))
      ->capture_default_str();
  add_number(*command, "--tool-radius", arguments->page.tool_radius, ranges::kToolRadius,
             "Radius of the spherical tool tip [m]; default: the replay's, or 0.01");
  add_number(*command, "--max-force", arguments->page.max_force, ranges::kHandForce,
             "Limit of the rendered force [N]; default: 5 for a device, 100 for the page");
  command->add_flag("--torque-driven", arguments->is_torque_driven,
                    "The scene's arm moves by its own dynamics, and its tip is the tool: the hand "
                    "feels what the arm touches");
  command->add_option(
      "--identified", arguments->identified,
      "Report folder of pcavr identify robot: --torque-driven with its inertias and "
      "friction instead of the description's");
  add_number(*command, "--time-scale", arguments->time_scale, kTimeScale,
             "Simulated over real time, 0.1 to 1; default: 1");
  command
      ->add_option("--record", arguments->record.folder,
                   "Folder for a recording of the session, written as it is done: tool, force and "
                   "bodies, for replay, evaluate and --replay")
      ->excludes("--replay");
  command
      ->add_option("--recordings", arguments->recordings,
                   "Folder for the recordings that pages start, each in a folder of its own; "
                   "default: SCENE_recordings, beside the scene")
      ->excludes("--replay");
  command->callback([arguments, &configuration, &action, &app] {
    arguments->page.as_json = app.get_option("--json")->count() > 0;
    action = [arguments, &configuration](const Observer& observer) {
      return serve(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
