// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "export_lerobot.hpp"

#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "list_recordings.hpp"

namespace pcavr::app {
namespace {

Expected<LerobotEpisode> read_episode(const LerobotArguments& arguments, std::size_t index,
                                      const ParameterTable& known, Configuration& configuration,
                                      const Observer& observer) {
  const Expected<Recording> recording =
      read_with_warnings(arguments.recordings[index], false, configuration, observer);
  if (!recording) return recording.error();
  IdentificationSources sources{.perception = configuration.perception()};
  if (!arguments.scenes.empty())
    sources.scene = arguments.scenes[arguments.scenes.size() == 1 ? 0 : index];
  IdentificationOptions identification = configuration.identification();
  identification.compares_estimators = false;
  return make_lerobot_episode(*recording, sources, known, identification, arguments.options,
                              observer);
}

Expected<ParameterTable> read_known(const LerobotArguments& arguments) {
  if (arguments.parameters.empty()) return ParameterTable();
  return read_parameters(arguments.parameters);
}

Expected<void> check_scenes(const LerobotArguments& arguments) {
  const std::size_t count = arguments.scenes.size();
  if (count <= 1 || count == arguments.recordings.size()) return {};
  return Error{.message = fmt::format("there are {} scenes for {} recordings", count,
                                      arguments.recordings.size()),
               .place = "--scene",
               .hint = "give one for all, or one for each recording, in their order"};
}

CommandResult describe(const LerobotArguments& arguments, const LerobotSummary& summary) {
  CommandResult result;
  const std::size_t episodes = arguments.recordings.size();
  result.summary = fmt::format("{} episode{}, {} frames at {} per second{}\nwrote {}\n", episodes,
                               episodes == 1 ? "" : "s", summary.frames, summary.rate,
                               summary.video_codec.empty() ? "" : ", video " + summary.video_codec,
                               arguments.output);
  result.json = {{"output", arguments.output}, {"format", kLerobotFormat},
                 {"episodes", episodes},       {"frames", summary.frames},
                 {"rate", summary.rate},       {"video_codec", summary.video_codec}};
  return result;
}

}  // namespace

Expected<CommandResult> export_lerobot(const LerobotArguments& given, Configuration& configuration,
                                       const Observer& observer) {
  LerobotArguments arguments = given;
  Expected<std::vector<std::string>> recordings = list_recordings(given.recordings);
  if (!recordings) return recordings.error();
  arguments.recordings = *std::move(recordings);
  if (const auto scenes = check_scenes(arguments); !scenes) return scenes.error();
  std::vector<std::filesystem::path> inputs(arguments.recordings.begin(),
                                            arguments.recordings.end());
  inputs.insert(inputs.end(), arguments.scenes.begin(), arguments.scenes.end());
  inputs.emplace_back(arguments.parameters);
  if (const auto apart = check_outputs({arguments.output}, inputs); !apart) return apart.error();
  Expected<OutputFolder> folder = OutputFolder::create(arguments.output);
  if (!folder) return folder.error();
  const Expected<ParameterTable> known = read_known(arguments);
  if (!known) return known.error();
  std::vector<LerobotEpisode> episodes;
  const std::size_t count = arguments.recordings.size();
  for (std::size_t i = 0; i < count; ++i) {
    observer.on_progress("episodes", i, count);
    Expected<LerobotEpisode> episode = read_episode(arguments, i, *known, configuration, observer);
    if (!episode) return episode.error();
    episodes.push_back(*std::move(episode));
    if (episodes.back().rate != episodes.front().rate) break;  // which is an error below
  }
  const Expected<LerobotSummary> written =
      write_lerobot_dataset(episodes, folder->path(), observer);
  if (!written) return written.error();
  if (const auto committed = folder->commit(); !committed) return committed.error();
  observer.on_progress("episodes", count, count);
  return describe(arguments, *written);
}

}  // namespace pcavr::app
