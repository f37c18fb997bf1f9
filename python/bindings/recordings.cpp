// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "camera.hpp"
#include "errors.hpp"
#include "views.hpp"

// A series of the recording, not a list that is copied.
PYBIND11_MAKE_OPAQUE(std::vector<pcavr::WrenchSample>)

namespace pcavr::python {
namespace py = pybind11;
namespace {

/// A recording with the objects' own tracking, as Python holds it.
struct RecordingFolder {
  Recording recording;
  std::map<std::string, Trajectory> tracked;  ///< by object
};

/// Times in seconds as an array of their own.
template <typename Elements>
Numbers seconds_of(const Elements& elements) {
  Numbers t(static_cast<py::ssize_t>(elements.size()));
  double* out = t.mutable_data();
  for (const auto& element : elements) *out++ = element.stamp.seconds();
  return t;
}

template <typename Element>
py::object stamps_view(const std::vector<Element>& elements, const py::handle& owner) {
  const py::array_t<std::int64_t> column = member_view(
      elements, 1, [](const Element& each) { return &each.stamp.nanoseconds; }, owner);
  return column.attr("__getitem__")(py::make_tuple(py::ellipsis(), 0));
}

Numbers poses_of(const Trajectory& trajectory) {
  Numbers poses({static_cast<py::ssize_t>(trajectory.size()), py::ssize_t{7}});
  double* row = poses.mutable_data();
  for (const TimedPose& each : trajectory.poses()) {
    Eigen::Map<Eigen::Vector3d> position(row);
    Eigen::Map<Eigen::Vector4d> quaternion(row + 3);
    position = each.pose.translation();
    quaternion = each.pose.rotation().coeffs();
    row += 7;
  }
  return poses;
}

std::filesystem::path tracked_file(const Recording& recording, const std::string& object) {
  return recording.folder / "tracked" / "objects" / object / "tracked.txt";
}

Expected<RecordingFolder> read_folder(const std::filesystem::path& folder, bool skip_bad) {
  ReadOptions options;
  options.skip_bad = skip_bad;
  Expected<Recording> recording = read_recording(folder, options);
  if (!recording) return recording.error();
  RecordingFolder result{*std::move(recording), {}};
  for (const ObjectEntry& object : result.recording.manifest.objects) {
    const std::filesystem::path file = tracked_file(result.recording, object.name);
    std::error_code code;
    if (!std::filesystem::exists(file, code)) continue;
    Expected<Trajectory> tracked = read_trajectory(file);
    if (!tracked) return tracked.error();
    result.tracked.emplace(object.name, *std::move(tracked));
  }
  return result;
}

void bind_series(py::module_& module) {
  py::class_<Trajectory>(module, "Trajectory",
                         R"(Poses of one frame in another, in ascending order of time.

Arrays that are views read the recording's memory, are read-only, and keep it alive.)")
      .def("__len__", &Trajectory::size)
      .def_property_readonly(
          "t", [](const Trajectory& self) { return seconds_of(self.poses()); }, "(N,) [s], a copy.")
      .def_property_readonly(
          "stamps",
          [](const py::object& self) {
            return stamps_view(self.cast<const Trajectory&>().poses(), self);
          },
          "(N,) int64 [ns], exact; a view.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            return member_view(
                self.cast<const Trajectory&>().poses(), 3,
                [](const TimedPose& each) { return each.pose.translation().data(); }, self);
          },
          "(N, 3) [m]; a view.")
      .def_property_readonly(
          "quaternions",
          [](const py::object& self) {
            return member_view(
                self.cast<const Trajectory&>().poses(), 4,
                [](const TimedPose& each) { return each.pose.rotation().coeffs().data(); }, self);
          },
          "(N, 4) unit quaternions x y z w; a view.")
      .def_property_readonly("poses", &poses_of, "(N, 7) x y z [m] qx qy qz qw, a copy.")
      .def(
          "at",
          [](const Trajectory& self, double t, double max_gap) -> py::object {
            const std::optional<Pose> pose =
                self.at(Stamp::from_seconds(t), duration_from_seconds(max_gap));
            if (!pose) return py::none();
            return array_of(*pose);
          },
          py::arg("t"), py::arg("max_gap") = 0.2,
          "The pose (7,) interpolated at t [s]; None outside, and in a gap longer than max_gap "
          "[s].");

  using Wrenches = std::vector<WrenchSample>;
  py::class_<Wrenches>(module, "WrenchSeries",
                       "Force and torque that the tool exerts on its environment, at its tip, in "
                       "base axes.")
      .def("__len__", &Wrenches::size)
      .def_property_readonly("t", &seconds_of<Wrenches>, "(N,) [s], a copy.")
      .def_property_readonly(
          "stamps",
          [](const py::object& self) { return stamps_view(self.cast<const Wrenches&>(), self); },
          "(N,) int64 [ns], exact; a view.")
      .def_property_readonly(
          "forces",
          [](const py::object& self) {
            return member_view(
                self.cast<const Wrenches&>(), 3,
                [](const WrenchSample& each) { return each.force.data(); }, self);
          },
          "(N, 3) [N]; a view.")
      .def_property_readonly(
          "torques",
          [](const py::object& self) {
            return member_view(
                self.cast<const Wrenches&>(), 3,
                [](const WrenchSample& each) { return each.torque.data(); }, self);
          },
          "(N, 3) [N m]; a view.");
}

void bind_frame(py::module_& module) {
  py::class_<RgbdFrame>(module, "Frame", "A colour and a depth image, decoded.")
      .def_property_readonly(
          "t", [](const RgbdFrame& self) { return self.color_stamp.seconds(); },
          "Of the colour image [s].")
      .def_property_readonly(
          "depth_t", [](const RgbdFrame& self) { return self.depth_stamp.seconds(); },
          "Of the depth image [s].")
      .def_property_readonly(
          "color",
          [](const py::object& self) {
            const ColorImage& image = self.cast<const RgbdFrame&>().color;
            const auto row = static_cast<py::ssize_t>(sizeof(Rgb8)) * image.width();
            return view_of<std::uint8_t>(&image.pixels().data()->r,
                                         {image.height(), image.width(), 3},
                                         {row, static_cast<py::ssize_t>(sizeof(Rgb8)), 1}, self);
          },
          "(H, W, 3) uint8, sRGB; a view.")
      .def_property_readonly(
          "depth",
          [](const py::object& self) {
            const DepthImage& image = self.cast<const RgbdFrame&>().depth;
            const auto row = static_cast<py::ssize_t>(sizeof(float)) * image.width();
            return view_of<float>(image.pixels().data(), {image.height(), image.width()},
                                  {row, static_cast<py::ssize_t>(sizeof(float))}, self);
          },
          "(H, W) float32 [m] along the optical axis, 0 where nothing was measured; a view.\n"
          "Registered to colour, on its grid or on a coarser one.");
}

void bind_object_entry(py::module_& module) {
  py::class_<ObjectEntry>(module, "ObjectEntry", "An object as recording.yaml states it.")
      .def_readonly("name", &ObjectEntry::name, "As in file and folder names.")
      .def_readonly("mesh", &ObjectEntry::mesh, "Relative to the recording's folder; may be empty.")
      .def_readonly("mesh_unit", &ObjectEntry::mesh_unit, "[m] of the mesh's coordinates.")
      .def_readonly("mass", &ObjectEntry::mass, "[kg]; None: not weighed.")
      .def_readonly("is_movable", &ObjectEntry::is_movable, "False: it keeps its pose.")
      .def_property_readonly(
          "pose",
          [](const ObjectEntry& self) -> py::object {
            if (!self.T_base_object) return py::none();
            return array_of(*self.T_base_object);
          },
          "(7,) in base at the start; None: not stated.");
}

void bind_recording(py::module_& module) {
  py::class_<RecordingFolder>(module, "Recording", R"(The content of a recording folder.

Images are decoded by frame(); all else is in memory, also after the folder is gone.)")
      .def_property_readonly(
          "folder", [](const RecordingFolder& self) { return self.recording.folder; },
          "As it was given.")
      .def_property_readonly(
          "tool",
          [](const RecordingFolder& self) -> const Trajectory& { return self.recording.tool; },
          py::return_value_policy::reference_internal, "Trajectory of the tool in base.")
      .def_property_readonly(
          "camera_poses",
          [](const RecordingFolder& self) -> const Trajectory& {
            return self.recording.groundtruth;
          },
          py::return_value_policy::reference_internal,
          "Trajectory of the camera in base, of groundtruth.txt.")
      .def_property_readonly(
          "wrench",
          [](const RecordingFolder& self) -> const std::vector<WrenchSample>& {
            return self.recording.wrench;
          },
          py::return_value_policy::reference_internal, "WrenchSeries.")
      .def_property_readonly(
          "tracked",
          [](const py::object& self) {
            py::dict tracked;
            for (const auto& [name, poses] : self.cast<const RecordingFolder&>().tracked) {
              tracked[py::str(name)] =
                  py::cast(poses, py::return_value_policy::reference_internal, self);
            }
            return tracked;
          },
          "A dict from object to the Trajectory in the recording's own folder `tracked`.")
      .def_property_readonly(
          "objects", [](const RecordingFolder& self) { return self.recording.manifest.objects; },
          "A list of ObjectEntry.")
      .def_property_readonly(
          "tool_radius",
          [](const RecordingFolder& self) { return self.recording.manifest.tool_radius; },
          "[m] of the tool's spherical tip; None: not stated.")
      .def_property_readonly(
          "camera", [](const RecordingFolder& self) { return self.recording.manifest.camera; },
          "Camera; None without images.")
      .def_property_readonly(
          "frame_t",
          [](const RecordingFolder& self) {
            Numbers t(static_cast<py::ssize_t>(self.recording.frames.size()));
            double* out = t.mutable_data();
            for (const FrameFiles& files : self.recording.frames) {
              *out++ = files.color_stamp.seconds();
            }
            return t;
          },
          "(F,) [s] of the colour images.")
      .def_property_readonly(
          "warnings", [](const RecordingFolder& self) { return self.recording.warnings; },
          "Lines for the user.")
      .def_property_readonly(
          "notes", [](const RecordingFolder& self) { return self.recording.notes; },
          "What was put right in the streams.")
      .def_property_readonly(
          "rows_left_out",
          [](const RecordingFolder& self) { return self.recording.skipped_rows(); },
          "Number of rows that skip_bad skipped.")
      .def(
          "frame",
          [](const RecordingFolder& self, py::ssize_t index) {
            const auto count = static_cast<py::ssize_t>(self.recording.frames.size());
            if (index < 0) index += count;
            if (index < 0 || index >= count) throw py::index_error("frame index out of range");
            Expected<RgbdFrame> frame = [&] {
              const py::gil_scoped_release released;
              return decode_frame(self.recording, static_cast<std::size_t>(index));
            }();
            return value_of(std::move(frame));
          },
          py::arg("index"),
          "Decodes a Frame; negative indices count from the end. Raises Error for an image that "
          "is\n"
          "missing or does not decode. Releases the GIL.")
      .def("__repr__", [](const RecordingFolder& self) {
        return fmt::format("<Recording {}: {} frames, {} tool poses, {} forces>",
                           self.recording.folder.string(), self.recording.frames.size(),
                           self.recording.tool.size(), self.recording.wrench.size());
      });
}

}  // namespace

void bind_recordings(py::module_& module) {
  bind_camera(module);
  bind_series(module);
  bind_frame(module);
  bind_object_entry(module);
  bind_recording(module);
  module.def(
      "read_recording",
      [](const py::object& folder, bool skip_bad) {
        const std::filesystem::path path = path_of(folder, "folder");
        Expected<RecordingFolder> recording = [&] {
          const py::gil_scoped_release released;
          return read_folder(path, skip_bad);
        }();
        return value_of(std::move(recording));
      },
      py::arg("folder"), py::kw_only(), py::arg("skip_bad") = false,
      R"(Reads a Recording, strictly; images are not decoded yet.

skip_bad  skips bad rows and frames instead of raising

Raises Error with file and line. Releases the GIL.)");
}

}  // namespace pcavr::python
