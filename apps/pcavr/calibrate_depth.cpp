// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_depth.hpp"

#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "calibrate_commands.hpp"
#include "calibration_outputs.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr std::size_t kMaxFramesUsed = 100'000;

struct CalibrateDepthArguments {
  std::string recording;
  CalibrationOutputOption output;
  DepthInput depth;
};

nlohmann::ordered_json depth_json(const DepthCalibration& found, const DepthViews& views) {
  nlohmann::ordered_json json{{"images", views.frames},
                              {"views", views.views.size()},
                              {"places", views.places},
                              {"depth_scale", found.depth_scale},
                              {"depth_offset", found.depth_offset},
                              {"scale", found.scale},
                              {"scale_std", found.scale_std},
                              {"offset", nullptr},
                              {"offset_std", nullptr}};
  if (found.has_offset) {
    json["offset"] = found.offset;
    json["offset_std"] = found.offset_std;
  }
  json["correlation"] =
      found.has_offset ? found.covariance(0, 1) / (found.scale_std * found.offset_std) : 0.0;
  json["nearest"] = found.nearest;
  json["farthest"] = found.farthest;
  json["before_rms"] = found.before_rms;
  json["fitted_rms"] = found.fitted_rms;
  json["held_out_rms"] = found.held_out_rms;
  json["plane_rms"] = found.plane_rms;
  json["plane_tilt"] = found.plane_tilt;
  json["verdict"] = describe_depth(found);
  json["notes"] = found.notes;
  return json;
}

std::string depth_summary(const DepthCalibration& found, const DepthViews& views) {
  const UncertainText scale = uncertain(found.scale, found.scale_std);
  const UncertainText offset = uncertain(1e3 * found.offset, 1e3 * found.offset_std);
  const std::string added =
      found.has_offset ? fmt::format("{} +- {} mm", offset.value, offset.std) : "not observable";
  return fmt::format(
      "{} views of a tag from {} places, {:.2f} to {:.2f} m away\n"
      "true depth over measured: {} +- {}; to be added: {}\n"
      "error of each place by the others: {} mm rms; as it was read: {} mm\n"
      "a tag's pixels about their plane: {} mm rms; that plane against the tag's: {} deg\n",
      views.views.size(), views.places, found.nearest, found.farthest, scale.value, scale.std,
      added, readable(1e3 * found.held_out_rms), readable(1e3 * found.before_rms),
      readable(1e3 * found.plane_rms), readable(180.0 / std::numbers::pi * found.plane_tilt));
}

Expected<CommandResult> run_depth(CalibrateDepthArguments arguments, const Observer& observer) {
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.recording});
  if (!outputs) return outputs.error();
  arguments.depth.recording = arguments.recording;
  const Expected<DepthViews> views = read_depth_views(arguments.depth, observer);
  if (!views) return views.error();
  const Expected<DepthCalibration> found = calibrate_depth(*views);
  if (!found) {
    Error error = found.error();
    error.file = arguments.recording;
    return error;
  }
  for (const std::string& note : found->notes) observer.on_warning(note);
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}};
  result.json.update(depth_json(*found, *views));
  result.summary = depth_summary(*found, *views) + arguments.output.written_lines() +
                   how_to_use(arguments.output.file) + describe_depth(*found) + '\n';
  const Expected<void> done = outputs->commit(
      format_depth(*found, arguments.depth), [&](const std::filesystem::path& folder) {
        return write_depth_report(*found, *views, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_depth(CLI::App& calibrate, Action& action) {
  CLI::App* command = calibrate.add_subcommand(
      "depth", "Scale, offset and plane error of a depth camera, against tags");
  command->footer("Example:\n  pcavr calibrate depth my_recording -o depth.yaml");
  auto arguments = std::make_shared<CalibrateDepthArguments>();
  command
      ->add_option("recording", arguments->recording,
                   "Recording with depth images of tags at several distances")
      ->required();
  add_calibration_output(*command, arguments->output);
  add_whole<std::size_t>(*command, "--frames", arguments->depth.max_frames, 1, kMaxFramesUsed,
                         "Images to use at most, evenly spaced")
      ->capture_default_str();
  command->add_flag("--skip-bad", arguments->depth.skip_bad,
                    "Leave out rows and images that can't be read");
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_depth(*arguments, observer); };
  });
}

}  // namespace pcavr::app
