// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/pipeline/calibrate_arm.hpp"

#include "calibrate_commands.hpp"
#include "calibrate_pictures.hpp"
#include "calibration_outputs.hpp"
#include "commands.hpp"
#include "hand_eye_output.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr double kJointDegrees = 180.0 / std::numbers::pi;
constexpr InputRange kOffsetStd{"std of the joints' offsets", 1e-3, 10.0, "deg",
                                "from an encoder's step to an arm that was never set"};
constexpr int kMaxSplits = 1000;  ///< more change the third digit only

struct CalibrateArguments {
  std::string first, second;  ///< ROBOT and CAMERA, or A and B
  CalibrationOutputOption output;
  std::string camera_on = "arm";
  std::string board, camera_file, depth;  ///< of pictures in CAMERA
  double depth_scale = 1000.0;            ///< [units/m]
  std::vector<std::string> inverted, w_first;
  std::string left_handed, unit;
  bool skip_bad = false;
  std::string urdf, tip;  ///< of the arm whose joint positions are ROBOT
  double offset_std = kJointDegrees * JointOffsetOptions{}.std;  ///< [deg]
  HandEyeOptions hand_eye;
};

bool names(const std::vector<std::string>& inputs, const char* input) {
  return std::find(inputs.begin(), inputs.end(), input) != inputs.end();
}

PoseInput input_of(const CalibrateArguments& arguments, bool is_first, const char* name) {
  PoseInput input{.path = is_first ? arguments.first : arguments.second};
  input.reading.skip_bad = arguments.skip_bad;
  input.reading.is_w_first = names(arguments.w_first, name);
  if (arguments.unit == "mm") input.reading.length_unit = 1e-3;
  if (arguments.unit == "cm") input.reading.length_unit = 1e-2;
  if (arguments.unit == "m") input.reading.length_unit = 1.0;
  input.is_inverted = names(arguments.inverted, name);
  if (!is_first && !arguments.left_handed.empty()) {
    input.mirrored_axis = arguments.left_handed[0] - 'x';
  }
  return input;
}

nlohmann::ordered_json clock_json(const ClockOffset& clock) {
  nlohmann::ordered_json json{{"is_observable", clock.is_observable}};
  if (!clock.is_observable) {
    json["reason"] = clock.reason;
    return json;
  }
  json["offset"] = clock.offset;
  json["offset_std"] = clock.std;
  if (clock.drift) {
    json["drift"] = *clock.drift;
    json["drift_std"] = clock.drift_std;
    json["middle"] = clock.middle;
  }
  if (clock.step) {
    json["step"] = {
        {"at", clock.step->at}, {"size", clock.step->size}, {"size_std", clock.step->std}};
  }
  json["explained"] = clock.explained;
  return json;
}

std::string clock_line(const ClockOffset& clock) {
  const UncertainText offset = uncertain(1e3 * clock.offset, 1e3 * clock.std);
  std::string text = fmt::format("offset {} +- {} ms", offset.value, offset.std);
  if (clock.drift) {
    const UncertainText drift = uncertain(1e6 * *clock.drift, 1e6 * clock.drift_std);
    text += fmt::format(", drift {} +- {} ppm", drift.value, drift.std);
  }
  if (clock.step) {
    const UncertainText size = uncertain(1e3 * clock.step->size, 1e3 * clock.step->std);
    text += fmt::format(", and {} +- {} ms more from t = {:.2f} s of b on", size.value, size.std,
                        clock.step->at);
  }
  return text + fmt::format("; the common motion of {:.0f} s explains {:.0f} %\n", clock.overlap,
                            100.0 * clock.explained);
}

/// Names the file of the input that the error is about.
Error with_file(Error error, const CalibrateArguments& arguments) {
  if (!error.file.empty()) return error;
  if (error.place == "ROBOT") error.file = arguments.first;
  if (error.place == "CAMERA") error.file = arguments.second;
  return error;
}

/// Options that are about poses of the board, which pictures have none of.
std::optional<Error> unused_for_pictures(const CalibrateArguments& arguments) {
  const char* option = names(arguments.inverted, "camera")  ? "--invert camera"
                       : names(arguments.w_first, "camera") ? "--w-first camera"
                       : !arguments.left_handed.empty()     ? "--left-handed"
                                                            : nullptr;
  if (option == nullptr) return std::nullopt;
  return Error{
      .message = std::string(option) + " is about poses of the board, and CAMERA are pictures",
      .file = arguments.second,
      .hint = "leave it out, or leave out --board"};
}

std::optional<Error> unused_for_joints(const CalibrateArguments& arguments) {
  const char* option = names(arguments.inverted, "robot")  ? "--invert robot"
                       : names(arguments.w_first, "robot") ? "--w-first robot"
                                                           : nullptr;
  if (option == nullptr) return std::nullopt;
  return Error{.message = std::string(option) + " is about poses, and ROBOT has joint positions",
               .file = arguments.first,
               .hint = "leave it out, or leave out --urdf"};
}

/// Of poses of the board: the views, and what they show.
struct FoundRig {
  PairedPoses paired = {};
  HandEyeResult hand_eye = {};
  std::optional<ArmHandEyeResult> arm = {};  ///< where joint positions were given
};

Expected<FoundRig> find_arm_rig(const CalibrateArguments& arguments, const PoseInput& camera) {
  if (const auto error = unused_for_joints(arguments)) return *error;
  Expected<PairedArm> input =
      read_arm_views({arguments.first, arguments.urdf, arguments.tip, arguments.skip_bad}, camera);
  if (!input) return input.error();
  Expected<ArmHandEyeResult> found =
      calibrate_hand_eye_and_arm(input->paired.views, input->arm, input->joints, arguments.hand_eye,
                                 {.std = arguments.offset_std / kJointDegrees});
  if (!found) return with_file(found.error(), arguments);
  return FoundRig{std::move(input->paired), found->hand_eye, *std::move(found)};
}

Expected<FoundRig> find_rig(const CalibrateArguments& arguments, const PoseInput& robot,
                            const PoseInput& camera) {
  if (!arguments.urdf.empty()) return find_arm_rig(arguments, camera);
  Expected<PairedPoses> paired = read_paired_poses(robot, camera);
  if (!paired) return paired.error();
  Expected<HandEyeResult> found = calibrate_hand_eye(paired->views, arguments.hand_eye);
  if (!found) return with_file(found.error(), arguments);
  return FoundRig{*std::move(paired), *std::move(found), {}};
}

nlohmann::ordered_json offsets_json(const ArmHandEyeResult& found) {
  nlohmann::ordered_json offsets = nlohmann::ordered_json::array();
  for (const JointOffset& offset : found.offsets) {
    nlohmann::ordered_json one{{"joint", offset.joint}, {"offset", offset.value}};
    if (!offset.is_held) one["std"] = offset.std;
    one["is_held"] = offset.is_held;
    offsets.push_back(std::move(one));
  }
  return offsets;
}

std::string offset_lines(const ArmHandEyeResult& found) {
  std::string text = "to add to the joints' positions:";
  for (const JointOffset& offset : found.offsets) {
    const UncertainText degrees =
        uncertain(kJointDegrees * offset.value, kJointDegrees * offset.std);
    text += "\n  " + offset.joint + ' ' +
            (offset.is_held ? "0, held: not shown" : degrees.value + " +- " + degrees.std + " deg");
  }
  return text + '\n' + describe_offsets(found) + '\n';
}

Expected<CommandResult> run_hand_eye(CalibrateArguments arguments, const Observer& observer) {
  arguments.hand_eye.mount = arguments.camera_on == "base" ? CameraMount::base : CameraMount::arm;
  if (!arguments.board.empty()) {
    if (const auto error = unused_for_pictures(arguments)) return *error;
    return run_picture_rig({.robot = input_of(arguments, true, "robot"),
                            .pictures = arguments.second,
                            .board = arguments.board,
                            .camera_file = arguments.camera_file,
                            .depth = arguments.depth,
                            .depth_scale = arguments.depth_scale,
                            .output = arguments.output,
                            .hand_eye = arguments.hand_eye},
                           observer);
  }
  Expected<CalibrationOutputs> outputs = CalibrationOutputs::create(
      arguments.output, {arguments.first, arguments.second, arguments.urdf});
  if (!outputs) return outputs.error();
  const PoseInput robot = input_of(arguments, true, "robot");
  const PoseInput camera = input_of(arguments, false, "camera");
  const Expected<FoundRig> rig = find_rig(arguments, robot, camera);
  if (!rig) return rig.error();
  const PairedPoses& paired = rig->paired;
  const HandEyeResult& found = rig->hand_eye;
  for (const std::string& note : paired.notes) observer.on_note(note);
  for (const std::string& note : found.notes) observer.on_warning(note);
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}, {"views", paired.views.size()}};
  result.json["formats"] = paired.formats;
  result.summary = fmt::format("robot: {}\ncamera: {}\n{} views are paired\n", paired.formats[0],
                               paired.formats[1], paired.views.size());
  if (paired.clock) {
    result.summary += "camera's clock: " + clock_line(*paired.clock);
    result.json["clock"] = clock_json(*paired.clock);
  }
  result.json.update(hand_eye_json(found));
  result.json["notes"] = found.notes;
  result.summary += hand_eye_summary(found);
  std::string file = format_hand_eye(found, robot, camera);
  if (rig->arm) {
    file += format_joint_offsets(*rig->arm);
    result.json["joint_offsets"] = offsets_json(*rig->arm);
    if (const auto& rms = rig->arm->without.held_out_rms) {
      result.json["held_out_rms_without_offsets"] = *rms;
    }
    result.summary += offset_lines(*rig->arm);
  }
  result.summary += arguments.output.written_lines() + describe_cause(found) + '\n';
  const Expected<void> done = outputs->commit(file, [&](const std::filesystem::path& folder) {
    return write_hand_eye_report(found, paired, json_text(result.json, 2), folder);
  });
  if (!done) return done.error();
  return result;
}

Expected<CommandResult> run_clocks(const CalibrateArguments& arguments, const Observer& observer) {
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.first, arguments.second});
  if (!outputs) return outputs.error();
  const Expected<ComparedClocks> found =
      compare_pose_clocks(input_of(arguments, true, "a"), input_of(arguments, false, "b"), {});
  if (!found) return found.error();
  for (const std::string& note : found->notes) observer.on_note(note);
  if (!found->clock.is_observable) {
    return Error{
        .message = "the clocks' offset is not observable from this motion: " + found->clock.reason,
        .file = arguments.second,
        .hint = "record both while the body turns to and fro, about several axes"};
  }
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}};
  result.json["formats"] = found->formats;
  result.json.update(clock_json(found->clock));
  for (const PoseStream* stream : {&found->a, &found->b}) {
    result.json["streams"].push_back({{"file", stream->name},
                                      {"out_of_order", stream->out_of_order},
                                      {"repeated", stream->repeated},
                                      {"wild", stream->wild}});
  }
  result.json["notes"] = found->notes;
  result.summary = fmt::format("a: {}\nb: {}\nto add to b's stamps: {}", found->formats[0],
                               found->formats[1], clock_line(found->clock));
  result.summary += arguments.output.written_lines();
  const Expected<void> done =
      outputs->commit(format_clock(*found), [&](const std::filesystem::path& folder) {
        return write_clock_report(*found, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

void add_common(CLI::App& command, CalibrateArguments& arguments,
                const std::vector<std::string>& inputs) {
  add_calibration_output(command, arguments.output);
  command
      .add_option("--invert", arguments.inverted,
                  "Input whose poses are inverted, such as those of a camera in the board's frame")
      ->check(CLI::IsMember(inputs));
  command.add_option("--w-first", arguments.w_first, "Input whose quaternions are w x y z")
      ->check(CLI::IsMember(inputs));
  command
      .add_option("--left-handed", arguments.left_handed,
                  "Axis to reverse in the second input, whose frames are left-handed")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command
      .add_option("--unit", arguments.unit,
                  "Unit of lengths in both inputs; default: the header's, or by their size")
      ->check(CLI::IsMember({"m", "cm", "mm"}));
  command.add_flag("--skip-bad", arguments.skip_bad, "Leave out rows that can't be read");
}

void add_hand_eye(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "hand-eye", "Where a camera is on an arm, or beside it, from views of a board");
  command->footer(
      "Example:\n  pcavr calibrate hand-eye robot_poses/ board_in_camera.csv -o hand_eye.yaml");
  auto arguments = std::make_shared<CalibrateArguments>();
  command
      ->add_option("robot", arguments->first,
                   "Poses of the flange in the arm's base: a table, or a folder with a file a view")
      ->required();
  command
      ->add_option("camera", arguments->second,
                   "Poses of the board in the camera; with --board a folder of pictures")
      ->required();
  add_common(*command, *arguments, {"robot", "camera"});
  CLI::Option* board = add_board_option(*command, arguments->board);
  command
      ->add_option("--camera", arguments->camera_file,
                   "The camera of the pictures; without it, its intrinsics are estimated, too")
      ->needs(board);
  CLI::Option* depth = command
                           ->add_option("--depth", arguments->depth,
                                        "Depth images aligned to the pictures, of the same "
                                        "numbers: how well the views agree is printed")
                           ->needs(board);
  add_number(*command, "--depth-scale", arguments->depth_scale, ranges::kDepthScale,
             "Depth image units in one metre")
      ->needs(depth)
      ->capture_default_str();
  command
      ->add_option(
          "--camera-on", arguments->camera_on,
          "arm: the camera is on the flange; base: it stands, and the board is on the flange")
      ->check(CLI::IsMember({"arm", "base"}))
      ->capture_default_str();
  CLI::Option* urdf =
      command
          ->add_option("--urdf", arguments->urdf,
                       "The arm's description: ROBOT has joint positions (index, q_NAME), and the "
                       "joints' offsets are estimated, too")
          ->excludes(board);
  command->add_option("--tip", arguments->tip, "Link that is the flange; default: the chain's last")
      ->needs(urdf);
  add_number(*command, "--offset-std", arguments->offset_std, kOffsetStd,
             "Std of the joints' offsets before the views were seen [deg]")
      ->needs(urdf)
      ->capture_default_str();
  add_whole<int>(*command, "--splits", arguments->hand_eye.splits, 0, kMaxSplits,
                 "Random splits for the error on unseen views")
      ->capture_default_str();
  add_seed(*command, arguments->hand_eye.seed, "Seed of the splits")->capture_default_str();
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_hand_eye(*arguments, observer); };
  });
}

void add_clocks(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "clocks", "Offset and drift of the clocks of two streams of poses of one body");
  command->footer("Example:\n  pcavr calibrate clocks tool.csv headset.csv -o clocks.yaml");
  auto arguments = std::make_shared<CalibrateArguments>();
  command->add_option("a", arguments->first, "Stream whose clock is kept: a table with stamps")
      ->required();
  command->add_option("b", arguments->second, "Stream whose stamps are to be corrected")
      ->required();
  add_common(*command, *arguments, {"a", "b"});
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_clocks(*arguments, observer); };
  });
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Find where camera and tags are, how a force sensor is turned, whose clock is late");
  command->require_subcommand(1);
  add_hand_eye(*command, action);
  add_clocks(*command, action);
  add_calibrate_camera(*command, action);
  add_calibrate_depth(*command, action);
  add_calibrate_objects(*command, action);
  add_calibrate_tags(*command, action);
  add_calibrate_force(*command, action);
  add_calibrate_touch(*command, action);
}

}  // namespace pcavr::app
