// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/physics/object_identification/combine_with_known.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/recordings/recording/held_samples.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "settings.hpp"
#include "threads.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

/// One object with what its series showed: the result of identify.
struct IdentifiedFromArrays {
  ObjectIdentification object;
  std::vector<std::string> warnings;
};

IdentificationGoal goal_of(const std::string& name) {
  if (name == "friction") return IdentificationGoal::friction;
  if (name == "contact") return IdentificationGoal::contact;
  raise_error({.message = "'" + name + "' is not a goal",
               .place = "goal",
               .hint = "give 'friction' (pushes) or 'contact' (presses)"});
}

void check_in_range(const InputRange& range, double value, const char* argument) {
  if (auto error = check_range(range, value)) {
    error->place = argument;
    raise_error(*error);
  }
}

/// The series of identify(), with the rows that a controller repeated left out, as in a recording.
struct ArraySeries {
  TimedRows tool;  ///< three or seven columns
  std::vector<WrenchSample> wrench;
  Trajectory tracked;
  std::vector<std::string> notes;

  [[nodiscard]] Stamp start() const {
    std::vector<Stamp> firsts;
    if (!tool.stamps.empty()) firsts.push_back(tool.stamps.front());
    if (!wrench.empty()) firsts.push_back(wrench.front().stamp);
    return firsts.empty() ? Stamp() : *std::min_element(firsts.begin(), firsts.end());
  }
};

std::vector<WrenchSample> wrench_of(const py::object& argument) {
  const TimedRows rows = timed_rows_of(argument, "wrench", {3, 6});
  std::vector<WrenchSample> wrench;
  for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
    const bool has_torque = rows.columns() == 6;
    wrench.push_back({rows.stamps[i], rows.vector(i),
                      has_torque ? rows.vector(i, 3) : Eigen::Vector3d(0.0, 0.0, 0.0)});
  }
  return wrench;
}

ArraySeries read_series(const py::object& tool, const py::object& wrench,
                        const py::object& tracked) {
  ArraySeries series{timed_rows_of(tool, "tool", {3, 7}), wrench_of(wrench), {}, {}};
  if (!tracked.is_none()) series.tracked = trajectory_of(tracked, "tracked");
  if (auto note = leave_out_held("wrench", series.wrench)) series.notes.push_back(*note);
  if (auto note = leave_out_held("tracked", series.tracked)) series.notes.push_back(*note);
  return series;
}

/// The tool's poses without repeated ones; positions alone stay as they are.
void add_tool(const ArraySeries& series, Stamp start, IdentificationInput& input) {
  Trajectory poses;
  for (std::size_t i = 0; i < series.tool.stamps.size(); ++i) {
    const Stamp stamp = series.tool.stamps[i];
    poses.append(stamp, series.tool.columns() == 7 ? pose_of(series.tool, i, "tool")
                                                   : Pose::from_translation(series.tool.vector(i)));
  }
  if (auto note = leave_out_held("tool", poses)) input.notes.push_back(*note);
  for (const auto& [stamp, pose] : poses.poses()) {
    input.t_tool.push_back(to_seconds(stamp - start));
    input.p_base_tip.push_back(pose.translation());
    if (series.tool.columns() == 7) input.q_base_tool.push_back(pose.rotation());
  }
}

struct TrackingStd {
  double position = 0.001;  ///< [m]
  double rotation = 0.010;  ///< [rad]
};

std::vector<TrackedPose> tracked_poses(const Trajectory& tracked, Stamp start,
                                       const TrackingStd& std) {
  std::vector<TrackedPose> poses;
  for (const auto& [stamp, pose] : tracked.poses()) {
    poses.push_back({to_seconds(stamp - start), pose, std.position, std.rotation});
  }
  return poses;
}

/// What identify() is given beside the series.
struct ObjectArguments {
  std::string name;
  py::object cad;
  double cad_unit;
  std::optional<double> mass;
  py::object pose;
  bool is_movable;
  std::pair<double, double> tracked_std;
};

IdentifiableObject object_of(const ObjectArguments& arguments, const ArraySeries& series,
                             Stamp start) {
  if (arguments.mass) check_in_range(ranges::kMass, *arguments.mass, "mass");
  check_in_range(ranges::kPositionStd, arguments.tracked_std.first, "tracked_std");
  check_in_range(ranges::kRotationStd, arguments.tracked_std.second, "tracked_std");
  if (arguments.pose.is_none() && series.tracked.empty()) {
    raise_error({.message = "the object's pose is not known",
                 .place = "tracked",
                 .hint = "give its tracked poses, or its pose at the start (pose=)"});
  }
  IdentifiableObject object{.name = arguments.name,
                            .model = cad_of(arguments.cad, arguments.name, arguments.cad_unit),
                            .T_base_object = arguments.pose.is_none()
                                                 ? series.tracked.poses().front().pose
                                                 : pose_of(arguments.pose, "pose"),
                            .mass = arguments.mass,
                            .is_movable = arguments.is_movable};
  object.tracked = tracked_poses(series.tracked, start,
                                 {arguments.tracked_std.first, arguments.tracked_std.second});
  return object;
}

/// The error of a series by the argument's name instead of a file's.
Error in_arguments(Error error) {
  if (error.file.empty()) return error;
  error.place = std::filesystem::path(error.file).stem().string() +
                (error.place.empty() ? "" : ": " + error.place);
  error.file.clear();
  return error;
}

IdentifiedFromArrays identify_arrays(const py::object& tool, const py::object& wrench,
                                     const py::object& tracked, const py::object& cad,
                                     const std::string& goal, std::optional<double> mass,
                                     double tool_radius, const py::object& pose, bool movable,
                                     const std::string& name, double cad_unit,
                                     std::pair<double, double> tracked_std,
                                     const std::optional<ObjectParameters>& known,
                                     const py::object& options) {
  Settings settings;
  settings.set(options);
  const IdentificationGoal wanted_goal = goal_of(goal);
  check_in_range(ranges::kToolRadius, tool_radius, "tool_radius");
  const ArraySeries series = read_series(tool, wrench, tracked);
  const Stamp start = series.start();
  IdentificationInput input;
  input.tool_radius = tool_radius;
  input.notes = series.notes;
  input.objects.push_back(
      object_of({name, cad, cad_unit, mass, pose, movable, tracked_std}, series, start));
  add_tool(series, start, input);
  for (const WrenchSample& sample : series.wrench) {
    input.t_force.push_back(to_seconds(sample.stamp - start));
    input.force_base.push_back(sample.force);
  }
  if (known) input.known[name] = *known;
  Identification found = run_interruptible(py::none(), [&](const Observer&) {
    Expected<Identification> result = identify(input, wanted_goal, settings.identification());
    return result ? std::move(result) : Expected<Identification>(in_arguments(result.error()));
  });
  IdentifiedFromArrays result{std::move(found.objects.front()), std::move(found.warnings)};
  if (known) combine_with_known(*known, result.object);
  result.object.notes.insert(result.object.notes.end(), found.notes.begin(), found.notes.end());
  return result;
}

Expected<Identification> identify_of_recording(const std::filesystem::path& folder,
                                               IdentificationGoal goal,
                                               IdentificationSources sources,
                                               const ParameterTable& known, Settings& settings,
                                               const Observer& observer) {
  ReadOptions reading = settings.reading;
  reading.skip_bad = sources.skip_bad;
  const Expected<Recording> recording = read_recording(folder, reading);
  if (!recording) return recording.error();
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  sources.perception = settings.build.perception;
  Expected<IdentificationInput> input = identification_input(*recording, sources, observer);
  if (!input) return input.error();
  input->known = known;
  Expected<Identification> found = identify(*input, goal, settings.identification());
  if (!found) {
    Error error = found.error();
    if (!error.file.empty()) error.file = (folder / error.file).string();
    return error;
  }
  for (ObjectIdentification& object : found->objects) {
    const auto before = known.find(object.name);
    if (before != known.end()) combine_with_known(before->second, object);
  }
  found->configuration = settings.changed();
  return found;
}

Identification identify_recording(const py::object& recording, const std::string& goal,
                                  const py::object& scene, const py::object& tracked,
                                  const ParameterTable& known, bool skip_bad, int threads,
                                  const py::object& options, const py::object& progress) {
  Settings settings;
  settings.set(options);
  const IdentificationGoal wanted_goal = goal_of(goal);
  const std::filesystem::path folder = path_of(recording, "recording");
  IdentificationSources sources{.skip_bad = skip_bad, .parallelism = parallelism_of(threads)};
  if (!scene.is_none()) sources.scene = path_of(scene, "scene");
  if (!tracked.is_none()) sources.tracked = path_of(tracked, "tracked");
  return run_interruptible(progress, [&](const Observer& observer) {
    return identify_of_recording(folder, wanted_goal, sources, known, settings, observer);
  });
}

std::string text_of_finding(const ParameterFinding& finding) {
  if (!finding.is_excited) return "<Finding " + finding.name + ": " + finding.remark + '>';
  const std::string std_text = finding.std ? fmt::format(" +- {:.2g}", *finding.std) : "";
  return fmt::format("<Finding {}: {:.4g}{} {}>", finding.name, finding.value, std_text,
                     finding.unit);
}

const ParameterFinding& finding_of(const ObjectIdentification& object, const std::string& name) {
  for (const ParameterFinding& finding : object.findings) {
    if (finding.name == name) return finding;
  }
  throw py::key_error(name);
}

void bind_finding(py::module_& module) {
  py::class_<ParameterFinding>(module, "Finding", "One parameter: its value, or why there is none.")
      .def_readonly("name", &ParameterFinding::name, "As in the parameter file.")
      .def_readonly("unit", &ParameterFinding::unit, "Of value and std; '' for a number.")
      .def_property_readonly(
          "value",
          [](const ParameterFinding& finding) {
            return finding.is_excited ? finding.value : std::numeric_limits<double>::quiet_NaN();
          },
          "NaN where the motion did not excite the parameter.")
      .def_readonly("std", &ParameterFinding::std,
                    "Standard deviation in the value's unit; None: not known.")
      .def_readonly("is_excited", &ParameterFinding::is_excited,
                    "False: the motion does not show this parameter.")
      .def_readonly("remark", &ParameterFinding::remark,
                    "The value's source, or the motion that would identify it.")
      .def("__repr__", &text_of_finding);
}

template <typename Result, typename ObjectOf>
void bind_object_result(py::class_<Result>& result, ObjectOf object_of_result) {
  result
      .def_property_readonly(
          "name", [=](const Result& self) { return object_of_result(self).name; }, "Of the object.")
      .def_property_readonly(
          "parameters", [=](const Result& self) { return object_of_result(self).parameters; },
          "All known Parameters of the object, for write_parameters and World.")
      .def_property_readonly(
          "findings", [=](const Result& self) { return object_of_result(self).findings; },
          "A Finding for each parameter, in the order of the command's table.")
      .def_property_readonly(
          "notes", [=](const Result& self) { return object_of_result(self).notes; },
          "Lines for the user, with proposals of better motions.")
      .def(
          "__getitem__",
          [=](const Result& self, const std::string& name) {
            return finding_of(object_of_result(self), name);
          },
          py::arg("name"), "The Finding of a parameter by its name; KeyError for another name.")
      .def("__repr__", [=](const Result& self) {
        std::string text = "<identified " + object_of_result(self).name;
        for (const ParameterFinding& finding : object_of_result(self).findings) {
          text += "\n  " + text_of_finding(finding);
        }
        return text + '>';
      });
}

void bind_results(py::module_& module) {
  py::class_<IdentifiedFromArrays> from_arrays(module, "Identified",
                                               "What the series of one object show.");
  bind_object_result(
      from_arrays, [](const IdentifiedFromArrays& self) -> const auto& { return self.object; });
  from_arrays.def_readonly("warnings", &IdentifiedFromArrays::warnings,
                           "Of the notes: data that contradict each other.");
  py::class_<ObjectIdentification> object(module, "IdentifiedObject",
                                          "What a recording shows of one object.");
  bind_object_result(
      object, [](const ObjectIdentification& self) -> const auto& { return self; });
  py::class_<Identification>(module, "Identification", "What a recording shows of its objects.")
      .def_property_readonly(
          "objects",
          [](const Identification& self) {
            py::dict objects;
            for (const ObjectIdentification& each : self.objects) {
              objects[py::str(each.name)] = each;
            }
            return objects;
          },
          "A dict from name to IdentifiedObject.")
      .def_property_readonly(
          "parameters", [](const Identification& self) { return self.parameters(); },
          "A dict from object to Parameters, updated with what was identified.")
      .def_readonly("notes", &Identification::notes, "What was found in the series.")
      .def_readonly("warnings", &Identification::warnings,
                    "Of the notes: data that contradict each other.")
      .def_property_readonly(
          "contacts", [](const Identification& self) { return self.contacts.size(); },
          "Number of contacts between tool and objects.")
      .def("contacts_left_out", &Identification::contacts_left_out,
           "The number of contacts that were not used, by reason.")
      .def(
          "write_report",
          [](const Identification& self, const py::object& folder, const std::string& title,
             bool replace) {
            OutputFolder output = value_of(OutputFolder::create(
                path_of(folder, "folder"), {.kind = OutputKind::report, .replace = replace}));
            check(write_identification_report(self, title, output.path()));
            check(output.commit());
          },
          py::arg("folder"), py::arg("title") = "recording", py::arg("replace") = false,
          "Writes report.html and report.json into a new folder.");
}

constexpr char kIdentifyDoc[] = R"(Identifies one object's contact and friction from arrays.

All poses are in one base frame, with z up; a pose is x y z [m] qx qy qz qw (unit quaternion).
Times t [s] ascend strictly; the three series may have different times, on one clock.

tool     (t, poses): (N,), and (N, 7) poses of the tool, or (N, 3) positions [m] of its tip's centre
wrench   (t, wrench): (M,), and (M, 3) force [N] that the tool exerts on the object, in base axes;
         of (M, 6) the torque is not used
tracked  (t, poses): (K,), and (K, 7) poses of the object; None: it is not tracked
cad      a mesh file, or a pair of vertices (V, 3) [m] and triangles (T, 3), in the object's frame,
         closed, with outward winding

goal         'friction': pushes, for F_M, mu, mass and turning; 'contact': presses, for the contact
             law alone
mass         [kg] where the object was weighed
tool_radius  [m] of the tool's spherical tip
pose         (7,) of the object at the start; by default its first tracked one
movable      False: it does not move under any force, and only the contact law is identified
name         of the object, in texts
cad_unit     [m] of the coordinates in a mesh file: 0.001 for millimetres
tracked_std  [m] and [rad] of a tracked pose
known        Parameters identified earlier; friction is combined with them, other results replace
             them
options      a dict from "section.key" to number, as `pcavr --print-config` lists them

Rows that repeat the row before at the pace of a slower source are left out, with a note. Returns
Identified. Releases the GIL. Raises TypeError for what is not an array of numbers, and Error for
wrong shapes, numbers that are not finite, times that do not ascend, a mesh that is not closed,
series without a contact, and series that show another sign, axes, unit or clock of the force than
they are given with.)";

constexpr char kIdentifyRecordingDoc[] = R"(Identifies all objects of a recording folder.

goal      'friction' or 'contact', see identify
scene     a scene folder from build, for bodies and poses; by default those of recording.yaml
tracked   a folder with objects/NAME/tracked.txt; by default the recording's own, else images are
          tracked (with a scene)
known     a dict from object to Parameters identified earlier
skip_bad  skips bad rows and frames instead of raising
threads   0: all cores
progress  called with stage, done and total; what it raises ends the call

Returns Identification. Releases the GIL; Ctrl-C ends it at the next progress. Raises Error with
file, line and place.)";

}  // namespace

void bind_identification(py::module_& module) {
  bind_finding(module);
  bind_results(module);
  module.def("identify", &identify_arrays, py::arg("tool"), py::arg("wrench"), py::arg("tracked"),
             py::arg("cad"), py::kw_only(), py::arg("goal") = "friction",
             py::arg("mass") = py::none(), py::arg("tool_radius") = 0.01,
             py::arg("pose") = py::none(), py::arg("movable") = true, py::arg("name") = "object",
             py::arg("cad_unit") = 1.0, py::arg("tracked_std") = std::pair(0.001, 0.010),
             py::arg("known") = py::none(), py::arg("options") = py::none(), kIdentifyDoc);
  module.def("identify_recording", &identify_recording, py::arg("recording"), py::kw_only(),
             py::arg("goal") = "friction", py::arg("scene") = py::none(),
             py::arg("tracked") = py::none(), py::arg("known") = ParameterTable(),
             py::arg("skip_bad") = false, py::arg("threads") = 0, py::arg("options") = py::none(),
             py::arg("progress") = py::none(), kIdentifyRecordingDoc);
}

}  // namespace pcavr::python
