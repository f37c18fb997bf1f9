// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/physics/prediction/predictor.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

/// A body of a world that is to be made.
struct Body {
  WorldBody content;
  std::vector<std::string> assumed;  ///< parameters with default values
};

/// The ranges of the parameter file hold for parameters that were never in one.
void check_parameters(const std::string& name, const ObjectParameters& parameters) {
  static_cast<void>(value_of(parse_parameters(format_parameters({{name, parameters}}), name)));
}

Body make_body(const std::string& name, const py::object& cad, const py::object& pose,
               const ObjectParameters& parameters, bool movable, double cad_unit) {
  check_parameters("parameters", parameters);
  Body body{.content = {.model = cad_of(cad, name, cad_unit),
                        .T_base_object = pose_of(pose, "pose"),
                        .physics = {},
                        .is_movable = movable},
            .assumed = {}};
  const auto complete = movable ? &complete_physics : &complete_immovable_physics;
  CompletedPhysics completed = complete(parameters, body.content.model, body.content.T_base_object,
                                        kStandardGravity, PhysicsDefaults());
  body.content.physics = std::move(completed.physics);
  body.assumed = std::move(completed.assumed);
  return body;
}

/// Three floats of a list or a tuple.
std::optional<Eigen::Vector3d> three_floats(const py::handle& argument) {
  if (!py::isinstance<py::list>(argument) && !py::isinstance<py::tuple>(argument)) return {};
  if (PySequence_Fast_GET_SIZE(argument.ptr()) != 3) return {};
  PyObject** const items = PySequence_Fast_ITEMS(argument.ptr());
  Eigen::Vector3d vector;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (PyFloat_Check(items[i]) == 0) return {};
    vector[i] = PyFloat_AS_DOUBLE(items[i]);
  }
  return vector;
}

/// Three numbers of an array of float64.
std::optional<Eigen::Vector3d> three_of_array(const py::handle& argument) {
  using Doubles = py::array_t<double>;
  if (!Doubles::check_(argument)) return {};
  const auto array = py::reinterpret_borrow<Doubles>(argument);
  if (array.ndim() != 1 || array.shape(0) != 3) return {};
  const auto numbers = array.unchecked<1>();
  return Eigen::Vector3d(numbers(0), numbers(1), numbers(2));
}

/// The tip of a step: what is usual without a conversion, which takes longer than a step.
Eigen::Vector3d tip_of(const py::handle& argument) {
  std::optional<Eigen::Vector3d> tip = three_of_array(argument);
  if (!tip) tip = three_floats(argument);
  return tip && tip->allFinite() ? *tip : vector_of(argument, "tip");
}

/// The predictor and its clock's step.
class World {
 public:
  World(const std::vector<Body>& bodies, const py::object& tip, double tool_radius,
        const py::object& static_mesh, double start, double step)
      : predictor_(make(bodies, tip, tool_radius, static_mesh, start, step)) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      names_.push_back(predictor_.world().name(i));
    }
  }

  void step(const py::handle& tip) {
    const Eigen::Vector3d p_base = tip_of(tip);
    const std::lock_guard lock(mutex_);
    predictor_.step(p_base);
  }
  void run(const py::object& tips) {
    const Numbers rows = numbers_of(tips, "tips", {kAnySize, 3});
    const double* numbers = rows.data();
    const py::ssize_t count = rows.shape(0);
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    for (py::ssize_t i = 0; i < count; ++i) {
      predictor_.step(Eigen::Vector3d::Map(numbers + 3 * i));
    }
  }
  [[nodiscard]] double now() const {
    const std::lock_guard lock(mutex_);
    return predictor_.now();
  }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] ShownBody shown(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    return predictor_.shown(index_of(name));
  }

  bool correct(const std::string& name, double t, const py::object& pose,
               const py::object& parameters) {
    Correction correction{.t = t, .body = index_of(name)};
    if (!std::isfinite(t)) raise_error({.message = "is not a finite number", .place = "t"});
    if (!pose.is_none()) correction.T_base_object = pose_of(pose, "pose");
    if (!parameters.is_none()) {
      const auto known = parameters.cast<ObjectParameters>();
      check_parameters("parameters", known);
      const Body& body = bodies_[correction.body];
      const auto complete =
          body.content.is_movable ? &complete_physics : &complete_immovable_physics;
      correction.physics = complete(known, body.content.model, body.content.T_base_object,
                                    kStandardGravity, PhysicsDefaults())
                               .physics;
    }
    const std::lock_guard lock(mutex_);
    return predictor_.correct(correction);
  }

 private:
  Predictor make(const std::vector<Body>& bodies, const py::object& tip, double tool_radius,
                 const py::object& static_mesh, double start, double step) {
    bodies_ = bodies;
    if (auto error = check_range(ranges::kToolRadius, tool_radius)) {
      error->place = "tool_radius";
      raise_error(*error);
    }
    if (!std::isfinite(start)) raise_error({.message = "is not finite", .place = "start"});
    constexpr double kMinStep = 1e-5,
                     kMaxStep = 0.1;  // [s] shorter and longer ones were not tested
    if (!(step >= kMinStep && step <= kMaxStep)) {
      raise_error({.message = "is not from 1e-5 to 0.1 s", .place = "dt"});
    }
    WorldModel model;
    model.tool_radius = tool_radius;
    for (const Body& body : bodies) model.bodies.push_back(body.content);
    if (!static_mesh.is_none()) model.static_mesh_base = mesh_of(static_mesh, "static_mesh");
    PredictorOptions options;
    options.step = step;
    return {value_of(PredictedWorld::create(std::move(model))), start, vector_of(tip, "tip"),
            options};
  }

  [[nodiscard]] std::size_t index_of(const std::string& name) const {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == name) return i;
    }
    throw py::key_error(name);
  }

  std::vector<Body> bodies_;
  Predictor predictor_;
  mutable std::mutex mutex_;  ///< of the predictor: run() works without the GIL
  std::vector<std::string> names_;
};

void bind_body(py::module_& module) {
  py::class_<Body>(module, "Body", "A rigid body of a World that is to be made.")
      .def(py::init(&make_body), py::arg("name"), py::arg("cad"), py::arg("pose"),
           py::arg("parameters") = ObjectParameters(), py::kw_only(), py::arg("movable") = true,
           py::arg("cad_unit") = 1.0,
           R"(name        of the body
cad         a mesh file, or a pair of vertices (V, 3) [m] and triangles (T, 3), closed
pose        (7,) x y z [m] qx qy qz qw in base, in which it stands on its support; z is up
parameters  Parameters; what they do not state has a conservative default, see assumed
movable     False: it keeps its pose under any force
cad_unit    [m] of the coordinates in a mesh file

Raises Error for a mesh that is not closed and for parameters out of range.)")
      .def_property_readonly(
          "name", [](const Body& self) { return self.content.model.name; }, "As given.")
      .def_readonly("assumed", &Body::assumed, "Names of the parameters with default values.");
}

}  // namespace

void bind_world(py::module_& module) {
  bind_body(module);
  py::class_<World>(module, "World", R"(Predicts how a tool pushes bodies, in cycles of `dt`.

Bodies stay upright on their support: they slide and turn on it, by the identified friction and
contact. Same inputs, same bits. One thread at a time.)")
      .def(py::init<const std::vector<Body>&, const py::object&, double, const py::object&, double,
                    double>(),
           py::arg("bodies"), py::arg("tip"), py::kw_only(), py::arg("tool_radius") = 0.01,
           py::arg("static_mesh") = py::none(), py::arg("start") = 0.0, py::arg("dt") = 0.001,
           R"(bodies       a list of Body
tip          (3,) [m] centre of the tool's spherical tip in base at `start`
tool_radius  [m]
static_mesh  a pair of vertices (V, 3) [m] and triangles (T, 3) in base: what does not move
start        [s] the clock before the first step
dt           [s] of a step

Raises Error for values out of range, and where a body gets no collision shape.)")
      .def("step", &World::step, py::arg("tip"),
           "One cycle: the tip's centre goes in a straight line to `tip` (3,) [m] in base. Raises\n"
           "Error for another shape and for numbers that are not finite; nothing is stepped then.")
      .def("run", &World::run, py::arg("tips"),
           "A step for each row of `tips` (N, 3) [m], as by N calls of step. Releases the GIL.")
      .def_property_readonly("now", &World::now, "The clock [s].")
      .def_property_readonly("names", &World::names, "Of the bodies, in the order given.")
      .def(
          "pose",
          [](const World& self, const std::string& name) {
            return array_of(self.shown(name).T_base_object);
          },
          py::arg("name"), "The pose (7,) of a body in base as it is displayed now.")
      .def(
          "force",
          [](const World& self, const std::string& name) {
            return array_of(self.shown(name).force_base);
          },
          py::arg("name"), "The force (3,) [N] of the tip on a body, in base axes.")
      .def(
          "phase",
          [](const World& self, const std::string& name) {
            return std::string(name_of(self.shown(name).phase));
          },
          py::arg("name"), "'free', 'static', 'critical' or 'sliding'.")
      .def(
          "correct", &World::correct, py::arg("name"), py::arg("t"), py::kw_only(),
          py::arg("pose") = py::none(), py::arg("parameters") = py::none(),
          R"(Applies what was measured of a body at an earlier time t [s], and predicts the present again.

pose        (7,) in base
parameters  Parameters, valid from t on

False where t lies before the history or after now: nothing is changed then.)");
}

}  // namespace pcavr::python
