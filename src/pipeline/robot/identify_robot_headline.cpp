// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_robot_headline.hpp"

#include <numbers>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "pipeline/identify/identify_plots.hpp"

namespace pcavr {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// Held-out torque errors over the torques.
struct TorqueErrors {
  double median = 0.0;
  double largest = 0.0;
  std::string worst;  ///< joint
};

TorqueErrors torque_errors(const RobotFit& fit) {
  TorqueErrors errors;
  std::vector<double> all;
  for (const JointFit& joint : fit.joints) {
    all.push_back(joint.held_out.relative);
    if (errors.worst.empty() || joint.held_out.relative > errors.largest) {
      errors.largest = joint.held_out.relative;
      errors.worst = joint.name;
    }
  }
  errors.median = median(std::move(all));
  return errors;
}

std::string per_cent(double share) { return readable(share * kPercent); }

}  // namespace

std::string robot_verdict(const RobotIdentification& found) {
  const TorqueErrors errors = torque_errors(found.fit);
  return fmt::format(
      "The fitted torques are {} % off on the held-out part at the median joint, {} % at the "
      "worst, {}. The bodies found are {}physically possible.",
      per_cent(errors.median), per_cent(errors.largest), errors.worst,
      found.fit.is_physical ? "" : "not ");
}

ReportTable robot_headline(const RobotIdentification& found) {
  const RobotFit& fit = found.fit;
  const TorqueErrors errors = torque_errors(fit);
  ReportTable table{.title = "Main figures", .columns = {"metric", "value", "unit"}};
  table.rows = {
      {"Torque error, held out, median of the joints", per_cent(errors.median), "%"},
      {"Torque error, held out, worst joint, " + errors.worst, per_cent(errors.largest), "%"}};
  if (found.replay.simulated.is_finite) {
    table.rows.push_back({"Position after 1 s of recorded torques, worst joint",
                          readable(found.replay.after_1s.cwiseAbs().maxCoeff() * kDegreesPerRadian),
                          "deg"});
  }
  if (found.contacts) {
    table.rows.push_back({"Smallest force on the tip that is found, median of axes and rows",
                          readable(found.contacts->usual_detectable_force), "N"});
  }
  table.rows.push_back(
      {"Base parameters excited",
       fmt::format("{} of {}", fit.excited_base_parameters(), fit.base_parameters.size()), ""});
  return table;
}

}  // namespace pcavr
