// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/pipeline/calibrate_objects.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "interruptible.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr double kMaxForce = 1e5;  ///< [N] as of the command

/// Calibrated objects, and what they are of.
struct CalibratedObjects {
  std::vector<CalibratedObject> objects = {};
  std::string source;  ///< the recording; "arrays" for points in memory
  std::vector<std::string> notes = {};
};

/// The number of contact of each point, counted from 0 in the order of the points.
std::vector<std::size_t> contacts_of(const py::object& argument, py::ssize_t count) {
  const py::array given = py::array::ensure(argument);
  if (!given || (given.dtype().kind() != 'i' && given.dtype().kind() != 'u')) {
    PyErr_Clear();
    throw py::type_error("contacts: whole numbers are expected");
  }
  const Numbers numbers = numbers_of(given, "contacts", {count});
  std::vector<std::size_t> contacts;
  for (py::ssize_t i = 0; i < count; ++i) {
    const bool is_new = i > 0 && numbers.at(i) != numbers.at(i - 1);
    contacts.push_back(contacts.empty() ? 0 : contacts.back() + (is_new ? 1 : 0));
  }
  return contacts;
}

TouchedObject make_touched(const std::string& name, const py::object& cad, const py::object& points,
                           const py::object& contacts, double tool_radius, const py::object& pose,
                           const py::object& up, double cad_unit) {
  if (auto error = check_range(ranges::kToolRadius, tool_radius)) {
    error->place = "tool_radius";
    raise_error(*error);
  }
  TouchedObject object{.name = name,
                       .model = cad_of(cad, name, cad_unit),
                       .mesh_unit = cad_unit,
                       .T_tracked_object = pose.is_none() ? Pose() : pose_of(pose, "pose"),
                       .up_tracked = vector_of(up, "up"),
                       .tip_radius = tool_radius};
  if (object.up_tracked.norm() == 0.0) {
    raise_error({.message = "has no direction", .place = "up"});
  }
  object.up_tracked.normalize();
  const Numbers rows = numbers_of(points, "points", {kAnySize, 3});
  const std::vector<std::size_t> of_points = contacts_of(contacts, rows.shape(0));
  for (std::size_t i = 0; i < of_points.size(); ++i) {
    object.points.push_back({of_points[i], Eigen::Vector3d::Map(rows.data() + 3 * i)});
  }
  object.contacts = of_points.empty() ? 0 : of_points.back() + 1;
  return object;
}

Expected<CalibratedObjects> calibrate(const TouchedObjects& touched, const std::string& source) {
  CalibratedObjects found{.source = source, .notes = touched.notes};
  for (const TouchedObject& object : touched.objects) {
    Expected<CalibratedObject> one = calibrate_object(object);
    if (!one) {
      Error error = one.error();
      if (source == "arrays") {
        error.place = object.name;
      } else {
        error.file = source;
      }
      return error;
    }
    found.notes.insert(found.notes.end(), one->notes.begin(), one->notes.end());
    found.objects.push_back(*std::move(one));
  }
  return found;
}

TouchedObjects touched_of(const py::object& argument) {
  TouchedObjects touched;
  for (const py::handle each : argument) {
    if (!py::isinstance<TouchedObject>(each)) {
      throw py::type_error("recording: a folder, or a list of TouchedObject, is expected");
    }
    touched.objects.push_back(each.cast<TouchedObject>());
  }
  if (touched.objects.empty()) {
    raise_error({.message = "there are no objects", .place = "recording"});
  }
  return touched;
}

CalibratedObjects calibrate_objects_of(const py::object& recording, double min_force, bool skip_bad,
                                       const py::object& progress) {
  if (!(min_force >= 0.0 && min_force <= kMaxForce)) {
    raise_error({.message = "is not from 0 to 100000 N", .place = "min_force"});
  }
  if (py::isinstance<py::list>(recording) || py::isinstance<py::tuple>(recording)) {
    const TouchedObjects touched = touched_of(recording);
    return run_interruptible(progress,
                             [&](const Observer&) { return calibrate(touched, "arrays"); });
  }
  const ObjectsInput input{
      .recording = path_of(recording, "recording"), .min_force = min_force, .skip_bad = skip_bad};
  return run_interruptible(progress, [&](const Observer& observer) -> Expected<CalibratedObjects> {
    const Expected<TouchedObjects> touched = read_touched_objects(input, observer);
    if (!touched) return touched.error();
    return calibrate(*touched, input.recording.string());
  });
}

/// NaN where the contacts do not show the parameter.
Numbers stds_of(const CalibratedObject& self) {
  Numbers stds(static_cast<py::ssize_t>(kObjectParameters));
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    stds.mutable_data()[i] =
        self.is_observable[i] ? self.stds[i] : std::numeric_limits<double>::quiet_NaN();
  }
  return stds;
}

void bind_touched_object(py::module_& module) {
  py::class_<TouchedObject>(module, "TouchedObject", "A tracked body, and where a tip touched it.")
      .def(py::init(&make_touched), py::arg("name"), py::arg("cad"), py::arg("points"),
           py::arg("contacts"), py::kw_only(), py::arg("tool_radius"), py::arg("pose") = py::none(),
           py::arg("up") = py::make_tuple(0.0, 0.0, 1.0), py::arg("cad_unit") = 1.0,
           R"(name         for messages
cad          a mesh file, or (vertices (V, 3) [m], triangles (T, 3))
points       (N, 3) [m] the tip's centre while it touches, in the frame that the tracker calls the object's
contacts     (N,) whole numbers: points in a row with one number are of one contact
tool_radius  [m] of the spherical tip
pose         (7,) of the mesh in the tracker's frame, as far as it is known; None: the same frame
up           (3,) against gravity, in the tracker's frame
cad_unit     [m] of a mesh file's coordinates

Raises Error for a bad mesh and for numbers out of range; TypeError for contacts with a fraction.)")
      .def_readonly("name", &TouchedObject::name, "As given.")
      .def_readonly("contacts", &TouchedObject::contacts, "Number of contacts.");
}

void bind_calibrated_object(py::module_& module) {
  py::class_<CalibratedObject>(module, "CalibratedObject",
                               "Where a mesh is in the frame that a tracker calls the object's.")
      .def_readonly("name", &CalibratedObject::name, "As in the recording.")
      .def_property_readonly(
          "pose", [](const CalibratedObject& self) { return array_of(self.T_tracked_object); },
          "(7,) of the mesh in the tracker's frame.")
      .def_readonly("scale", &CalibratedObject::scale, "True size over the mesh's.")
      .def_readonly("unit", &CalibratedObject::mesh_unit,
                    "[m] of the mesh's coordinates, with the scale.")
      .def_property_readonly(
          "stds", &stds_of,
          "(7,) of x, y, z [m], rotations about x, y, z [rad], and the scale, in "
          "the mesh's\naxes; NaN: the contacts do not show it, and it is as "
          "stated.")
      .def_readonly("before_rms", &CalibratedObject::before_rms,
                    "[m] between tip and surface, as stated.")
      .def_readonly("fitted_rms", &CalibratedObject::fitted_rms, "[m] between tip and surface.")
      .def_readonly("held_out_rms", &CalibratedObject::held_out_rms,
                    "[m] of each contact by the others.")
      .def_readonly("contacts", &CalibratedObject::contacts, "Number of contacts.")
      .def_property_readonly("verdict", &describe_object,
                             "A sentence: how far the mesh is from where the tracker has it.")
      .def_readonly("notes", &CalibratedObject::notes, "Lines for the user.");
  py::class_<CalibratedObjects>(module, "CalibratedObjects",
                                "What contacts show of tracked bodies.")
      .def_readonly("objects", &CalibratedObjects::objects, "A list of CalibratedObject.")
      .def_readonly("notes", &CalibratedObjects::notes, "Lines for the user.")
      .def(
          "text",
          [](const CalibratedObjects& self) {
            return format_objects(self.objects, {.recording = self.source});
          },
          "The text of a calibration that a recording names (`calibration:`).");
}

}  // namespace

void bind_object_calibration(py::module_& module) {
  bind_touched_object(module);
  bind_calibrated_object(module);
  module.def(
      "calibrate_objects", &calibrate_objects_of, py::arg("recording"), py::kw_only(),
      py::arg("min_force") = 0.0, py::arg("skip_bad") = false, py::arg("progress") = py::none(),
      R"(Finds where tracked bodies' meshes are in the tracker's frames, as `calibrate objects`.

recording  folder of a recording in which the tip pushes tracked bodies, from all sides; or a list of
           TouchedObject
min_force  [N] from which on the tip touches; 0: by the largest force of the recording
skip_bad   leaves out rows that can't be read instead of raising
progress   called with stage, done and total (0: unknown); what it raises ends the call

Returns CalibratedObjects. Releases the GIL. Doubtful inputs are warnings of category DataWarning.
Raises Error for a recording without tool, force or tracked poses, for fewer than four contacts of a
body, and where they do not show where it is.)");
}

}  // namespace pcavr::python
