// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_touch.hpp"

#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "calibrate_commands.hpp"
#include "calibration_outputs.hpp"

namespace pcavr::app {
namespace {

struct CalibrateTouchArguments {
  std::string points;
  CalibrationOutputOption output;
};

CommandResult describe_touch(const CalibrateTouchArguments& arguments, const TouchResult& found) {
  const Eigen::Vector3d& p = found.T_base_world.translation();
  const Eigen::Vector4d q = found.T_base_world.rotation().coeffs();
  CommandResult result;
  result.json = {
      {"calibration", arguments.output.file},
      {"points", found.residuals.size()},
      {"position", {p.x(), p.y(), p.z()}},
      {"rotation", {q[0], q[1], q[2], q[3]}},
      {"position_std", found.position_std.x()},
      {"rotation_std", {found.rotation_std.x(), found.rotation_std.y(), found.rotation_std.z()}},
      {"rms", found.rms},
      {"scale", found.scale},
      {"scale_std", found.scale_std},
      {"notes", found.notes}};
  for (const TouchedResidual& residual : found.residuals) {
    const Eigen::Vector3d& error = residual.error_base;
    result.json["residuals"].push_back(
        {{"point", residual.name}, {"error", {error.x(), error.y(), error.z()}}});
  }
  const UncertainText scale = uncertain(found.scale, found.scale_std);
  result.summary = fmt::format(
      "world in base: x {:.2f}, y {:.2f}, z {:.2f} mm; q {:.6f} {:.6f} {:.6f} {:.6f} (x y z w)\n"
      "the points' centre +- {} mm per axis, the rotation +- {} deg about the worst axis\n"
      "lengths in base over those in the world: {} +- {}\n",
      1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z(), q[0], q[1], q[2], q[3],
      readable(1e3 * found.position_std.x()),
      readable(180.0 / std::numbers::pi * found.rotation_std.maxCoeff()), scale.value, scale.std);
  result.summary += arguments.output.written_lines() +
                    fmt::format("a touch is good to {} mm per axis\n", readable(1e3 * found.rms));
  return result;
}

Expected<CommandResult> run_touch(const CalibrateTouchArguments& arguments,
                                  const Observer& observer) {
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.points});
  if (!outputs) return outputs.error();
  const Expected<std::vector<TouchedPoint>> points = read_touched_points(arguments.points);
  if (!points) return points.error();
  const Expected<TouchResult> found = calibrate_touch(*points);
  if (!found) {
    Error error = found.error();
    error.file = arguments.points;
    return error;
  }
  for (const std::string& note : found->notes) observer.on_warning(note);
  CommandResult result = describe_touch(arguments, *found);
  const Expected<void> done = outputs->commit(
      format_touch(*found, arguments.points), [&](const std::filesystem::path& folder) {
        return write_touch_report(*found, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_touch(CLI::App& calibrate, Action& action) {
  CLI::App* command = calibrate.add_subcommand(
      "touch", "Where a world is in the robot's base, from points that the tip touched");
  command->footer("Example:\n  pcavr calibrate touch points.csv -o base.yaml");
  auto arguments = std::make_shared<CalibrateTouchArguments>();
  command
      ->add_option("points", arguments->points,
                   "Table of points: x, y, z in the world, base_x, base_y, base_z of the tip")
      ->required();
  add_calibration_output(*command, arguments->output);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_touch(*arguments, observer); };
  });
}

}  // namespace pcavr::app
