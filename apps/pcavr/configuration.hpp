// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/results/evaluation/options.hpp"
#include "pcavr/robots/arm/arm_queries.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"
#include "pcavr/teleoperation/devices/open_device.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"
#include "pcavr/teleoperation/record/recorder.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

namespace pcavr::app {

/// The options of all modules, which every command accepts in one file. Options of the command line
/// refer to the same fields, and win over the file.
struct Configuration {
  ReadOptions reading;
  BuildOptions build;  ///< its `perception` applies to all commands
  TeleopOptions
      teleop;  ///< its `world` and `unknown_objects` apply to serve, its `inputs` to identify, too
  SceneWorldOptions serve;
  LiveWorldOptions live;
  ContentOptions content;
  ServerOptions network;
  RemoteDeviceOptions page;
  DeviceOptions devices;
  EvaluationOptions evaluation;
  PlanOptions plan;               ///< of identify --plan
  EstimatorOptions<3> estimator;  ///< of the comparison in identify's report
  RobotIdentificationOptions robot_identification;
  ArmFollowerOptions arm;  ///< with the options of its inverse kinematics
  DrivenArmOptions arm_drive;
  ArmQueryOptions arm_query;  ///< its drive is arm_drive
  RobotSiteOptions robot_site;
  OperatorSiteOptions operator_site;
  BlackBoxOptions black_box;
  RecorderOptions recorder;

  [[nodiscard]] PerceptionOptions& perception() { return build.perception; }
  [[nodiscard]] const PerceptionOptions& perception() const { return build.perception; }

  /// Options of `identify`: the sections that the robot's site uses to identify online.
  [[nodiscard]] IdentificationOptions identification() const;
  /// Options of `replay`: the segmentation is that of online identification.
  [[nodiscard]] TeleopOptions replayed() const;

  /// They refer to this object.
  [[nodiscard]] std::vector<OptionSection> sections();
  /// Those that a command uses, by its full name ("pcavr identify robot"); all for the program.
  [[nodiscard]] std::vector<OptionSection> sections_of_command(std::string_view command);
  /// "section.key" and value of what differs from the defaults, for the manifests of outputs.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> changed();
};

/// --config and --print-config.
struct ConfigurationOptions {
  bool is_printed = false;
  std::optional<Error> error = {};  ///< of the file
};

/// Adds both options to all commands. The file is read where --config is parsed: before the values
/// of the command's options are set, wherever they stand.
void add_configuration_options(CLI::App& app, Configuration& configuration,
                               ConfigurationOptions& options);

}  // namespace pcavr::app
