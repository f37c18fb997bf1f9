// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/freed_memory.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/build_limits.hpp"

#include "commands.hpp"
#include "output_option.hpp"
#include "scene_options.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

struct BuildArguments {
  SceneArguments scene;
  OutputOption output;
  std::string survey;
  std::vector<std::string> fused;
};

Expected<CommandResult> build(const BuildArguments& arguments, Configuration& configuration,
                              const Observer& observer) {
  const SceneArguments& of = arguments.scene;
  if (of.tile_size > 0.0 || !arguments.survey.empty()) return_large_blocks_at_once();
  // First, so that an output that can't be written fails before the long work.
  std::vector<std::filesystem::path> inputs{of.recording, of.sensor, arguments.survey};
  inputs.insert(inputs.end(), arguments.fused.begin(), arguments.fused.end());
  Expected<OutputFolder> folder = create_output(arguments.output, OutputKind::scene, inputs);
  if (!folder) return folder.error();
  const Expected<BuildOptions> options = build_options_of(of, configuration);
  if (!options) return options.error();
  const Expected<Recording> recording =
      read_with_warnings(of.recording, options->skip_bad, configuration, observer);
  if (!recording) return recording.error();
  BuildLimits limits = limits_of(of);
  limits.survey = arguments.survey;
  limits.fused.assign(arguments.fused.begin(), arguments.fused.end());
  Expected<Scene> scene = build_scene_within(limits, *recording, *options, observer);
  if (!scene) return scene.error();
  scene->configuration = configuration.changed();
  const Expected<void> written = write_scene(*scene, folder->path(), options->parallelism);
  if (!written) return written.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  CommandResult result{.summary = scene_summary(*scene, arguments.output.folder),
                       .json = scene_json(*scene, arguments.output.folder)};
  describe_left_out(recording->left_out, result);
  return result;
}

}  // namespace

void add_build(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command =
      app.add_subcommand("build", "Build a scene in the robot's base frame from a recording");
  command->footer("Example:\n  pcavr build my_recording -o my_scene --voxel 0.005");
  auto arguments = std::make_shared<BuildArguments>();
  add_scene_options(*command, arguments->scene, configuration);
  add_output_option(*command, arguments->output, "Folder for the scene");
  CLI::Option* tiles = add_limits(*command, arguments->scene);
  CLI::Option* survey =
      command
          ->add_option("--survey", arguments->survey,
                       "File of pcavr survey, in the place of placing the frames; with --fused")
          ->excludes(tiles);
  CLI::Option* fused = command
                           ->add_option("--fused", arguments->fused,
                                        "Files of pcavr fuse, of all parts of the tiles, in the "
                                        "place of fusing them")
                           ->needs(survey);
  survey->needs(fused);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return build(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
