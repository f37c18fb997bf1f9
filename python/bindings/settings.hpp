// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/results/evaluation/options.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

namespace pcavr::python {

/// The options of the commands that Python calls, under the names of their configuration files.
struct Settings {
  ReadOptions reading;
  BuildOptions build;  ///< its `perception` applies to all calls
  TeleopOptions teleop;
  EvaluationOptions evaluation;
  PlanOptions plan;
  EstimatorOptions<3> estimator;
  RobotIdentificationOptions robot;

  /// Sets the options of a dict from "section.key" to number or bool; None: no change. Raises
  /// pcavr.Error for unknown names and values out of range.
  void set(const pybind11::object& options);

  [[nodiscard]] std::vector<OptionSection> sections();
  /// "section.key" and value of what differs from the defaults, for the manifests of outputs.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> changed();

  /// The segmentation is that of online identification, as in the command.
  [[nodiscard]] TeleopOptions replayed() const;
  [[nodiscard]] IdentificationOptions identification() const;
};

}  // namespace pcavr::python
