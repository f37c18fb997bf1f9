// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The steps of a build by tiles that pcavr plan divides among machines.
#include <filesystem>
#include <functional>

#include <fmt/core.h>

#include "pcavr/base/core/freed_memory.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/pipeline/tile_steps.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "scene_options.hpp"

namespace pcavr::app {
namespace {

struct StepArguments {
  SceneArguments scene;
  std::string survey;  ///< of fuse
  std::string part;    ///< of fuse: "2/8"
  std::string output;
  bool replace = false;
};

/// "2/8" as the second of eight parts.
Expected<TilePart> part_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto number = parse_number<std::size_t>(text.substr(0, slash));
  const auto count =
      slash == std::string::npos ? std::nullopt : parse_number<std::size_t>(text.substr(slash + 1));
  if (number && count && *number >= 1 && *number <= *count) return TilePart{*number - 1, *count};
  return Error{.message = "is no part of a number of parts",
               .file = "--part",
               .place = text,
               .hint = "give K/N with K from 1 to N, such as 2/8"};
}

using Step =
    std::function<Expected<void>(const Recording&, const BuildOptions&, const WriteContent&)>;

/// Runs a step that writes a file. The output is checked first, before the long work.
Expected<CommandResult> run_step(const StepArguments& arguments, const Configuration& configuration,
                                 const Observer& observer, const Step& step) {
  return_large_blocks_at_once();
  const SceneArguments& of = arguments.scene;
  const Expected<void> apart =
      check_outputs({arguments.output}, {of.recording, of.sensor, arguments.survey});
  if (!apart) return apart.error();
  Expected<OutputFile> file =
      OutputFile::create(arguments.output, {.replace = arguments.replace,
                                            .kind = "file of a step of a build by tiles",
                                            .is_replaceable = is_tile_file});
  if (!file) return file.error();
  const Expected<BuildOptions> options = build_options_of(of, configuration);
  if (!options) return options.error();
  const Expected<Recording> recording =
      read_with_warnings(of.recording, options->skip_bad, configuration, observer);
  if (!recording) return recording.error();
  std::size_t bytes = 0;
  Expected<void> done = step(*recording, *options, [&](std::string_view content) -> Expected<void> {
    bytes += content.size();
    return file->append(content);
  });
  if (done) done = file->commit();
  if (!done) return done.error();
  return CommandResult{.summary = fmt::format("wrote {}: {:.1f} MB\n", arguments.output,
                                              static_cast<double>(bytes) / 1e6),
                       .json = {{"file", arguments.output}, {"bytes", bytes}}};
}

Expected<CommandResult> survey(const StepArguments& arguments, const Configuration& configuration,
                               const Observer& observer) {
  return run_step(
      arguments, configuration, observer,
      [&](const Recording& recording, const BuildOptions& options, const WriteContent& write) {
        return survey_tiles(limits_of(arguments.scene), recording, options, write, observer);
      });
}

Expected<CommandResult> fuse(const StepArguments& arguments, const Configuration& configuration,
                             const Observer& observer) {
  const Expected<TilePart> part = part_of(arguments.part);
  if (!part) return part.error();
  return run_step(
      arguments, configuration, observer,
      [&](const Recording& recording, const BuildOptions& options, const WriteContent& write) {
        return fuse_tiles(arguments.survey, *part, recording, options, write, observer);
      });
}

void add_step_output(CLI::App& command, StepArguments& arguments) {
  command.add_option("-o,--output", arguments.output, "File for the next step")->required();
  command.add_flag("--force", arguments.replace, "Replace an existing file");
}

}  // namespace

void add_survey(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "survey", "First step of a build by tiles on several machines: frames, bodies and tags");
  command->footer(
      "Example:\n  pcavr survey my_hall --tiles 4 -o hall.survey\n\n"
      "pcavr plan --tiles makes these steps tasks of a plan.");
  auto arguments = std::make_shared<StepArguments>();
  add_scene_options(*command, arguments->scene, configuration);
  add_limits(*command, arguments->scene)->required();
  add_step_output(*command, *arguments);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return survey(*arguments, configuration, observer);
    };
  });
}

void add_fuse(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "fuse", "Second step of a build by tiles on several machines: the tiles of one part");
  command->footer(
      "Example:\n  pcavr fuse my_hall --survey hall.survey --part 1/2 -o hall_1.tiles\n"
      "  pcavr fuse my_hall --survey hall.survey --part 2/2 -o hall_2.tiles\n"
      "  pcavr build my_hall --survey hall.survey --fused hall_1.tiles hall_2.tiles -o my_scene");
  auto arguments = std::make_shared<StepArguments>();
  add_scene_options(*command, arguments->scene, configuration);
  command->add_option("--survey", arguments->survey, "File of pcavr survey")->required();
  command
      ->add_option("--part", arguments->part,
                   "K/N: part K of N, which has every N-th tile; each is a file of its own")
      ->required();
  add_step_output(*command, *arguments);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return fuse(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
