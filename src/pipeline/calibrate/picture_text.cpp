// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <span>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/pipeline/calibrate_pictures.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"

#include "pipeline/calibrate/yaml_text.hpp"

namespace pcavr {
namespace {

template <typename Values>
std::string decimals(const Values& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + shortest_decimal(value);
  return text;
}

std::string camera_block(const CameraModel& camera, std::span<const double> stds) {
  std::string text = "camera:\n";
  text += fmt::format("  width: {}\n  height: {}\n", camera.width, camera.height);
  const std::array<double, 4> values{camera.fx, camera.fy, camera.cx, camera.cy};
  constexpr std::array<const char*, 4> kNames{"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < 4; ++i) {
    text += fmt::format("  {}: {}  # px, std {:.3g}\n", kNames[i], shortest_decimal(values[i]),
                        stds[i]);
  }
  text += fmt::format("  model: {}\n  distortion: {}  # {}\n", name_of(camera.distortion.model()),
                      '[' + decimals(camera.distortion.coefficients()) + ']',
                      coefficient_names(camera.distortion.model()));
  text +=
      "camera_std: [" + decimals(stds) + "]  # fx, fy, cx, cy (px), distortion; 0: not estimated\n";
  return text;
}

std::string pcavr_camera(const CameraCalibration& found, const std::string& pictures,
                         const Board& board) {
  std::string text = "format: pcavr-calibration/1\nkind: camera\n";
  text += "sources:\n  pictures: " + quoted(pictures) + "\n  board: " + quoted(board.source) + '\n';
  text += camera_block(found.camera, found.stds);
  text += "covariance:  # of the same parameters\n";
  text += row_lists(found.covariance, "  ");
  text += "pixel_rms: " + shortest_decimal(found.pixel_rms) + "  # px, of distances\n";
  if (found.held_out_rms) {
    text += "held_out_rms: " + shortest_decimal(*found.held_out_rms) + "  # px\n";
  }
  return text + fmt::format("views: {}\n", found.views.size());
}

/// camera_calibration's file, which image_transport's drivers read (ost.yaml).
std::string ros_camera(const CameraModel& camera) {
  const LensModel lens = camera.distortion.model();
  const char* name = lens == LensModel::rational  ? "rational_polynomial"
                     : lens == LensModel::fisheye ? "equidistant"
                                                  : "plumb_bob";
  const auto matrix = [](const char* key, int rows, int columns, const std::string& data) {
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", key, rows, columns, data);
  };
  const std::array<double, 9> k{camera.fx, 0.0, camera.cx, 0.0, camera.fy,
                                camera.cy, 0.0, 0.0,       1.0};
  const std::array<double, 12> p{camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy,
                                 camera.cy, 0.0, 0.0,       0.0, 1.0, 0.0};
  const auto coefficients = camera.distortion.coefficients();
  std::string text = fmt::format("{}\nimage_width: {}\nimage_height: {}\ncamera_name: camera\n",
                                 kForeignCalibration, camera.width, camera.height);
  text += matrix("camera_matrix", 3, 3, decimals(k));
  text += fmt::format("distortion_model: {}\n", name);
  text += matrix("distortion_coefficients", 1, static_cast<int>(coefficients.size()),
                 decimals(coefficients));
  text += matrix("rectification_matrix", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1");
  return text + matrix("projection_matrix", 3, 4, decimals(p));
}

/// cv::FileStorage, with the keys of OpenCV's own calibration program.
std::string opencv_camera(const CameraCalibration& found) {
  const CameraModel& camera = found.camera;
  const auto matrix = [](const char* key, int rows, int columns, const std::string& data) {
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                       key, rows, columns, data);
  };
  const std::array<double, 9> k{camera.fx, 0.0, camera.cx, 0.0, camera.fy,
                                camera.cy, 0.0, 0.0,       1.0};
  const auto coefficients = camera.distortion.coefficients();
  std::string text = fmt::format("%YAML:1.0\n{}\n---\nimage_width: {}\nimage_height: {}\n",
                                 kForeignCalibration, camera.width, camera.height);
  if (camera.distortion.model() == LensModel::fisheye) text += "fisheye_model: 1\n";
  text += matrix("camera_matrix", 3, 3, decimals(k));
  text += matrix("distortion_coefficients", static_cast<int>(coefficients.size()), 1,
                 decimals(coefficients));
  return text + "avg_reprojection_error: " + shortest_decimal(found.pixel_rms) + '\n';
}

Expected<std::string> kalibr_camera(const CameraModel& camera) {
  const auto coefficients = camera.distortion.coefficients();
  const LensModel lens = camera.distortion.model();
  const bool has_k3 = lens == LensModel::plumb_bob && coefficients[4] != 0.0;
  if (lens == LensModel::rational || has_k3) {
    return Error{.message = "Kalibr has no lens with these coefficients",
                 .hint = "leave out --k3, or give --lens plumb_bob or --lens fisheye"};
  }
  const std::array<double, 4> pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  return fmt::format(
      "{}\ncam0:\n  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: {}\n"
      "  distortion_coeffs: [{}]\n  resolution: [{}, {}]\n  rostopic: /camera/image_raw\n",
      kForeignCalibration, decimals(pinhole), lens == LensModel::fisheye ? "equidistant" : "radtan",
      decimals(coefficients.subspan(0, 4)), camera.width, camera.height);
}

std::string pose_row(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Vector4d q = pose.rotation().coeffs();
  return '[' + decimals(p) + ", " + decimals(q) + ']';
}

}  // namespace

Expected<std::string> format_camera(const CameraCalibration& found, const std::string& pictures,
                                    const Board& board, CameraFormat format) {
  switch (format) {
    case CameraFormat::ros:
      return ros_camera(found.camera);
    case CameraFormat::opencv:
      return opencv_camera(found);
    case CameraFormat::kalibr:
      return kalibr_camera(found.camera);
    case CameraFormat::pcavr:
      break;
  }
  return pcavr_camera(found, pictures, board);
}

std::string format_picture_rig(const PictureRig& found, const PoseInput& robot,
                               const std::string& pictures, const Board& board) {
  std::string text = format_hand_eye(found.hand_eye, robot, {.path = pictures});
  text += "board: " + quoted(board.source) + '\n';
  if (found.is_camera_estimated) text += camera_block(found.camera, found.camera_stds);
  text += "pixel_noise: " + shortest_decimal(found.pixel_noise) + "  # px, std of a coordinate\n";
  text += "arm_position_std: " + shortest_decimal(found.arm_position_std) +
          "  # m, of a coordinate of the flange\n";
  text +=
      "arm_rotation_std: " + shortest_decimal(found.arm_rotation_std) + "  # rad, about an axis\n";
  text += "pictures:  # x y z (m), qx qy qz qw; as picture and arm show them together\n";
  for (const PictureResidual& view : found.views) {
    text += "  - {view: " + quoted(view.view) + ", T_base_camera: " + pose_row(view.T_base_camera) +
            ", T_base_flange: " + pose_row(view.T_base_flange) + "}\n";
  }
  return text;
}

}  // namespace pcavr
