// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/pipeline/logged_run.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "commands.hpp"
#include "damping_option.hpp"
#include "link_options.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "replay_files.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

struct ReplayArguments {
  std::string recording;
  std::string scene;
  OutputOption output;
  std::string sensor;
  std::string parameters;
  std::string damping_law;  ///< empty: the file's damping
  std::string tracked;
  ReplayFiles files;
  bool without_corrections = false;
  bool keep_parameters = false;
  ReplayOptions options;
  int threads = 1;
};

std::size_t frames_with(const ReplayedObject& object, ObjectEvidence evidence) {
  const auto found = object.frames_by_evidence.find(evidence);
  return found == object.frames_by_evidence.end() ? 0 : found->second;
}

void describe_teleop(const Replay& replay, CommandResult& result) {
  const TeleopRun& run = *replay.teleop;
  const double share = run.streaming_bytes == 0
                           ? 0.0
                           : 100.0 * static_cast<double>(run.correction_bytes) /
                                 static_cast<double>(run.streaming_bytes);
  result.summary +=
      fmt::format("corrections {}, {} bytes: {:.2f} % of the {} that streaming would send\n",
                  run.sent_corrections, run.correction_bytes, share, run.streaming_bytes);
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    if (run.assumed[i].empty()) continue;
    result.summary += "  " + replay.objects[i].name + ": using defaults for:";
    for (const std::string& name : run.assumed[i]) result.summary += ' ' + name;
    result.summary += '\n';
  }
  for (const std::string& note : run.notes) result.summary += "  note: " + note + '\n';
  result.json["corrections"] = run.sent_corrections;
  result.json["correction_bytes"] = run.correction_bytes;
  result.json["streaming_bytes"] = run.streaming_bytes;
  result.json["notes"] = run.notes;
}

CommandResult describe(const Replay& replay, const std::filesystem::path& recording,
                       const std::string& folder) {
  CommandResult result;
  if (replay.objects_are_logged) {
    result.summary = "a live site's log, as it was\n";
  } else if (replay.tracked_folder) {
    result.summary = "tracking   from " + replay.tracked_folder->string() + '\n';
  } else {
    result.summary = frames_line(replay.frames_recorded, replay.frames_used, replay.frames_dropped);
    result.summary += std::string("camera     ") +
                      (replay.camera_from_scene ? "from the scene\n" : "from this recording\n");
  }
  result.json = {{"run", folder},
                 {"frames_recorded", replay.frames_recorded},
                 {"frames_used", replay.frames_used}};
  result.json["objects"] = nlohmann::ordered_json::array();
  for (const ReplayedObject& object : replay.objects) {
    if (object.frames_by_evidence.empty()) {
      result.summary +=
          "  " + object.name + ": " + std::to_string(object.tracked.size()) + " tracked poses\n";
      result.json["objects"].push_back({{"name", object.name}, {"tracked", object.tracked.size()}});
      continue;
    }
    const std::size_t tags = frames_with(object, ObjectEvidence::tags);
    const std::size_t both = frames_with(object, ObjectEvidence::tags_and_shape);
    const std::size_t shape = frames_with(object, ObjectEvidence::shape);
    const std::size_t lost = frames_with(object, ObjectEvidence::none);
    result.summary += "  " + object.name + ": tags and shape " + std::to_string(both) +
                      ", tags alone " + std::to_string(tags) + ", shape alone " +
                      std::to_string(shape) + ", not seen " + std::to_string(lost) + '\n';
    result.json["objects"].push_back({{"name", object.name},
                                      {"tags_and_shape", both},
                                      {"tags", tags},
                                      {"shape", shape},
                                      {"not_seen", lost}});
  }
  result.json["is_predicted"] = replay.teleop.has_value();
  if (replay.teleop) {
    describe_teleop(replay, result);
  } else {
    result.summary += std::string("  note: ") + kNothingPredicted + '\n';
    result.json["notes"] = {kNothingPredicted};
  }
  result.summary += "time\n" + times_table(replay.times);
  const std::filesystem::path truth = recording / "truth";
  std::error_code code;
  const bool has_truth = std::filesystem::is_directory(truth, code);
  result.summary += "next: pcavr evaluate " + folder +
                    (has_truth ? " --truth " + truth.string() : std::string()) + " -o REPORT\n";
  result.json["times"] = times_json(replay.times);
  return result;
}

/// Creates the run's folder before any work; neither it nor another output may overlap an input.
Expected<OutputFolder> create_outputs(const ReplayArguments& arguments) {
  const std::vector<std::filesystem::path> inputs{arguments.recording, arguments.scene,
                                                  arguments.tracked, arguments.parameters,
                                                  arguments.sensor};
  std::vector<std::filesystem::path> outputs{arguments.output.folder};
  for (const std::string& name : arguments.files.names()) outputs.emplace_back(name);
  const Expected<void> apart = check_outputs(outputs, inputs);
  if (!apart) return apart.error();
  return create_output(arguments.output, OutputKind::run, inputs);
}

Expected<CommandResult> replay(ReplayArguments arguments, Configuration& configuration,
                               const Observer& observer) {
  ReplayOptions& options = arguments.options;
  options.parallelism = {arguments.threads};
  arguments.files.replace = arguments.output.replace;
  Expected<OutputFolder> folder = create_outputs(arguments);
  if (!folder) return folder.error();
  options.perception = configuration.perception();
  options.teleop = configuration.replayed();
  options.configuration = configuration.changed();
  const Expected<DepthNoise> noise =
      depth_noise_of(arguments.sensor, options.perception.depth_noise);
  if (!noise) return noise.error();
  options.perception.depth_noise = *noise;
  Expected<Recording> recording =
      read_with_warnings(arguments.recording, options.skip_bad, configuration, observer);
  if (!recording) return recording.error();
  const Expected<void> possible = check_replay_files(arguments.files, *recording);
  if (!possible) return possible.error();
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  if (arguments.without_corrections) options.teleop.with_corrections = false;
  if (arguments.keep_parameters) options.teleop.identifies = false;
  if (!arguments.tracked.empty()) options.tracked = arguments.tracked;
  std::vector<std::string> damping_notes;
  if (!arguments.parameters.empty()) {
    Expected<ParameterTable> parameters =
        read_parameters_with_damping(arguments.parameters, arguments.damping_law, damping_notes);
    if (!parameters) return parameters.error();
    options.parameters = std::move(*parameters);
    options.parameters_file = arguments.parameters;
  }
  if (!arguments.files.need_run()) options.run_folder = folder->path();
  const Expected<Replay> run = arguments.files.need_recording()
                                   ? replay_recording(*recording, *scene, options, observer)
                                   : replay_and_release(*recording, *scene, options, observer);
  if (!run) return run.error();
  const Expected<void> written = write_run(*run, *recording, *scene, folder->path());
  if (!written) return written.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  CommandResult result = describe(*run, recording->folder, arguments.output.folder);
  for (const std::string& note : damping_notes) result.summary += "  " + note + '\n';
  if (!damping_notes.empty()) result.json["contact_damping"] = damping_notes;
  std::vector<SkippedRows> left_out = recording->left_out;
  left_out.insert(left_out.end(), run->left_out.begin(), run->left_out.end());
  describe_left_out(left_out, result);
  const ReplayInput input{*recording, *scene, options, configuration};
  const Expected<void> made = write_replay_files(arguments.files, input, *run, observer, result);
  if (!made) return made.error();
  return result;
}

bool is_log(const std::string& path) {
  std::error_code code;
  return !std::filesystem::exists(std::filesystem::path(path) / "recording.yaml", code) &&
         is_bag(path);
}

/// Writes what a live site has logged as the run that it was: nothing is simulated again.
Expected<CommandResult> replay_log(const ReplayArguments& arguments) {
  for (const auto& [option, value] :
       {std::pair{"--tracked", &arguments.tracked},
        std::pair{"--parameters", &arguments.parameters},
        std::pair{"--video", &arguments.files.video}, std::pair{"--html", &arguments.files.html},
        std::pair{"--mcap", &arguments.files.mcap}}) {
    if (value->empty()) continue;
    return Error{.message = std::string(option) + " is for recordings, but this is a log",
                 .file = arguments.recording,
                 .hint = "'pcavr import' makes a recording of it"};
  }
  Expected<OutputFolder> folder = create_outputs(arguments);
  if (!folder) return folder.error();
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  const Expected<Replay> run = read_logged_run(arguments.recording, *scene);
  if (!run) return run.error();
  Recording log;
  log.folder = arguments.recording;
  const Expected<void> written = write_run(*run, log, *scene, folder->path());
  if (!written) return written.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return describe(*run, log.folder, arguments.output.folder);
}

void add_link_options(CLI::App& command, TeleopOptions& teleop, ReplayArguments& arguments) {
  command.add_option(
      "--parameters", arguments.parameters,
      "Parameter file from pcavr identify; without it both sites start from the scene's "
      "parameters and defaults");
  add_damping_law(command, arguments.damping_law, "--parameters");
  command.add_option(
      "--tracked", arguments.tracked,
      "Run whose tracking is used instead of tracking again; by default the recording's "
      "own folder tracked, if it has one");
  add_number(command, "--forward-delay", teleop.forward_delay, ranges::kDelay,
             "Delay from operator to robot [s]")
      ->capture_default_str();
  add_number(command, "--backward-delay", teleop.backward_delay, ranges::kDelay,
             "Delay from robot to operator [s]")
      ->capture_default_str();
  add_number(command, "--jitter", teleop.jitter, ranges::kJitter,
             "Standard deviation of both delays [s]")
      ->capture_default_str();
  add_number(command, "--loss", teleop.loss, ranges::kShare,
             "Packet loss: fraction of corrections that the network drops")
      ->capture_default_str();
  add_number(command, "--burst", teleop.burst, kBurst,
             "Mean number of corrections lost in a row (Gilbert); below 1: independent losses")
      ->capture_default_str();
  add_number(command, "--reorder", teleop.reorder, ranges::kShare,
             "Fraction of the corrections that are overtaken, by 20 ms")
      ->capture_default_str();
  add_number(command, "--duplicate", teleop.duplicate, ranges::kShare,
             "Fraction of the corrections that arrive twice")
      ->capture_default_str();
  add_number(command, "--rate-limit", teleop.rate_limit, kByteRate,
             "Bytes per second from robot to operator; 0: no limit")
      ->capture_default_str();
  add_seed(command, teleop.seed, "Seed of the network's conditions")->capture_default_str();
  command.add_flag("--no-corrections", arguments.without_corrections,
                   "Predict only: the robot's site sends no corrections");
  command.add_flag("--keep-parameters", arguments.keep_parameters,
                   "Do not identify parameters during the replay");
}

}  // namespace

void add_replay(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "replay",
      "Run a recording against a scene: track its objects, predict them over a delayed link, "
      "correct the prediction");
  command->footer(
      "Example:\n  pcavr replay my_recording --scene my_scene --parameters my_parameters.yaml "
      "--forward-delay 0.2 --backward-delay 0.2 -o my_run");
  auto arguments = std::make_shared<ReplayArguments>();
  command
      ->add_option("recording", arguments->recording,
                   "Folder with a recording.yaml; or the log of a live site (.mcap), which becomes "
                   "a run as it was")
      ->required();
  command->add_option("--scene", arguments->scene, "Scene from pcavr build")->required();
  add_output_option(*command, arguments->output, "Folder for the run");
  add_replay_files(*command, arguments->files);
  add_sensor_option(*command, arguments->sensor);
  command->add_flag("--trust-poses", arguments->options.trust_poses,
                    "Take the poses of groundtruth.txt as exact, not as measurements");
  command->add_flag("--skip-bad", arguments->options.skip_bad,
                    "Skip bad rows and frames, and count them");
  add_link_options(*command, configuration.teleop, *arguments);
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      if (is_log(arguments->recording)) return replay_log(*arguments);
      return replay(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
