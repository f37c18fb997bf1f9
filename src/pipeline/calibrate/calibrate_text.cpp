// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/pipeline/calibrate.hpp"

#include "yaml_text.hpp"

namespace pcavr {
namespace {

constexpr char kCalibrationFormat[] = "format: pcavr-calibration/1";

/// Coordinates that the motion does not show are empty values.
std::string pose_text(const std::string& key, const CalibratedPose& pose) {
  const Eigen::Vector3d& p = pose.T_a_b.translation();
  std::string position, position_std;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_known = pose.position_std[axis].has_value();
    position += (axis > 0 ? ", " : "") + (is_known ? shortest_decimal(p[axis]) : "~");
    position_std +=
        (axis > 0 ? ", " : "") + (is_known ? shortest_decimal(*pose.position_std[axis]) : "~");
  }
  std::string text = key + ":\n";
  text += "  position: [" + position + "]  # m\n";
  text += "  rotation: " + number_list(pose.T_a_b.rotation().coeffs()) + "  # x y z w\n";
  text += "  position_std: [" + position_std + "]  # m, in the parent's axes\n";
  text +=
      "  rotation_std: " + number_list(pose.rotation_std) + "  # rad, about the parent's axes\n";
  text += "  covariance:  # of the twist [v (m); w (rad)] in the child's axes: T exp([v; w])\n";
  return text + row_lists(pose.covariance, "    ");
}

}  // namespace

std::string format_hand_eye(const HandEyeResult& found, const PoseInput& robot,
                            const PoseInput& camera) {
  const bool is_on_arm = found.mount == CameraMount::arm;
  std::string text = std::string(kCalibrationFormat) + "\nkind: hand-eye\n";
  text += std::string("camera_on: ") + (is_on_arm ? "arm" : "base") + '\n';
  text += "sources:\n  robot: " + quoted(robot.path) + "\n  camera: " + quoted(camera.path) + '\n';
  text += pose_text(is_on_arm ? "T_flange_camera" : "T_base_camera", found.camera);
  text += pose_text(is_on_arm ? "T_base_board" : "T_flange_board", found.board);
  if (found.unobservable) {
    text += "not_observable:  # direction of the camera's position in its parent\n  " +
            number_list(*found.unobservable) + '\n';
  }
  text += "board_scale: " + shortest_decimal(found.board_scale) + '\n';
  text += "board_scale_std: " + shortest_decimal(found.board_scale_std) + '\n';
  text +=
      std::string("board_scale_is_used: ") + (found.is_board_scale_used ? "true" : "false") + '\n';
  text += "best_point_board: " + number_list(found.best_point_board) +
          "  # m, whose position the following rms are of\n";
  text += "position_rms: " + shortest_decimal(found.position_rms) + "  # m\n";
  text += "rotation_rms: " + shortest_decimal(found.rotation_rms) + "  # rad\n";
  text += "leave_one_out_rms: " + shortest_decimal(found.leave_one_out_rms) + "  # m\n";
  if (found.held_out_rms) {
    text += "held_out_rms: " + shortest_decimal(*found.held_out_rms) + "  # m\n";
  }
  text += fmt::format("views: {}\noutliers: [", found.residuals.size());
  bool is_first = true;
  for (const HandEyeResidual& residual : found.residuals) {
    if (!residual.is_outlier) continue;
    text += (is_first ? "" : ", ") + quoted(residual.view);
    is_first = false;
  }
  return text + "]\n";
}

std::string format_clock(const ComparedClocks& found) {
  const ClockOffset& clock = found.clock;
  std::string text = std::string(kCalibrationFormat) + "\nkind: clocks\n";
  text += "# t_a = t_b + offset + drift * (t_b - middle)\n";
  text += "sources:\n  a: " + quoted(found.a.name) + "\n  b: " + quoted(found.b.name) + '\n';
  text += "offset: " + shortest_decimal(clock.offset) + "  # s\n";
  text += "offset_std: " + shortest_decimal(clock.std) + '\n';
  if (clock.drift) {
    text += "drift: " + shortest_decimal(*clock.drift) + '\n';
    text += "drift_std: " + shortest_decimal(clock.drift_std) + '\n';
  }
  text += "middle: " + shortest_decimal(clock.middle) + "  # s of b's stamps\n";
  if (!clock.step) return text;
  text += "step:  # to add to the offset from `at` on, of b's stamps\n";
  text += "  at: " + shortest_decimal(clock.step->at) + "  # s\n";
  text += "  size: " + shortest_decimal(clock.step->size) + "  # s\n";
  return text + "  size_std: " + shortest_decimal(clock.step->std) + '\n';
}

bool is_calibration_file(const std::filesystem::path& file) {
  constexpr int kFirstLines = 2;  // OpenCV's files begin with a line of their own
  std::ifstream stream(file);
  std::string line;
  for (int i = 0; i < kFirstLines && std::getline(stream, line); ++i) {
    if (line == kCalibrationFormat || line == kForeignCalibration) return true;
  }
  return false;
}

}  // namespace pcavr
