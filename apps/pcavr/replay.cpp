// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <algorithm>

#include "pcavr/core/output.hpp"

#include "commands.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

struct ReplayArguments {
  std::string recording;
  std::string scene;
  OutputOption output;
  std::string sensor;
  ReplayOptions options;
  int threads = 1;
};

std::size_t count_seen(const ReplayedObject& object, ObjectEvidence evidence) {
  return static_cast<std::size_t>(
      std::count_if(object.observations.begin(), object.observations.end(),
                    [&](const ObjectObservation& seen) { return seen.evidence == evidence; }));
}

CommandResult describe(const Replay& replay, const std::string& folder) {
  CommandResult result;
  result.summary = frames_line(replay.frames_recorded, replay.frames_used, replay.frames_dropped);
  result.summary += std::string("camera     ") +
                    (replay.camera_from_scene ? "from the scene\n" : "from this recording\n");
  result.json = {{"run", folder},
                 {"frames_recorded", replay.frames_recorded},
                 {"frames_used", replay.frames_used}};
  result.json["objects"] = nlohmann::ordered_json::array();
  for (const ReplayedObject& object : replay.objects) {
    const std::size_t tags = count_seen(object, ObjectEvidence::tags);
    const std::size_t both = count_seen(object, ObjectEvidence::tags_and_shape);
    const std::size_t shape = count_seen(object, ObjectEvidence::shape);
    const std::size_t lost = count_seen(object, ObjectEvidence::none);
    result.summary += "  " + object.name + ": tags and shape " + std::to_string(both) +
                      ", tags alone " + std::to_string(tags) + ", shape alone " +
                      std::to_string(shape) + ", not seen " + std::to_string(lost) + '\n';
    result.json["objects"].push_back({{"name", object.name},
                                      {"tags_and_shape", both},
                                      {"tags", tags},
                                      {"shape", shape},
                                      {"not_seen", lost}});
  }
  result.summary += "time\n" + times_table(replay.times);
  result.summary += "next: pcavr evaluate " + folder + " --truth RECORDING/truth -o REPORT\n";
  result.json["times"] = times_json(replay.times);
  return result;
}

Expected<CommandResult> replay(ReplayArguments arguments, const Observer& observer) {
  ReplayOptions& options = arguments.options;
  options.parallelism = {arguments.threads};
  const Expected<DepthNoise> noise = depth_noise_of(arguments.sensor);
  if (!noise) return noise.error();
  options.depth_noise = *noise;
  const Expected<Recording> recording =
      read_recording(arguments.recording, {.skip_bad = options.skip_bad});
  if (!recording) return recording.error();
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  Expected<OutputFolder> folder =
      OutputFolder::create(arguments.output.folder, arguments.output.replace);
  if (!folder) return folder.error();

  const Expected<Replay> run = replay_tracking(*recording, *scene, options, observer);
  if (!run) return run.error();
  const Expected<void> written = write_run(*run, *recording, *scene, folder->path());
  if (!written) return written.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return describe(*run, arguments.output.folder);
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "replay", "Run a recording against a scene and write each object's tracked trajectory");
  command->footer("Example:\n  pcavr replay my_recording --scene my_scene -o my_run");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("recording", arguments->recording, "Folder with a recording.yaml")
      ->required();
  command->add_option("--scene", arguments->scene, "Folder that pcavr build wrote")->required();
  add_output_option(*command, arguments->output, "Folder for the run");
  add_sensor_option(*command, arguments->sensor);
  command->add_flag("--trust-poses", arguments->options.trust_poses,
                    "Take groundtruth.txt as given, not as a measurement");
  command->add_flag("--skip-bad", arguments->options.skip_bad,
                    "Leave out bad rows and frames, and count them");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return replay(*arguments, observer); };
  });
}

}  // namespace pcavr::app
