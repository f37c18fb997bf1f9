// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "pcavr/robots/calibration/clock_offset.hpp"
#include "pcavr/robots/calibration/force_sensor.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"
#include "pcavr/robots/calibration/touched_points.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "interruptible.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr int kMaxSplits = 1000;  ///< more change the third digit only

std::string row_name(const char* argument, std::size_t row) {
  return fmt::format("{}[{}]", argument, row);
}

/// The rows of an array (N, columns); of another number of rows than `count` it is an Error.
Numbers rows_of(const py::handle& argument, const char* name, py::ssize_t columns,
                py::ssize_t count = kAnySize) {
  return numbers_of(argument, name, {count, columns});
}

std::vector<Pose> pose_rows_of(const py::handle& argument, const char* name,
                               py::ssize_t count = kAnySize) {
  const Numbers rows = rows_of(argument, name, 7, count);
  std::vector<Pose> poses;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    poses.push_back(pose_of(rows.attr("__getitem__")(i), row_name(name, poses.size())));
  }
  return poses;
}

Eigen::Vector3d vector_at(const Numbers& rows, py::ssize_t row, py::ssize_t column = 0) {
  return Eigen::Vector3d::Map(rows.data() + row * rows.shape(1) + column);
}

template <int Rows, int Columns>
Numbers array_of_fixed(const Eigen::Matrix<double, Rows, Columns>& matrix) {
  Numbers array({static_cast<py::ssize_t>(Rows), static_cast<py::ssize_t>(Columns)});
  Eigen::Map<Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>>(array.mutable_data()) = matrix;
  return array;
}

// Camera and board

HandEyeResult hand_eye(const py::object& flange, const py::object& board,
                       const std::string& camera_on, int splits, std::uint64_t seed) {
  HandEyeOptions options{.splits = splits, .seed = seed};
  if (camera_on != "arm" && camera_on != "base") {
    raise_error({.message = "'" + camera_on + "' carries no camera",
                 .place = "camera_on",
                 .hint = "give 'arm' (on the flange) or 'base' (beside the arm)"});
  }
  if (camera_on == "base") options.mount = CameraMount::base;
  if (splits < 0 || splits > kMaxSplits) {
    raise_error(
        {.message = fmt::format("{} is not from 0 to {}", splits, kMaxSplits), .place = "splits"});
  }
  const std::vector<Pose> T_base_flange = pose_rows_of(flange, "flange");
  const std::vector<Pose> T_camera_board =
      pose_rows_of(board, "board", static_cast<py::ssize_t>(T_base_flange.size()));
  std::vector<HandEyeView> views;
  for (std::size_t i = 0; i < T_base_flange.size(); ++i) {
    views.push_back({row_name("view", i), T_base_flange[i], T_camera_board[i]});
  }
  return run_interruptible(py::none(), [&](const Observer&) -> Expected<HandEyeResult> {
    Expected<HandEyeResult> found = calibrate_hand_eye(views, options);
    if (found) return found;
    Error error = found.error();
    if (error.place == "ROBOT") error.place = "flange";
    if (error.place == "CAMERA") error.place = "board";
    return error;
  });
}

/// NaN where the motion does not show the coordinate.
Eigen::Vector3d position_std_of(const CalibratedPose& pose) {
  Eigen::Vector3d std;
  for (int axis = 0; axis < 3; ++axis) {
    std[axis] = pose.position_std[axis].value_or(std::numeric_limits<double>::quiet_NaN());
  }
  return std;
}

std::vector<std::size_t> outliers_of(const HandEyeResult& found) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < found.residuals.size(); ++i) {
    if (found.residuals[i].is_outlier) rows.push_back(i);
  }
  return rows;
}

void bind_hand_eye(py::module_& module) {
  py::class_<CalibratedPose>(module, "CalibratedPose", "A pose with its standard deviations.")
      .def_property_readonly(
          "pose", [](const CalibratedPose& self) { return array_of(self.T_a_b); },
          "(7,) x y z [m] qx qy qz qw.")
      .def_property_readonly(
          "position_std",
          [](const CalibratedPose& self) { return array_of(position_std_of(self)); },
          "(3,) [m] in the axes of the frame that the pose is in; NaN: the views do not show it.")
      .def_property_readonly(
          "rotation_std", [](const CalibratedPose& self) { return array_of(self.rotation_std); },
          "(3,) [rad] about the same axes.");
  py::class_<HandEyeResult>(module, "HandEye", "Where a camera and a board are.")
      .def_readonly("camera", &HandEyeResult::camera,
                    "The camera in the flange's frame; in base where it stands.")
      .def_readonly("board", &HandEyeResult::board,
                    "The board in base; in the flange's frame where the camera stands.")
      .def_readonly("position_rms", &HandEyeResult::position_rms,
                    "[m] of the board's position in the views that were fitted.")
      .def_readonly("rotation_rms", &HandEyeResult::rotation_rms, "[rad] of its rotation in these.")
      .def_readonly("leave_one_out_rms", &HandEyeResult::leave_one_out_rms,
                    "[m] of its position in each view, by the other views.")
      .def_readonly("held_out_rms", &HandEyeResult::held_out_rms,
                    "[m] over random splits, in the third that is not fitted; None: too few views.")
      .def_readonly("board_scale", &HandEyeResult::board_scale,
                    "True lengths over those of the board that were given.")
      .def_readonly("board_scale_std", &HandEyeResult::board_scale_std, "Of board_scale.")
      .def_property_readonly("outliers", &outliers_of, "Rows of the views that were left out.")
      .def_property_readonly(
          "cause", [](const HandEyeResult& self) { return describe_cause(self); },
          "A sentence: whether camera or arm causes the residuals, and what would help.")
      .def_property_readonly(
          "next_pose",
          [](const HandEyeResult& self) {
            return self.next ? std::optional(self.next->text) : std::nullopt;
          },
          "The further view that would reduce the standard deviations most; None: none would.")
      .def_readonly("notes", &HandEyeResult::notes, "Lines for the user.");
  module.def(
      "calibrate_hand_eye", &hand_eye, py::arg("flange"), py::arg("board"), py::kw_only(),
      py::arg("camera_on") = "arm", py::arg("splits") = 50, py::arg("seed") = 1,
      R"(Finds a camera on an arm, or beside it, from views of a board, as `calibrate hand-eye`.

flange     (N, 7) poses of the arm's flange in base, a row for each view
board      (N, 7) poses of the board in the camera in these views
camera_on  'arm': the camera is on the flange, the board stands; 'base': the other way about
splits     number of random splits for held_out_rms
seed       of the splits

Returns HandEye. Releases the GIL. Raises Error for poses that do not fit each other, with what they
would fit as (inverted, another unit, mirrored), for parallel ones, and for fewer than three.)");
}

// Clocks

ClockOffset clock_offset(const py::object& a, const py::object& b, bool drift) {
  std::vector<PoseStream> streams;
  for (const auto& [argument, name] : {std::pair{&a, "a"}, {&b, "b"}}) {
    streams.push_back(clean_stream(name, trajectory_of(*argument, name).poses()));
  }
  return run_interruptible(py::none(), [&](const Observer&) -> Expected<ClockOffset> {
    return estimate_clock_offset(streams[0], streams[1], {.is_drift_estimated = drift});
  });
}

void bind_clocks(py::module_& module) {
  py::class_<ClockOffset>(module, "ClockOffset", "The clock of stream b against that of stream a.")
      .def_readonly("offset", &ClockOffset::offset, "[s] to add to b's times.")
      .def_readonly("std", &ClockOffset::std, "[s] of the offset.")
      .def_readonly("drift", &ClockOffset::drift,
                    "Seconds a second of b's clock against a's; None: too short to show it.")
      .def_readonly("drift_std", &ClockOffset::drift_std, "Of the drift.")
      .def_property_readonly(
          "step",
          [](const ClockOffset& clock) -> std::optional<std::tuple<double, double, double>> {
            if (!clock.step) return std::nullopt;
            return std::tuple(clock.step->at, clock.step->size, clock.step->std);
          },
          "b's time [s] from which on the offset is larger, by what [s], and the std of that;\n"
          "None: no clock was set.")
      .def_readonly("explained", &ClockOffset::explained, "Part of a's motion that b's explains.")
      .def_readonly("overlap", &ClockOffset::overlap, "[s] in which both move.")
      .def_readonly("is_observable", &ClockOffset::is_observable,
                    "False: the motion does not show the offset, and reason states why.")
      .def_readonly("reason", &ClockOffset::reason, "Why it is not observable.")
      .def("corrected", &ClockOffset::corrected, py::arg("t"), "b's time t [s] on a's clock.");
  module.def("calibrate_clocks", &clock_offset, py::arg("a"), py::arg("b"), py::kw_only(),
             py::arg("drift") = true,
             R"(Finds the offset and drift of two clocks, as `calibrate clocks`.

a, b   (t, poses): (N,) s in ascending order and (N, 7), two streams of poses of one rigid body; their
       frames may differ by any fixed turn and shift at either side
drift  False: both clocks run at one rate

Returns ClockOffset. Releases the GIL.)");
}

// Force sensor

bool has_columns(const py::object& argument, py::ssize_t columns) {
  const py::array array = py::array::ensure(argument);
  if (!array) PyErr_Clear();
  return array && array.ndim() == 2 && array.shape(1) == columns;
}

ForceSensorResult force_sensor(const py::object& flange, const py::object& wrench,
                               const py::object& up) {
  const std::vector<Pose> T_base_flange = pose_rows_of(flange, "flange");
  const auto count = static_cast<py::ssize_t>(T_base_flange.size());
  const bool has_torque = has_columns(wrench, 6);
  const Numbers rows = rows_of(wrench, "wrench", has_torque ? 6 : 3, count);
  std::vector<ForceReading> readings;
  for (std::size_t i = 0; i < T_base_flange.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    readings.push_back({.name = row_name("pose", i),
                        .R_base_flange = T_base_flange[i].rotation(),
                        .force = vector_at(rows, row)});
    if (has_torque) readings.back().torque = vector_at(rows, row, 3);
  }
  const ForceSensorOptions options{.up_base = vector_of(up, "up")};
  if (options.up_base.norm() == 0.0) {
    raise_error({.message = "has no direction", .place = "up"});
  }
  return run_interruptible(
      py::none(), [&](const Observer&) { return calibrate_force_sensor(readings, options); });
}

void bind_force_sensor(py::module_& module) {
  py::class_<ForceSensorResult> result(module, "ForceSensor",
                                       "What a force sensor reads without a contact.");
  const auto vector = [&result](const char* name, Eigen::Vector3d ForceSensorResult::*member,
                                const char* text) {
    result.def_property_readonly(
        name, [member](const ForceSensorResult& self) { return array_of(self.*member); }, text);
  };
  result.def_readonly("mass", &ForceSensorResult::mass, "[kg] that hangs on the sensor.")
      .def_readonly("mass_std", &ForceSensorResult::mass_std, "[kg]")
      .def_property_readonly(
          "rotation",
          [](const ForceSensorResult& self) {
            return array_of_fixed<3, 3>(self.R_sensor_flange.toRotationMatrix());
          },
          "(3, 3): from the flange's axes to the sensor's.")
      .def_property_readonly(
          "axes",
          [](const ForceSensorResult& self) {
            return self.axes == ForceAxes::sensor ? "sensor" : "base";
          },
          "Whose axes the readings are in: 'sensor' or 'base'.")
      .def_readonly("sign", &ForceSensorResult::sign,
                    "1.0: the weight is read as it pulls; -1.0: reversed.")
      .def_property_readonly(
          "centre",
          [](const ForceSensorResult& self) {
            return self.centre ? std::optional(array_of(*self.centre)) : std::nullopt;
          },
          "(3,) [m] of the load's centre in the sensor's frame; None without torques.")
      .def_property_readonly(
          "gain", [](const ForceSensorResult& self) { return array_of_fixed<3, 3>(self.gain); },
          "(3, 3): readings over true forces; the identity but for gains and cross-talk.")
      .def_readonly("residual_rms", &ForceSensorResult::residual_rms,
                    "[N] per axis, in the poses that were fitted.")
      .def_readonly("held_out_rms", &ForceSensorResult::held_out_rms,
                    "[N] per axis, each pose by the others.")
      .def_property_readonly(
          "description", [](const ForceSensorResult& self) { return describe_force_axes(self); },
          "A sentence: which axis of the flange each axis of the sensor reads.")
      .def_readonly("notes", &ForceSensorResult::notes, "Lines for the user.");
  vector("rotation_std", &ForceSensorResult::rotation_std, "(3,) [rad] about the flange's axes.");
  vector("force_bias", &ForceSensorResult::force_bias, "(3,) [N] without a load.");
  vector("force_bias_std", &ForceSensorResult::force_bias_std, "(3,) [N]");
  vector("torque_bias", &ForceSensorResult::torque_bias, "(3,) [N m]; zeros without torques.");
  module.def(
      "calibrate_force", &force_sensor, py::arg("flange"), py::arg("wrench"), py::kw_only(),
      py::arg("up") = py::make_tuple(0.0, 0.0, 1.0),
      R"(Finds a force sensor's bias, load, turn and sign from poses at rest, as `calibrate force`.

flange  (N, 7) poses of the arm's flange in base, nothing touching the load
wrench  (N, 3) force [N], or (N, 6) force and torque [N m], that the sensor reads in these poses
up      (3,) against gravity, in base

Returns ForceSensor. Releases the GIL. Raises Error where the readings do not change with the pose,
where the orientations do not show all three axes, and where no model fits.)");
}

// Touched points

TouchResult touch(const py::object& world, const py::object& base) {
  const Numbers p_world = rows_of(world, "world", 3);
  const Numbers p_base = rows_of(base, "base", 3, p_world.shape(0));
  std::vector<TouchedPoint> points;
  for (py::ssize_t i = 0; i < p_world.shape(0); ++i) {
    points.push_back(
        {row_name("point", points.size()), vector_at(p_world, i), vector_at(p_base, i)});
  }
  return value_of(calibrate_touch(points));
}

void bind_touch(py::module_& module) {
  py::class_<TouchResult>(module, "Touch", "Where a world is in the robot's base.")
      .def_property_readonly(
          "pose", [](const TouchResult& self) { return array_of(self.T_base_world); },
          "(7,) of the world in base.")
      .def_property_readonly(
          "position_std", [](const TouchResult& self) { return array_of(self.position_std); },
          "(3,) [m] of the points' centre, in base axes.")
      .def_property_readonly(
          "rotation_std", [](const TouchResult& self) { return array_of(self.rotation_std); },
          "(3,) [rad] about the base's axes.")
      .def_readonly("rms", &TouchResult::rms, "[m] per axis: what a touch is good to.")
      .def_readonly("scale", &TouchResult::scale, "Lengths in base over lengths in the world.")
      .def_readonly("scale_std", &TouchResult::scale_std, "Of the scale.")
      .def_readonly("notes", &TouchResult::notes, "Lines for the user.");
  module.def("calibrate_touch", &touch, py::arg("world"), py::arg("base"),
             R"(Finds where a world is from points that the tip touched, as `calibrate touch`.

world  (N, 3) [m] points in the world
base   (N, 3) [m] the tip's centre in base at each of them

Returns Touch. Raises Error for points on a line, and for those that fit only mirrored.)");
}

}  // namespace

void bind_calibration(py::module_& module) {
  bind_hand_eye(module);
  bind_clocks(module);
  bind_force_sensor(module);
  bind_touch(module);
}

}  // namespace pcavr::python
