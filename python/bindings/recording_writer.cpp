// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/recording_writer.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "images.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

/// An object of a recording that is to be written.
struct ObjectToWrite {
  ObjectEntry entry;
  TriangleMesh mesh_object;  ///< [m]
  std::vector<TagPlacement> tags;
};

/// Names become folders and file names.
void check_name(const std::string& name) {
  const bool is_plain = !name.empty() && name.find('/') == name.npos && name.front() != '.';
  if (!is_plain) {
    raise_error({.message = "'" + name + "' is not a name for files",
                 .place = "name",
                 .hint = "use letters, digits and underscores"});
  }
}

ObjectToWrite make_object(const std::string& name, const py::object& cad,
                          std::optional<double> mass, const py::object& pose, bool movable,
                          const std::vector<TagPlacement>& tags, double cad_unit) {
  check_name(name);
  if (mass) {
    if (auto error = check_range(ranges::kMass, *mass)) {
      error->place = "mass";
      raise_error(*error);
    }
  }
  ObjectToWrite object{.entry = {.name = name,
                                 .mesh = std::filesystem::path("objects") / (name + ".obj"),
                                 .mass = mass,
                                 .is_movable = movable},
                       .mesh_object = cad_of(cad, name, cad_unit).mesh_object,
                       .tags = tags};
  if (!pose.is_none()) object.entry.T_base_object = pose_of(pose, "pose");
  return object;
}

struct ImagePair {
  Stamp stamp;
  ColorImage color;
  DepthImage depth;
};

ImagePair image_pair_of(const py::handle& argument, const CameraModel& camera,
                        const std::string& place) {
  if (!py::isinstance<py::tuple>(argument) || py::len(argument) != 3) {
    throw py::type_error(place + ": a tuple (t, color, depth) is expected");
  }
  const auto frame = py::reinterpret_borrow<py::tuple>(argument);
  ImagePair pair{Stamp::from_seconds(numbers_of(frame[0], place + " t", {}).data()[0]),
                 color_image_of(frame[1], place + " color"),
                 depth_image_of(frame[2], place + " depth")};
  if (pair.color.width() != camera.width || pair.color.height() != camera.height) {
    raise_error({.message = "the colour image has not the camera's size",
                 .place = place,
                 .hint = "an array (height, width, 3) is expected"});
  }
  return pair;
}

Manifest make_manifest(const std::vector<ObjectToWrite>& objects,
                       const std::vector<TagPlacement>& base_tags,
                       std::optional<double> tool_radius, const std::optional<CameraModel>& camera,
                       double depth_scale) {
  Manifest manifest;
  if (camera) {
    manifest.camera = camera;
    manifest.depth_scale = depth_scale;
  }
  manifest.tool_radius = tool_radius;
  const auto add_tags = [&](const std::vector<TagPlacement>& tags, MarkerRole role,
                            const std::string& object) {
    for (const TagPlacement& tag : tags) {
      manifest.markers.push_back({.id = tag.id,
                                  .size = tag.size,
                                  .role = role,
                                  .object = object,
                                  .T_parent_marker = tag.T_body_marker});
    }
  };
  add_tags(base_tags, MarkerRole::base, {});
  for (const ObjectToWrite& object : objects) {
    manifest.objects.push_back(object.entry);
    add_tags(object.tags, MarkerRole::object, object.entry.name);
  }
  // The reader's checks, before anything is written.
  static_cast<void>(value_of(parse_manifest(format_manifest(manifest), "recording.yaml")));
  return manifest;
}

void write_tracked(const std::filesystem::path& folder, const std::string& name,
                   const Trajectory& poses) {
  const std::filesystem::path target = folder / "tracked" / "objects" / name;
  std::error_code code;
  std::filesystem::create_directories(target, code);
  if (code) raise_error({.message = code.message(), .file = target.string()});
  check(write_file(target / "tracked.txt", format_trajectory(poses)));
}

/// The series of write_recording, checked.
struct SeriesToWrite {
  Trajectory tool, camera_poses;
  std::vector<WrenchSample> wrench;
  std::map<std::string, Trajectory> tracked;
};

SeriesToWrite series_of(const py::object& tool, const py::object& wrench, const py::dict& tracked,
                        const py::object& camera_poses, const std::vector<ObjectToWrite>& objects) {
  SeriesToWrite series;
  if (!tool.is_none()) series.tool = trajectory_of(tool, "tool");
  if (!camera_poses.is_none()) series.camera_poses = trajectory_of(camera_poses, "camera_poses");
  if (!wrench.is_none()) {
    const TimedRows rows = timed_rows_of(wrench, "wrench", {3, 6});
    for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
      const bool has_torque = rows.columns() == 6;
      series.wrench.push_back({rows.stamps[i], rows.vector(i),
                               has_torque ? rows.vector(i, 3) : Eigen::Vector3d(0.0, 0.0, 0.0)});
    }
  }
  for (const auto& [key, value] : tracked) {
    const std::string name = py::str(key);
    const bool is_object = std::any_of(objects.begin(), objects.end(), [&](const auto& object) {
      return object.entry.name == name;
    });
    if (!is_object) {
      raise_error({.message = "'" + name + "' is none of the objects", .place = "tracked"});
    }
    series.tracked[name] = trajectory_of(value, "tracked " + name);
  }
  return series;
}

void write_series(const SeriesToWrite& series, const std::vector<ObjectToWrite>& objects,
                  const std::filesystem::path& folder, RecordingWriter& writer) {
  if (!series.tool.empty()) check(writer.write_tool(series.tool));
  if (!series.camera_poses.empty()) check(writer.write_groundtruth(series.camera_poses));
  if (!series.wrench.empty()) check(writer.write_wrench(series.wrench));
  for (const ObjectToWrite& object : objects) {
    check(writer.write_object_mesh(object.entry.mesh, object.mesh_object));
  }
  for (const auto& [name, poses] : series.tracked) write_tracked(folder, name, poses);
}

void write_frames(const py::iterable& frames, const std::optional<CameraModel>& camera,
                  RecordingWriter& writer) {
  std::optional<Stamp> last;
  std::size_t index = 0;
  for (const py::handle& frame : frames) {
    const std::string place = "frames[" + std::to_string(index++) + ']';
    if (!camera) raise_error({.message = "frames need a camera", .place = "camera"});
    const ImagePair pair = image_pair_of(frame, *camera, place);
    if (last && pair.stamp <= *last) {
      raise_error({.message = "is not after the frame before it", .place = place});
    }
    last = pair.stamp;
    check([&] {
      const py::gil_scoped_release released;
      return writer.add_frame(pair.stamp, pair.color, pair.stamp, pair.depth);
    }());
  }
}

void write_recording(const py::object& target, const py::object& tool, const py::object& wrench,
                     const py::dict& tracked, const std::vector<ObjectToWrite>& objects,
                     std::optional<double> tool_radius, const py::iterable& frames,
                     const std::optional<CameraModel>& camera, double depth_scale,
                     const std::vector<TagPlacement>& base_tags, const py::object& camera_poses,
                     bool replace) {
  const SeriesToWrite series = series_of(tool, wrench, tracked, camera_poses, objects);
  const Manifest manifest = make_manifest(objects, base_tags, tool_radius, camera, depth_scale);
  OutputFolder output = value_of(OutputFolder::create(
      path_of(target, "folder"), {.kind = OutputKind::recording, .replace = replace}));
  RecordingWriter writer(output.path(), manifest);
  write_series(series, objects, output.path(), writer);
  write_frames(frames, camera, writer);
  check(writer.finish());
  // What a reader would refuse, such as a force out of range, is an error of the writer.
  const Expected<Recording> read = read_recording(output.path());
  if (!read) {
    Error error = read.error();
    error.file = std::filesystem::path(error.file).filename().string();
    raise_error(error);
  }
  check(output.commit());
}

}  // namespace

void bind_recording_writer(py::module_& module) {
  py::class_<ObjectToWrite>(module, "Object", "An object of a recording that is to be written.")
      .def(py::init(&make_object), py::arg("name"), py::arg("cad"), py::kw_only(),
           py::arg("mass") = py::none(), py::arg("pose") = py::none(), py::arg("movable") = true,
           py::arg("tags") = std::vector<TagPlacement>(), py::arg("cad_unit") = 1.0,
           R"(name      a name for files
cad       a mesh file, or a pair of vertices (V, 3) [m] and triangles (T, 3), closed
mass      [kg] where it was weighed
pose      (7,) x y z [m] qx qy qz qw in base at the start; needed without images
movable   False: it keeps its pose
tags      a list of Tag, in the object's frame
cad_unit  [m] of the coordinates in a mesh file

Raises Error for a mesh that is not closed, a name that is not a file's, a mass out of range.)")
      .def_property_readonly(
          "name", [](const ObjectToWrite& self) { return self.entry.name; }, "As given.");
  module.def("write_recording", &write_recording, py::arg("folder"), py::kw_only(),
             py::arg("tool") = py::none(), py::arg("wrench") = py::none(),
             py::arg("tracked") = py::dict(), py::arg("objects") = std::vector<ObjectToWrite>(),
             py::arg("tool_radius") = py::none(), py::arg("frames") = py::tuple(),
             py::arg("camera") = py::none(), py::arg("depth_scale") = 1000.0,
             py::arg("base_tags") = std::vector<TagPlacement>(),
             py::arg("camera_poses") = py::none(), py::arg("replace") = false,
             R"(Writes a recording folder from arrays, atomically; read_recording reads it back.

tool          (t, poses): (N,) [s], (N, 7) x y z [m] qx qy qz qw of the tool in base
wrench        (t, wrench): (M,), and (M, 3) force [N] that the tool exerts, in base axes, or (M, 6)
              with the torque [N m] at its tip
tracked       a dict from object to (t, poses), as of a tracker
objects       a list of Object
tool_radius   [m] of the tool's spherical tip
frames        an iterable of (t, color (H, W, 3) uint8, depth (H, W) float [m], 0 where unknown),
              in ascending order of t
camera        Camera of the frames
depth_scale   units of the depth images in one metre
base_tags     a list of Tag, in base
camera_poses  (t, poses) of the camera in base, where known
replace       replaces a recording that is there; other folders never are

Raises TypeError and Error as identify, and Error where the folder can't be written or what it would
hold can't be read.)");
}

}  // namespace pcavr::python
