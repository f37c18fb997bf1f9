// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "configuration.hpp"
#include "console.hpp"

namespace pcavr::app {

/// Each adds one subcommand with its options, which sets `action` when it is invoked. The
/// configuration has to outlive the action.
void add_build(CLI::App& app, Configuration& configuration, Action& action);
void add_survey(CLI::App& app, Configuration& configuration, Action& action);
void add_fuse(CLI::App& app, Configuration& configuration, Action& action);
void add_replay(CLI::App& app, Configuration& configuration, Action& action);
void add_evaluate(CLI::App& app, Configuration& configuration, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_identify(CLI::App& app, Configuration& configuration, Action& action);
void add_predict(CLI::App& app, Configuration& configuration, Action& action);
void add_import(CLI::App& app, Action& action);
void add_calibrate(CLI::App& app, Action& action);
void add_export(CLI::App& app, Configuration& configuration, Action& action);
void add_serve(CLI::App& app, Configuration& configuration, Action& action);
void add_inspect(CLI::App& app, const Configuration& configuration, Action& action);
void add_doctor(CLI::App& app, const Configuration& configuration, Action& action);
void add_record(CLI::App& app, Configuration& configuration, Action& action);
void add_tags(CLI::App& app, Action& action);
void add_keygen(CLI::App& app, Action& action);
void add_robot_site(CLI::App& app, Configuration& configuration, Action& action);
void add_operator_site(CLI::App& app, Configuration& configuration, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_status(CLI::App& app, Action& action);
void add_gather(CLI::App& app, Action& action);

/// The options that several subcommands share.
struct OutputOption {
  std::string folder;
  bool replace = false;
};
void add_output_option(CLI::App& command, OutputOption& output, const std::string& what);
/// Adds --sensor: the camera file with the sensor's depth noise.
void add_sensor_option(CLI::App& command, std::string& camera_file);
/// The depth noise in that file; `configured` where no file is given, an Error where it has none.
[[nodiscard]] Expected<DepthNoise> depth_noise_of(const std::string& camera_file,
                                                  const DepthNoise& configured);
void add_threads_option(CLI::App& command, int& threads);

/// Reads a recording, and reports its warnings: lines that may be truncated, and skipped rows.
[[nodiscard]] Expected<Recording> read_with_warnings(const std::string& folder, bool skip_bad,
                                                     const Configuration& configuration,
                                                     const Observer& observer);
/// Adds the skipped rows of the recording's files, by file and reason, to summary and JSON.
void describe_left_out(const std::vector<SkippedRows>& left_out, CommandResult& result);

}  // namespace pcavr::app
