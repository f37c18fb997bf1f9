// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

using Vector = Eigen::VectorXd;

/// A solution of inverse kinematics.
struct IkSolution {
  Vector q;
  IkResult result;
};

Numbers array_of_vector(const Vector& vector) {
  Numbers array(vector.size());
  Eigen::Map<Vector>(array.mutable_data(), vector.size()) = vector;
  return array;
}

Numbers array_of_matrix(const Eigen::MatrixXd& matrix) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Numbers array({matrix.rows(), matrix.cols()});
  Eigen::Map<RowMajor>(array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
  return array;
}

/// A model with its algorithms.
class Robot {
 public:
  explicit Robot(RobotModel model) : model_(std::move(model)), dynamics_(model_) {}

  [[nodiscard]] const RobotModel& model() const { return model_; }

  Numbers pose(const py::object& q, const std::string& link) {
    const std::size_t index = link_of(link);
    dynamics_.forward_kinematics(coordinates(q, "q"));
    return array_of(dynamics_.T_base_link(index));
  }
  Numbers jacobian(const py::object& q, const std::string& link, const py::object& point) {
    const std::size_t index = link_of(link);
    const Eigen::Vector3d p_link =
        point.is_none() ? Eigen::Vector3d(0.0, 0.0, 0.0) : vector_of(point, "point");
    Matrix6Xd jacobian = Matrix6Xd::Zero(6, dof());
    dynamics_.jacobian(coordinates(q, "q"), index, jacobian, p_link);
    return array_of_matrix(jacobian);
  }
  Numbers inverse_dynamics(const py::object& q, const py::object& dq, const py::object& ddq) {
    Vector tau = Vector::Zero(dof());
    dynamics_.inverse_dynamics(coordinates(q, "q"), coordinates(dq, "dq"), coordinates(ddq, "ddq"),
                               tau);
    return array_of_vector(tau);
  }
  Numbers forward_dynamics(const py::object& q, const py::object& dq, const py::object& tau) {
    if (!model_.has_inertia()) {
      raise_error({.message = "a moving body has no mass",
                   .file = model_.file.string(),
                   .hint = "give each link an <inertial>"});
    }
    Vector ddq = Vector::Zero(dof());
    dynamics_.forward_dynamics(coordinates(q, "q"), coordinates(dq, "dq"), coordinates(tau, "tau"),
                               ddq);
    return array_of_vector(ddq);
  }
  Numbers mass_matrix(const py::object& q) {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(dof(), dof());
    dynamics_.mass_matrix(coordinates(q, "q"), mass);
    return array_of_matrix(mass);
  }
  Numbers gravity_torque(const py::object& q) {
    Vector tau = Vector::Zero(dof());
    dynamics_.gravity_torque(coordinates(q, "q"), tau);
    return array_of_vector(tau);
  }
  Numbers regressor(const py::object& q, const py::object& dq, const py::object& ddq) {
    const auto columns = static_cast<Eigen::Index>(10 * model_.joints.size());
    Eigen::MatrixXd regressor = Eigen::MatrixXd::Zero(dof(), columns);
    dynamics_.regressor(coordinates(q, "q"), coordinates(dq, "dq"), coordinates(ddq, "ddq"),
                        regressor);
    return array_of_matrix(regressor);
  }
  IkSolution inverse_kinematics(const py::object& target, const std::string& link,
                                const py::object& start) {
    InverseKinematics solver(model_, link_of(link));
    const Pose T_base_target = pose_of(target, "pose");
    IkSolution solution{start.is_none() ? Vector(Vector::Zero(dof())) : coordinates(start, "start"),
                        {}};
    const py::gil_scoped_release released;
    solution.result = solver.solve(T_base_target, solution.q);
    return solution;
  }

 private:
  [[nodiscard]] Eigen::Index dof() const { return static_cast<Eigen::Index>(model_.dof); }
  [[nodiscard]] Vector coordinates(const py::object& argument, const std::string& name) const {
    return Vector::Map(numbers_of(argument, name, {dof()}).data(), dof());
  }
  [[nodiscard]] std::size_t link_of(const std::string& name) const {
    const auto index = model_.link_index(name);
    if (!index) throw py::key_error(name);
    return *index;
  }

  RobotModel model_;
  RobotDynamics dynamics_;
};

Robot read_robot(const py::object& urdf, const std::vector<std::filesystem::path>& packages) {
  return Robot(value_of(read_urdf(path_of(urdf, "urdf"), {.package_folders = packages})));
}

std::vector<std::string> coordinate_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const std::size_t joint : robot.model().coordinate_joints()) {
    names.push_back(robot.model().joints[joint].name);
  }
  return names;
}

/// (dof, 2), infinite where a joint has no limit.
Numbers position_limits(const Robot& robot) {
  Numbers limits({static_cast<py::ssize_t>(robot.model().dof), py::ssize_t{2}});
  double* row = limits.mutable_data();
  for (const std::size_t joint : robot.model().coordinate_joints()) {
    const JointLimits& each = robot.model().joints[joint].limits;
    *row++ = each.lower.value_or(-HUGE_VAL);
    *row++ = each.upper.value_or(HUGE_VAL);
  }
  return limits;
}

void bind_solution(py::module_& module) {
  py::class_<IkSolution>(module, "IkSolution", "The result of inverse kinematics.")
      .def_property_readonly(
          "q", [](const IkSolution& self) { return array_of_vector(self.q); },
          "(dof,) [rad, m]; where it is not reached, the nearest that was found.")
      .def_property_readonly(
          "is_reached",
          [](const IkSolution& self) { return self.result.status == IkStatus::kReached; },
          "Whether both errors are within their tolerances.")
      .def_property_readonly(
          "position_error", [](const IkSolution& self) { return self.result.position_error; },
          "[m]")
      .def_property_readonly(
          "rotation_error", [](const IkSolution& self) { return self.result.rotation_error; },
          "[rad]")
      .def_property_readonly(
          "is_singular", [](const IkSolution& self) { return self.result.is_singular; },
          "Whether the Jacobian is near a singularity there.")
      .def_property_readonly(
          "is_at_limit", [](const IkSolution& self) { return self.result.is_at_limit; },
          "Whether a joint is at a limit of its position.");
}

void bind_description(py::class_<Robot>& robot) {
  robot
      .def(py::init(&read_robot), py::arg("urdf"), py::kw_only(),
           py::arg("packages") = std::vector<std::filesystem::path>(),
           "urdf      a robot description\n"
           "packages  folders that hold ROS packages, for package://\n\n"
           "Raises Error with file, line, and link or joint.")
      .def_property_readonly(
          "name", [](const Robot& self) { return self.model().name; }, "Of the description.")
      .def_property_readonly(
          "dof", [](const Robot& self) { return self.model().dof; }, "Number of coordinates.")
      .def_property_readonly("joints", &coordinate_names, "Names, in the order of q.")
      .def_property_readonly(
          "links",
          [](const Robot& self) {
            std::vector<std::string> names;
            for (const RobotLink& link : self.model().links) names.push_back(link.name);
            return names;
          },
          "Names, parents before children.")
      .def_property_readonly("position_limits", &position_limits,
                             "(dof, 2) [rad, m] lower and upper; infinite without a limit.")
      .def_property_readonly(
          "warnings",
          [](const Robot& self) {
            std::vector<std::string> lines;
            for (const Error& warning : self.model().warnings) {
              lines.push_back(warning.to_string());
            }
            return lines;
          },
          "Doubts about the description.");
}

}  // namespace

void bind_robots(py::module_& module) {
  bind_solution(module);
  py::class_<Robot> robot(module, "Robot",
                          R"(Kinematics and rigid-body dynamics of a robot from URDF.

q, dq, ddq and tau have `dof` numbers in the order of `joints`: [rad, m], their time derivatives, and
[N m, N]. Base frame: that of the root link. One thread at a time. All methods raise Error for a wrong
shape and numbers that are not finite, and KeyError for an unknown link.)");
  bind_description(robot);
  robot
      .def("pose", &Robot::pose, py::arg("q"), py::arg("link"),
           "The pose (7,) x y z [m] qx qy qz qw of a link in base.")
      .def("jacobian", &Robot::jacobian, py::arg("q"), py::arg("link"), py::kw_only(),
           py::arg("point") = py::none(),
           "(6, dof): [v; omega] = jacobian @ dq, in base axes; v of the link's origin, or of\n"
           "`point` (3,) [m], fixed to the link.")
      .def("inverse_dynamics", &Robot::inverse_dynamics, py::arg("q"), py::arg("dq"),
           py::arg("ddq"), "The torque (dof,) for an acceleration, without friction.")
      .def("forward_dynamics", &Robot::forward_dynamics, py::arg("q"), py::arg("dq"),
           py::arg("tau"), "The acceleration (dof,) under a torque, without friction.")
      .def("mass_matrix", &Robot::mass_matrix, py::arg("q"), "(dof, dof) [kg m^2] and the like.")
      .def("gravity_torque", &Robot::gravity_torque, py::arg("q"),
           "The torque (dof,) that holds the robot at rest.")
      .def("regressor", &Robot::regressor, py::arg("q"), py::arg("dq"), py::arg("ddq"),
           "(dof, 10 joints): regressor @ inertial parameters is the torque; for each movable\n"
           "joint m, m cx, m cy, m cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz about its frame's origin.")
      .def("inverse_kinematics", &Robot::inverse_kinematics, py::arg("pose"), py::arg("link"),
           py::kw_only(), py::arg("start") = py::none(),
           "The IkSolution that brings a link to a pose (7,) in base, searched from `start` "
           "(dof,),\n"
           "by default zeros. Releases the GIL.")
      .def("__repr__", [](const Robot& self) {
        return fmt::format("<Robot {}: {} coordinates>", self.model().name, self.model().dof);
      });
}

}  // namespace pcavr::python
