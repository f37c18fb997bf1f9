// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "command_arguments.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "settings.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

namespace fs = std::filesystem;

/// A log of joints with the name that errors give it: its file, or the argument's.
struct LogArgument {
  JointLog log;
  std::string name;
  bool is_array = false;

  /// An error of the log, by the argument's row instead of a file's line.
  [[nodiscard]] Error in_argument(Error error) const {
    if (!is_array || error.file != name) return error;
    const std::string row = error.line > 0 ? '[' + std::to_string(error.line - 1) + ']' : "";
    error.place = name + row + (error.place.empty() ? "" : ": " + error.place);
    error.file.clear();
    error.line = 0;
    return error;
  }
};

/// (N, dof) numbers as a matrix.
Eigen::MatrixXd matrix_of(const py::handle& argument, const std::string& name, py::ssize_t rows,
                          py::ssize_t columns) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Numbers numbers = numbers_of(argument, name, {rows, columns});
  return RowMajor::Map(numbers.data(), rows, columns);
}

std::vector<std::string> joints_of(const RobotModel& model) {
  std::vector<std::string> names;
  for (const std::size_t joint : model.coordinate_joints()) {
    names.push_back(model.joints[joint].name);
  }
  return names;
}

/// A triple (t, q, tau), with the joints in the model's order.
LogArgument log_of_arrays(const py::sequence& triple, const std::string& name,
                          const RobotModel& model) {
  const auto dof = static_cast<py::ssize_t>(model.dof);
  const TimedRows positions = timed_rows_of(py::make_tuple(triple[0], triple[1]), name, {dof});
  const auto count = static_cast<py::ssize_t>(positions.stamps.size());
  LogArgument argument{{}, name, true};
  JointLog& log = argument.log;
  log.joints = joints_of(model);
  log.stamps = positions.stamps;
  for (py::ssize_t i = 0; i < count; ++i) {
    log.t.push_back(to_seconds(log.stamps[static_cast<std::size_t>(i)] - log.stamps.front()));
    log.lines.push_back(static_cast<int>(i + 1));
  }
  log.position = matrix_of(positions.rows, name + " q", count, dof);
  log.torque = matrix_of(triple[2], name + " tau", count, dof);
  return argument;
}

LogArgument log_of(const py::object& argument, const std::string& name, const RobotModel& model,
                   bool skip_bad) {
  if (py::isinstance<py::tuple>(argument) || py::isinstance<py::list>(argument)) {
    if (py::len(argument) != 3) {
      throw py::type_error(name + ": a triple (t, q, tau) or a path is expected");
    }
    return log_of_arrays(py::reinterpret_borrow<py::sequence>(argument), name, model);
  }
  const fs::path file = path_of(argument, name);
  return {value_of(read_joint_log(file, skip_bad)), file.string(), false};
}

RobotIdentification identify_arm(const py::object& urdf, const py::object& log,
                                 const py::object& loaded, const std::vector<double>& gains,
                                 bool known_body, const std::vector<fs::path>& packages,
                                 bool skip_bad, const py::object& options) {
  Settings settings;
  settings.set(options);
  settings.robot.gains = gains;
  settings.robot.fit.known_body |= known_body;
  const RobotModel model =
      value_of(read_urdf(path_of(urdf, "urdf"), {.package_folders = packages}));
  LogArgument fitted = log_of(log, "log", model, skip_bad);
  std::optional<LogArgument> with_load;
  if (!loaded.is_none()) with_load = log_of(loaded, "loaded", model, skip_bad);
  return run_interruptible(
      py::none(), [&](const Observer& observer) -> Expected<RobotIdentification> {
        Expected<RobotIdentification> found =
            identify_robot(std::move(fitted.log), model, settings.robot, fitted.name);
        if (!found) return fitted.in_argument(found.error());
        if (with_load) {
          const Expected<void> added = add_payload(std::move(with_load->log), settings.robot,
                                                   with_load->name, model, *found);
          if (!added) return with_load->in_argument(added.error());
        }
        for (const Error& warning : found->warnings) {
          observer.on_warning(fitted.in_argument(warning).to_string());
        }
        found->configuration = settings.changed();
        return found;
      });
}

/// A dict from the terms' names to (value, std).
py::dict terms_of(const std::vector<FittedTerm>& terms) {
  py::dict table;
  for (const FittedTerm& term : terms) {
    table[name_of(term.term)] = py::make_tuple(term.value, term.std);
  }
  return table;
}

void bind_joint(py::module_& module) {
  py::class_<JointFit>(module, "IdentifiedJoint", "A joint's friction, and its torque's errors.")
      .def_readonly("name", &JointFit::name, "Of the joint.")
      .def_property_readonly(
          "friction", [](const JointFit& self) { return terms_of(self.friction); },
          "A dict from the names of the terms that were used to (value, std): viscous [N m "
          "s/rad],\n"
          "coulomb and offset [N m], and others that the data asked for.")
      .def_property_readonly(
          "equivalent", [](const JointFit& self) { return terms_of(self.equivalent); },
          "The same as offset, viscous and Coulomb friction alone, nearest to the fitted curve;\n"
          "empty for a joint at rest.")
      .def_property_readonly(
          "held_out_rms", [](const JointFit& self) { return self.held_out.rms; },
          "[N m] error of the torque in rows that were not fitted.")
      .def_property_readonly(
          "held_out_relative", [](const JointFit& self) { return self.held_out.relative; },
          "The same over the torque's rms.");
}

void bind_bodies(py::module_& module) {
  py::class_<BaseParameter>(module, "BaseParameter",
                            "A combination of inertial parameters that the torques determine.")
      .def_readonly("name", &BaseParameter::name, "The combination.")
      .def_readonly("value", &BaseParameter::value, "In SI units.")
      .def_readonly("std", &BaseParameter::std, "Of the value.")
      .def_readonly("is_excited", &BaseParameter::is_excited,
                    "False: the motion shows no more than the description.");
  py::class_<Payload>(module, "Payload", "What the arm carries in one log and not in the other.")
      .def_readonly("mass", &Payload::mass, "[kg]")
      .def_readonly("mass_std", &Payload::mass_std, "[kg]")
      .def_property_readonly(
          "centre", [](const Payload& self) { return array_of(self.centre_of_mass); },
          "(3,) [m] of its centre of mass in the frame of the last joint's link.")
      .def_property_readonly(
          "centre_std", [](const Payload& self) { return array_of(self.centre_of_mass_std); },
          "(3,) [m]");
}

void bind_result(py::module_& module) {
  py::class_<RobotIdentification>(module, "IdentifiedRobot", "What a log shows of an arm.")
      .def_property_readonly(
          "joints", [](const RobotIdentification& self) { return self.fit.joints; },
          "An IdentifiedJoint for each joint of the log, from the base on.")
      .def_property_readonly(
          "base_parameters",
          [](const RobotIdentification& self) { return self.fit.base_parameters; },
          "A list of BaseParameter.")
      .def_property_readonly(
          "is_physical", [](const RobotIdentification& self) { return self.fit.is_physical; },
          "Whether the bodies are physically possible.")
      .def_property_readonly(
          "torque_lag", [](const RobotIdentification& self) { return self.fit.torque_lag; },
          "[s] of the torques after the positions, which was removed.")
      .def_readonly("payload", &RobotIdentification::payload, "The Payload; None without `loaded`.")
      .def_readonly("notes", &RobotIdentification::notes, "Lines for the user.")
      .def(
          "write_report",
          [](const RobotIdentification& self, const py::object& folder, const std::string& log,
             const std::string& robot, bool replace) {
            OutputFolder output = value_of(OutputFolder::create(
                path_of(folder, "folder"), {.kind = OutputKind::report, .replace = replace}));
            check(write_robot_report(self, log, robot, output.path()));
            check(output.commit());
          },
          py::arg("folder"), py::arg("log") = "log", py::arg("robot") = "robot",
          py::arg("replace") = false,
          "Writes report.html and report.json into a new folder; `log` and `robot` are the names\n"
          "that it states.");
}

}  // namespace

void bind_robot_identification(py::module_& module) {
  bind_joint(module);
  bind_bodies(module);
  bind_result(module);
  module.def("identify_robot", &identify_arm, py::arg("urdf"), py::arg("log"), py::kw_only(),
             py::arg("loaded") = py::none(), py::arg("gains") = std::vector<double>(),
             py::arg("known_body") = false, py::arg("packages") = std::vector<fs::path>(),
             py::arg("skip_bad") = false, py::arg("options") = py::none(),
             R"(Identifies an arm's inertias and joint friction, as `pcavr identify robot`.

urdf        a robot description
log         (t, q, tau): (N,) s in ascending order, (N, dof) [rad] and (N, dof) [N m], with the
            joints in the order of Robot(urdf).joints; or a recording with joints.csv, or such a file
loaded      another log, in which the arm carries a load: this is identified, too
gains       [N m/A] of each joint, for a file of currents
known_body  True: the inertias are the description's, and only friction is fitted
packages    folders that hold ROS packages, for package://
skip_bad    leaves out rows of a file that can't be read
options     a dict from "section.key" to number, as `pcavr --print-config` lists them

Returns IdentifiedRobot. Releases the GIL. Doubtful rows are warnings of category DataWarning. Raises
Error for logs that must not be fitted, and says why.)");
}

}  // namespace pcavr::python
