// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate_force.hpp"

#include "calibration_report.hpp"
#include "yaml_text.hpp"

namespace pcavr {
namespace {

void add_vector(const std::string& name, const Eigen::Vector3d& value, const Eigen::Vector3d& std,
                double factor, const char* unit, ReportTable& table) {
  for (int axis = 0; axis < 3; ++axis) {
    const UncertainText text = uncertain(factor * value[axis], factor * std[axis]);
    table.rows.push_back({name + ", " + "xyz"[axis], text.value, text.std, unit});
  }
}

ReportTable parameter_table(const ForceSensorResult& found) {
  ReportTable table{.title = "Sensor and load", .columns = {"quantity", "value", "± std", "unit"}};
  const UncertainText mass = uncertain(found.mass, found.mass_std);
  table.rows.push_back({"load's mass", mass.value, mass.std, "kg"});
  if (found.centre) {
    add_vector("load's centre", *found.centre, found.centre_std, 1e3, "mm", table);
  }
  add_vector("force at no load", found.force_bias, found.force_bias_std, 1.0, "N", table);
  if (found.centre) {
    add_vector("torque at no load", found.torque_bias, found.torque_bias_std, 1.0, "N m", table);
  }
  const Pose turn(found.R_sensor_flange, Eigen::Vector3d::Zero());
  add_vector("turn of the flange in the sensor, rotation vector", turn.log().tail<3>(),
             found.rotation_std, 180.0 / std::numbers::pi, "deg", table);
  return table;
}

ReportTable gain_table(const ForceSensorResult& found) {
  ReportTable table{.title = "Gains and cross-talk",
                    .columns = {"reading", "of a force in x (%)", "in y (%)", "in z (%)"},
                    .note = found.has_cross_talk
                                ? "The readings show more than a turn: gains or cross-talk."
                                : "Within the noise: a turned sensor explains the readings."};
  for (int row = 0; row < 3; ++row) {
    std::vector<std::string> cells{std::string(1, "xyz"[row])};
    for (int column = 0; column < 3; ++column) {
      const UncertainText text =
          uncertain(100.0 * found.gain(row, column), 100.0 * found.gain_std(row, column));
      cells.push_back(text.value + " ± " + text.std);
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Plot force_plot(const ForceSensorResult& found) {
  Plot plot{.title = "What the model leaves",
            .x_label = "pose in the order of the input",
            .y_label = "reading less model (N)"};
  for (int axis = 0; axis < 3; ++axis) {
    PlotSeries series{.label = std::string(1, "xyz"[axis]), .color = axis, .points = true};
    for (std::size_t i = 0; i < found.residuals.size(); ++i) {
      if (found.residuals[i].is_outlier) continue;
      series.x.push_back(static_cast<double>(i + 1));
      series.y.push_back(found.residuals[i].force[axis]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace

std::string format_force_sensor(const ForceSensorResult& found, const ForceInput& input) {
  std::string text = "format: pcavr-calibration/1\nkind: force\nsources:\n  poses: " +
                     quoted(input.poses.string()) + '\n';
  if (!input.forces.empty()) text += "  forces: " + quoted(input.forces.string()) + '\n';
  text +=
      "# reading = force_bias + sign * mass * R_sensor_flange * R_base_flange^T * gravity_base,\n"
      "# in the sensor's axes\n";
  text += std::string("axes: ") + (found.axes == ForceAxes::sensor ? "sensor" : "base") + '\n';
  text += std::string("sign: ") + (found.sign < 0.0 ? "-1" : "1") + '\n';
  text += "q_sensor_flange: " + number_list(found.R_sensor_flange.coeffs()) + "  # x y z w\n";
  text += "rotation_std: " + number_list(found.rotation_std) + "  # rad, about the flange's axes\n";
  text += "mass: " + shortest_decimal(found.mass) + "  # kg\n";
  text += "mass_std: " + shortest_decimal(found.mass_std) + '\n';
  text += "force_bias: " + number_list(found.force_bias) + "  # N\n";
  text += "force_bias_std: " + number_list(found.force_bias_std) + '\n';
  if (found.centre) {
    text += "centre: " + number_list(*found.centre) + "  # m, of the load in the sensor's axes\n";
    text += "centre_std: " + number_list(found.centre_std) + '\n';
    text += "torque_bias: " + number_list(found.torque_bias) + "  # N m\n";
    text += "torque_bias_std: " + number_list(found.torque_bias_std) + '\n';
  }
  text += "gain:  # readings over forces, in the sensor's axes\n";
  text += row_lists(found.gain, "  ");
  text += std::string("has_cross_talk: ") + (found.has_cross_talk ? "true" : "false") + '\n';
  text += "residual_rms: " + shortest_decimal(found.residual_rms) + "  # N per axis\n";
  text += "held_out_rms: " + shortest_decimal(found.held_out_rms) + "  # N per axis\n";
  return text;
}

Expected<void> write_force_report(const ForceSensorResult& found, const ForceReadings& input,
                                  const std::string& report_json,
                                  const std::filesystem::path& folder) {
  ReportPage page{.title = "Force sensor", .heading = "Force sensor"};
  page.inputs = {{{"poses: "}, {input.format, true}}};
  page.notes = input.notes;
  page.notes.insert(page.notes.end(), found.notes.begin(), found.notes.end());
  page.verdict = "The readings are " + describe_force_axes(found) + '.';
  page.headline = {.title = "Errors", .columns = {"metric", "value", "unit"}};
  page.headline.rows = {
      {"force, each pose by the others, rms per axis", readable(found.held_out_rms), "N"},
      {"force, fitted poses, rms per axis", readable(found.residual_rms), "N"},
      {"force, with readings in the other axes", readable(found.other_axes_rms), "N"}};
  if (found.centre) {
    page.headline.rows.push_back(
        {"torque, fitted poses, rms per axis", readable(found.torque_rms), "N m"});
  }
  PageSection section{.title = "Result"};
  section.blocks.emplace_back(std::vector<ReportTable>{parameter_table(found), gain_table(found)});
  section.blocks.emplace_back(PlotGroup{"", {force_plot(found)}});
  page.sections.push_back(std::move(section));
  return write_calibration_report(std::move(page),
                                  "Std: standard deviation, by the noise that the residuals show.",
                                  report_json, folder);
}

}  // namespace pcavr
