// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "hand_eye_output.hpp"

#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/report/number_text.hpp"

namespace pcavr::app {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

std::string pose_lines(const std::string& name, const CalibratedPose& pose) {
  std::string text = name + ":";
  for (int axis = 0; axis < 3; ++axis) {
    text += std::string(" ") + "xyz"[axis] + ' ';
    if (pose.position_std[axis]) {
      const UncertainText value =
          uncertain(1e3 * pose.T_a_b.translation()[axis], 1e3 * *pose.position_std[axis]);
      text += value.value + " +- " + value.std + " mm,";
    } else {
      text += "not observable,";
    }
  }
  const Eigen::Vector3d vector = kDegreesPerRadian * pose.T_a_b.log().tail<3>();
  text += " rotation vector";
  for (int axis = 0; axis < 3; ++axis) {
    const UncertainText value =
        uncertain(vector[axis], kDegreesPerRadian * pose.rotation_std[axis]);
    text += (axis > 0 ? ", " : " ") + value.value + " +- " + value.std;
  }
  return text + " deg\n";
}

nlohmann::ordered_json pose_json(const CalibratedPose& pose) {
  nlohmann::ordered_json json;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_known = pose.position_std[axis].has_value();
    json["position"].push_back(is_known ? nlohmann::ordered_json(pose.T_a_b.translation()[axis])
                                        : nlohmann::ordered_json());
    json["position_std"].push_back(is_known ? nlohmann::ordered_json(*pose.position_std[axis])
                                            : nlohmann::ordered_json());
    json["rotation_std"].push_back(pose.rotation_std[axis]);
  }
  const Eigen::Vector4d q = pose.T_a_b.rotation().coeffs();
  json["rotation"] = {q[0], q[1], q[2], q[3]};
  return json;
}

}  // namespace

nlohmann::ordered_json hand_eye_json(const HandEyeResult& found) {
  const bool is_on_arm = found.mount == CameraMount::arm;
  nlohmann::ordered_json json{
      {"camera_on", is_on_arm ? "arm" : "base"}, {"camera", pose_json(found.camera)},
      {"board", pose_json(found.board)},         {"position_rms", found.position_rms},
      {"rotation_rms", found.rotation_rms},      {"leave_one_out_rms", found.leave_one_out_rms}};
  const Eigen::Vector3d& point = found.best_point_board;
  json["best_point_board"] = {point.x(), point.y(), point.z()};
  if (found.held_out_rms) json["held_out_rms"] = *found.held_out_rms;
  json["board_scale"] = found.board_scale;
  json["board_scale_std"] = found.board_scale_std;
  json["board_scale_is_used"] = found.is_board_scale_used;
  if (found.unobservable) {
    const Eigen::Vector3d& axis = *found.unobservable;
    json["not_observable"] = {axis.x(), axis.y(), axis.z()};
  }
  json["cause"] = {{"is_separable", found.cause.is_separable}, {"camera", found.cause.camera},
                   {"camera_std", found.cause.camera_std},     {"arm", found.cause.arm},
                   {"arm_std", found.cause.arm_std},           {"text", describe_cause(found)}};
  json["outliers"] = nlohmann::ordered_json::array();
  for (const HandEyeResidual& residual : found.residuals) {
    if (!residual.is_outlier) continue;
    nlohmann::ordered_json outlier{{"view", residual.view}, {"position", residual.position.norm()}};
    if (residual.partner) outlier["partner"] = *residual.partner;
    json["outliers"].push_back(outlier);
  }
  if (found.next) json["next_pose"] = found.next->text;
  return json;
}

std::string hand_eye_summary(const HandEyeResult& found) {
  const bool is_on_arm = found.mount == CameraMount::arm;
  std::string text = pose_lines(is_on_arm ? "camera in flange" : "camera in base", found.camera) +
                     pose_lines(is_on_arm ? "board in base" : "board in flange", found.board);
  text += fmt::format(
      "board's position, at ({:.0f}, {:.0f}, {:.0f}) mm of it: rms {:.2f} mm fitted, {:.2f} mm "
      "each by the others",
      1e3 * found.best_point_board.x(), 1e3 * found.best_point_board.y(),
      1e3 * found.best_point_board.z(), 1e3 * found.position_rms, 1e3 * found.leave_one_out_rms);
  if (found.held_out_rms) {
    text += fmt::format(", {:.2f} mm on unseen views", 1e3 * *found.held_out_rms);
  }
  text += fmt::format("; rotation rms {:.2f} deg\n", kDegreesPerRadian * found.rotation_rms);
  if (found.next) {
    text += "next pose: " + found.next->text +
            (found.next->std_now
                 ? fmt::format(": the camera's largest std falls from {:.2g} to {:.2g} mm\n",
                               1e3 * *found.next->std_now, 1e3 * found.next->std_expected)
                 : fmt::format(": the camera's position then shows to {:.2g} mm\n",
                               1e3 * found.next->std_expected));
  }
  return text;
}

}  // namespace pcavr::app
