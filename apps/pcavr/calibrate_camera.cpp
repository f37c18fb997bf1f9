// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/pipeline/calibrate_pictures.hpp"

#include "calibrate_commands.hpp"
#include "calibrate_pictures.hpp"

namespace pcavr::app {
namespace {

struct CameraArguments {
  std::string pictures, board;
  std::string lens = "plumb_bob", format = "pcavr";
  CalibrationOutputOption output;
  CameraCalibrationOptions options;
};

CameraFormat format_of(const std::string& name) {
  if (name == "ros") return CameraFormat::ros;
  if (name == "opencv") return CameraFormat::opencv;
  return name == "kalibr" ? CameraFormat::kalibr : CameraFormat::pcavr;
}

nlohmann::ordered_json calibration_json(const CameraCalibration& found) {
  nlohmann::ordered_json json{{"intrinsics", camera_json(found.camera, found.stds)},
                              {"pixel_rms", found.pixel_rms}};
  if (found.held_out_rms) json["held_out_rms"] = *found.held_out_rms;
  json["pixel_std"] = found.pixel_std;
  json["covered"] = found.covered;
  for (const CalibratedView& view : found.views) {
    json["views"].push_back({{"view", view.name},
                             {"rms", view.rms},
                             {"tilt", view.tilt},
                             {"is_outlier", view.is_outlier}});
  }
  if (found.missing) {
    json["missing_view"] = {{"text", found.missing->text},
                            {"pixel_std_expected", found.missing->std_expected}};
  }
  json["notes"] = found.notes;
  return json;
}

std::string calibration_summary(const CameraCalibration& found) {
  std::string text = camera_lines(found.camera, found.stds);
  text += fmt::format("points: rms {:.3f} px fitted", found.pixel_rms);
  if (found.held_out_rms) text += fmt::format(", {:.3f} px on unseen views", *found.held_out_rms);
  text += fmt::format(
      "; by the camera's std up to {:.2g} px in the image, {:.0f} % of which has points\n",
      found.pixel_std, 100.0 * found.covered);
  if (found.missing) {
    text += fmt::format("missing view: {}: {:.2g} px then\n", found.missing->text,
                        found.missing->std_expected);
  }
  return text;
}

Expected<CommandResult> run_camera(CameraArguments arguments, const Observer& observer) {
  const Expected<Board> board = read_board(arguments.board);
  if (!board) return board.error();
  if (arguments.lens == "rational") arguments.options.lens = LensModel::rational;
  if (arguments.lens == "fisheye") arguments.options.lens = LensModel::fisheye;
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.pictures, board_file(*board)});
  if (!outputs) return outputs.error();
  const Expected<BoardViews> views =
      read_board_views(arguments.pictures, *board, Parallelism::max());
  if (!views) return views.error();
  for (const std::string& note : views->notes) observer.on_warning(note);
  const Expected<CameraCalibration> found = calibrate_camera(*views, *board, arguments.options);
  if (!found) {
    Error error = found.error();
    error.file = arguments.pictures;
    error.place.clear();
    return error;
  }
  for (const std::string& note : found->notes) observer.on_warning(note);
  const Expected<std::string> text =
      format_camera(*found, arguments.pictures, *board, format_of(arguments.format));
  if (!text) return text.error();
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}};
  result.json.update(calibration_json(*found));
  result.summary = fmt::format("{} pictures of {} x {} pixels show a {}\n", views->views.size(),
                               views->width, views->height, describe(*board));
  result.summary += calibration_summary(*found) + arguments.output.written_lines();
  const Expected<void> done = outputs->commit(*text, [&](const std::filesystem::path& folder) {
    return write_camera_report(*found, *views, *board, json_text(result.json, 2), folder);
  });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_camera(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("camera", "Intrinsics of a camera from pictures of a flat board");
  command->footer(
      "Example:\n  pcavr calibrate camera pictures/ --board chessboard:9x6:25mm -o camera.yaml");
  auto arguments = std::make_shared<CameraArguments>();
  command
      ->add_option("pictures", arguments->pictures,
                   "Folder of pictures (PNG, JPEG) with numbers, or what their names begin with")
      ->required();
  add_board_option(*command, arguments->board)->required();
  add_calibration_output(*command, arguments->output);
  command
      ->add_option("--lens", arguments->lens,
                   "Model of the lens: plumb_bob (usual), rational (wide), fisheye")
      ->check(CLI::IsMember({"plumb_bob", "rational", "fisheye"}))
      ->capture_default_str();
  command->add_flag("--k3", arguments->options.with_k3,
                    "Estimate k3 of plumb_bob, too: for strong distortion, seen up to the corners");
  command
      ->add_option("--to", arguments->format,
                   "Format of the output: pcavr's, ROS camera_info, OpenCV's or Kalibr's")
      ->check(CLI::IsMember({"pcavr", "ros", "opencv", "kalibr"}))
      ->capture_default_str();
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_camera(*arguments, observer); };
  });
}

}  // namespace pcavr::app
