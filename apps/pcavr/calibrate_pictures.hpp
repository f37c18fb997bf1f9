// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "pcavr/perception/board/picture_rig.hpp"
#include "pcavr/pipeline/calibrate.hpp"

#include "calibration_outputs.hpp"
#include "console.hpp"

namespace pcavr::app {

/// `calibrate hand-eye` from pictures of a board.
struct PictureRigArguments {
  PoseInput robot = {};
  std::string pictures, board, camera_file;
  std::string depth = {};       ///< images aligned to the pictures; empty: none
  double depth_scale = 1000.0;  ///< [units/m]
  CalibrationOutputOption output = {};
  HandEyeOptions hand_eye = {};
};
[[nodiscard]] Expected<CommandResult> run_picture_rig(const PictureRigArguments& arguments,
                                                      const Observer& observer);

/// Adds --board.
CLI::Option* add_board_option(CLI::App& command, std::string& board);
/// The file that the board was read from; empty where it was none.
[[nodiscard]] std::filesystem::path board_file(const Board& board);

/// A camera's parameters with stds, by name.
[[nodiscard]] nlohmann::ordered_json camera_json(const CameraModel& camera,
                                                 const std::vector<double>& stds);
[[nodiscard]] std::string camera_lines(const CameraModel& camera, const std::vector<double>& stds);

}  // namespace pcavr::app
