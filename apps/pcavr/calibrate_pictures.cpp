// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "calibrate_pictures.hpp"

#include <optional>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/perception/board/picture_file.hpp"
#include "pcavr/pipeline/calibrate_pictures.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"

#include "hand_eye_output.hpp"

namespace pcavr::app {
namespace {

nlohmann::ordered_json spread_json(const DistanceSpread& spread) {
  return {{"mean", spread.mean}, {"std", spread.std}, {"max", spread.max}};
}

nlohmann::ordered_json pose_array(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Vector4d q = pose.rotation().coeffs();
  return {p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]};
}

nlohmann::ordered_json rig_json(const PictureRig& found) {
  nlohmann::ordered_json json = hand_eye_json(found.hand_eye);
  json["points_on_board"] = spread_json(found.fitted);
  json["points_on_board_left_out"] = spread_json(found.left_out);
  json["pixel_noise"] = found.pixel_noise;
  json["arm_position_std"] = found.arm_position_std;
  json["arm_rotation_std"] = found.arm_rotation_std;
  if (found.is_camera_estimated) json["intrinsics"] = camera_json(found.camera, found.camera_stds);
  for (const PictureResidual& view : found.views) {
    json["pictures"].push_back({{"view", view.view},
                                {"pixel_rms", view.pixel_rms},
                                {"points_on_board", view.board_mean},
                                {"arm_position", view.arm_position},
                                {"arm_rotation", view.arm_rotation},
                                {"T_base_camera", pose_array(view.T_base_camera)},
                                {"T_base_flange", pose_array(view.T_base_flange)}});
  }
  return json;
}

std::string rig_summary(const PictureRig& found) {
  std::string text;
  if (found.is_camera_estimated) text += camera_lines(found.camera, found.camera_stds);
  text += hand_eye_summary(found.hand_eye);
  text += fmt::format(
      "points on the board, by the arm's poses: {:.2f} +- {:.2f} mm fitted, {:.2f} +- {:.2f} mm "
      "each "
      "view by the others\npixels: {:.2f} px; arm: {:.2f} mm, {:.3f} deg (std of a coordinate)\n",
      1e3 * found.fitted.mean, 1e3 * found.fitted.std, 1e3 * found.left_out.mean,
      1e3 * found.left_out.std, found.pixel_noise, 1e3 * found.arm_position_std,
      57.29577951 * found.arm_rotation_std);
  return text;
}

Error of_pictures(Error error, const PictureRigArguments& arguments) {
  if (!error.file.empty()) return error;
  error.file = error.place == "ROBOT" ? arguments.robot.path : arguments.pictures;
  return error;
}

}  // namespace

CLI::Option* add_board_option(CLI::App& command, std::string& board) {
  return command.add_option(
      "--board", board,
      "The board in the pictures: chessboard:9x6:25mm (inner corners), "
      "charuco:5x7:30mm:22mm:FAMILY "
      "(squares, side of the markers), tags:6x6:88mm:26.4mm:FAMILY (side, gap), dots:10x10:25.4mm, "
      "or Kalibr's file of a target");
}

std::filesystem::path board_file(const Board& board) {
  std::error_code ignored;
  return std::filesystem::exists(board.source, ignored) ? board.source : "";
}

nlohmann::ordered_json camera_json(const CameraModel& camera, const std::vector<double>& stds) {
  nlohmann::ordered_json json{{"width", camera.width}, {"height", camera.height},
                              {"fx", camera.fx},       {"fy", camera.fy},
                              {"cx", camera.cx},       {"cy", camera.cy}};
  const auto coefficients = camera.distortion.coefficients();
  json["distortion"] = std::vector<double>(coefficients.begin(), coefficients.end());
  json["stds"] = stds;
  return json;
}

std::string camera_lines(const CameraModel& camera, const std::vector<double>& stds) {
  std::string text = "camera:";
  const double values[] = {camera.fx, camera.fy, camera.cx, camera.cy};
  constexpr const char* kNames[] = {"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < 4; ++i) {
    const UncertainText value = uncertain(values[i], stds[i]);
    text += fmt::format("{} {} {} +- {}", i > 0 ? "," : "", kNames[i], value.value, value.std);
  }
  text += " px\ndistortion (" + std::string(coefficient_names(camera.distortion.model())) + "):";
  const auto coefficients = camera.distortion.coefficients();
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const UncertainText value = uncertain(coefficients[i], stds[4 + i]);
    text += i > 0 ? "," : "";
    text += stds[4 + i] > 0.0 ? fmt::format(" {} +- {}", value.value, value.std) : " 0";
  }
  return text + '\n';
}

Expected<CommandResult> run_picture_rig(const PictureRigArguments& arguments,
                                        const Observer& observer) {
  const Expected<Board> board = read_board(arguments.board);
  if (!board) return board.error();
  PictureRigOptions options{.hand_eye = arguments.hand_eye};
  if (!arguments.camera_file.empty()) {
    const Expected<CameraFile> camera = read_camera_file(arguments.camera_file);
    if (!camera) return camera.error();
    options.camera = camera->camera;
  }
  Expected<CalibrationOutputs> outputs = CalibrationOutputs::create(
      arguments.output, {arguments.robot.path, arguments.pictures, arguments.camera_file,
                         arguments.depth, board_file(*board)});
  if (!outputs) return outputs.error();
  if (!arguments.depth.empty()) {  // before the long work
    const auto images = list_pictures(arguments.depth);
    if (!images) return images.error();
  }
  const Expected<PairedPictures> paired =
      read_paired_pictures(arguments.robot, arguments.pictures, *board, Parallelism::max());
  if (!paired) return paired.error();
  for (const std::string& note : paired->notes) observer.on_warning(note);
  if (options.camera &&
      (options.camera->width != paired->width || options.camera->height != paired->height)) {
    return Error{.message = fmt::format("is of {} x {} pixels, the pictures have {} x {}",
                                        options.camera->width, options.camera->height,
                                        paired->width, paired->height),
                 .file = arguments.camera_file,
                 .hint = "give the camera of these pictures"};
  }
  const Expected<PictureRig> found =
      calibrate_picture_rig(paired->views, paired->width, paired->height, *board, options);
  if (!found) return of_pictures(found.error(), arguments);
  for (const std::string& note : found->hand_eye.notes) observer.on_warning(note);
  std::optional<DepthAgreement> depth;
  if (!arguments.depth.empty()) {
    const Expected<DepthAgreement> compared =
        compare_depth(*found, *board, arguments.depth, arguments.depth_scale);
    if (!compared) return compared.error();
    depth = *compared;
  }
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}, {"views", paired->views.size()}};
  result.json.update(rig_json(*found));
  result.json["notes"] = found->hand_eye.notes;
  result.summary = fmt::format("robot: {}\n{} pictures of a {} are paired\n", paired->format,
                               paired->views.size(), describe(*board));
  result.summary += rig_summary(*found);
  if (depth) {
    result.json["depth_agreement"] = {{"views", depth->views},
                                      {"median", depth->median},
                                      {"min_pair_median", depth->least},
                                      {"max_pair_median", depth->largest}};
    result.summary += fmt::format(
        "depth of {} views agrees to {:.2f} mm (median; {:.2f} to {:.2f} mm by pairs of views)\n",
        depth->views, 1e3 * depth->median, 1e3 * depth->least, 1e3 * depth->largest);
  }
  result.summary += arguments.output.written_lines();
  result.summary += describe_cause(found->hand_eye) + '\n';
  const Expected<void> done = outputs->commit(
      format_picture_rig(*found, arguments.robot, arguments.pictures, *board),
      [&](const std::filesystem::path& folder) {
        return write_picture_rig_report(*found, *paired, *board, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

}  // namespace pcavr::app
