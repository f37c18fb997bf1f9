// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "replay_files.hpp"

#include <cstddef>
#include <filesystem>

#include <fmt/core.h>

#include "pcavr/pipeline/augmented_frames.hpp"
#include "pcavr/serve/replay_content.hpp"
#include "pcavr/serve/replay_log.hpp"
#include "pcavr/serve/replay_page.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/serve/scene_joints.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/viewer_scene.hpp"

#include "number_option.hpp"
#include "shared_files.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6;  // [bytes]
constexpr InputRange kHtmlSize{"size of the page", 2.0, 500.0, "MB",
                               "larger: browsers open it slowly, or not at all"};

Expected<void> check_video(const ReplayFiles& files, const Recording& recording) {
  if (!recording.manifest.camera || recording.frames.empty()) {
    return Error{.message = "the recording has no images for the video",
                 .file = recording.folder.string(),
                 .hint = "omit --video"};
  }
  return check_video_target(files.video, files.replace);
}

Expected<void> make_video(const ReplayFiles& files, const ReplayInput& input, const Replay& run,
                          const Observer& observer, CommandResult& result) {
  const Expected<AugmentedFrames> frames =
      AugmentedFrames::create(input.recording, input.scene, run);
  if (!frames) return frames.error();
  const AugmentedVideoOptions options{.replace = files.replace,
                                      .skip_bad = input.options.skip_bad,
                                      .parallelism = input.options.parallelism};
  const Expected<AugmentedVideo> video =
      write_augmented_video(*frames, files.video, options, observer);
  if (!video) return video.error();
  if (!video->is_h264) {
    observer.on_warning(files.video +
                        " is MPEG-4 part 2, which browsers don't play: this machine's FFmpeg has "
                        "no H.264 encoder");
  }
  result.summary += fmt::format("video      {}: {} frames at {:.4g} Hz\n", files.video,
                                video->pictures, video->rate);
  result.json["video"] = {{"file", files.video},
                          {"pictures", video->pictures},
                          {"left_out", video->left_out},
                          {"rate", video->rate},
                          {"h264", video->is_h264}};
  return {};
}

/// The built page of a replay in one file.
Expected<fs::path> find_replay_page() {
  const fs::path folder = find_shared_folder("viewer", "apps/viewer/dist", kReplayPageFile);
  if (!folder.empty()) return folder / kReplayPageFile;
  return Error{.message = "the page of a replay is not built", .hint = "run scripts/build-page"};
}

Expected<void> check_html(const ReplayFiles& files) {
  const Expected<fs::path> page = find_replay_page();
  if (!page) return page.error();
  return check_replay_page(files.html, files.replace);
}

Expected<void> make_html(const ReplayFiles& files, const ReplayInput& input, const Replay& run,
                         const Observer& observer, CommandResult& result) {
  const ContentOptions& content = input.configuration.content;
  const Expected<SceneContent> scene = SceneContent::create(
      input.scene, input.options.parameters, observer, input.options.parallelism, content);
  if (!scene) return scene.error();
  const Expected<ReplayContent> replay =
      ReplayContent::create(input.recording, input.scene, run, observer, content);
  if (!replay) return replay.error();
  const Expected<fs::path> page = find_replay_page();
  if (!page) return page.error();
  const ReplayPageOptions options{
      .max_bytes = static_cast<std::size_t>(files.html_size * kMegabyte),
      .replace = files.replace,
      .skip_bad = input.options.skip_bad};
  const Expected<ReplayPage> html = write_replay_page(
      files.html, *page, *scene, *replay, scene_name(input.scene), PCAVR_VERSION, options);
  if (!html) return html.error();
  result.summary += fmt::format("page       {}: {:.1f} MB, scan of {} triangles, {} of {} images\n",
                                files.html, static_cast<double>(html->bytes) / kMegabyte,
                                html->triangles, html->images, html->images_recorded);
  if (html->levels_left_out > 0) {
    result.summary += "           a finer scan has no room: allow more with --html-size\n";
  }
  result.json["html"] = {
      {"file", files.html},           {"bytes", html->bytes},
      {"triangles", html->triangles}, {"levels_left_out", html->levels_left_out},
      {"images", html->images},       {"images_recorded", html->images_recorded}};
  return {};
}

Expected<void> make_mcap(const ReplayFiles& files, const ReplayInput& input, const Replay& run,
                         CommandResult& result) {
  SceneWorldOptions options = input.configuration.serve;
  options.parameters = input.options.parameters;
  options.parameters_file = input.options.parameters_file;
  const Expected<SceneWorld> world = make_scene_world(input.scene, options);
  if (!world) return world.error();
  const Expected<ViewerScene> scene =
      make_viewer_scene(input.scene, world->model, input.options.parameters);
  if (!scene) return scene.error();
  const Expected<std::optional<JointLog>> joints = read_scene_joints(input.recording, input.scene);
  if (!joints) return joints.error();
  const ReplayLogOptions log{.rate = input.configuration.black_box.display_rate,
                             .replace = files.replace};
  const Expected<std::uint64_t> messages =
      write_replay_log(files.mcap, input.recording, run, *scene, log, *joints);
  if (!messages) return messages.error();
  result.summary += fmt::format("log        {}: {} messages\n", files.mcap, *messages);
  result.json["mcap"] = {{"file", files.mcap}, {"messages", *messages}};
  return {};
}

}  // namespace

std::vector<std::string> ReplayFiles::names() const {
  std::vector<std::string> given;
  for (const std::string* name : {&video, &html, &mcap}) {
    if (!name->empty()) given.push_back(*name);
  }
  return given;
}

void add_replay_files(CLI::App& command, ReplayFiles& files) {
  command.add_option(
      "--video", files.video,
      "Write the predicted bodies, drawn over the recorded images, as an .mp4; --force "
      "replaces an existing .mp4");
  command.add_option("--html", files.html,
                     "Write the replay as one .html file that opens without a server, for others "
                     "or beside a paper; --force replaces an existing one");
  add_number(command, "--html-size", files.html_size, kHtmlSize,
             "Largest size of that file [MB]: the scan's level of detail and the number of images "
             "follow from it")
      ->capture_default_str();
  command.add_option(
      "--mcap", files.mcap,
      "Write geometry, images, poses, forces, phases, corrections and parameters "
      "as an .mcap for Foxglove, Rerun and others; --force replaces an existing one");
}

Expected<void> check_replay_files(const ReplayFiles& files, const Recording& recording) {
  Expected<void> checked;
  if (!files.video.empty()) checked = check_video(files, recording);
  if (checked && !files.html.empty()) checked = check_html(files);
  if (checked && !files.mcap.empty()) checked = check_replay_log(files.mcap, files.replace);
  return checked;
}

Expected<void> write_replay_files(const ReplayFiles& files, const ReplayInput& input,
                                  const Replay& run, const Observer& observer,
                                  CommandResult& result) {
  Expected<void> written;
  if (!files.video.empty()) written = make_video(files, input, run, observer, result);
  if (written && !files.html.empty()) written = make_html(files, input, run, observer, result);
  if (written && !files.mcap.empty()) written = make_mcap(files, input, run, result);
  return written;
}

}  // namespace pcavr::app
