// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "pcavr/pipeline/calibrate_depth.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "interruptible.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr int kMaxFrames = 100'000;  // as of the command

/// A calibration, what it is of, and how many views there were.
struct CalibratedDepth {
  DepthCalibration found;
  std::string source;  ///< the recording; "arrays" for distances in memory
  std::size_t views = 0;
  std::size_t places = 0;
};

/// Each row is of a place of its own.
DepthViews views_of(const py::object& argument) {
  const auto [depth, expected] = pair_of(argument, "recording", "(measured, expected)");
  const Numbers measured = numbers_of(depth, "measured", {kAnySize});
  const Numbers truth = numbers_of(expected, "expected", {measured.shape(0)});
  DepthViews views{.places = static_cast<std::size_t>(measured.shape(0))};
  for (py::ssize_t i = 0; i < measured.shape(0); ++i) {
    for (const auto& [values, name] : {std::pair{&measured, "measured"}, {&truth, "expected"}}) {
      if (values->at(i) > 0.0) continue;
      raise_error({.message = "is not a distance above 0 m",
                   .place = std::string(name) + '[' + std::to_string(i) + ']'});
    }
    views.views.push_back(
        {.place = static_cast<std::size_t>(i), .by_depth = measured.at(i), .by_tags = truth.at(i)});
  }
  return views;
}

Expected<CalibratedDepth> calibrate(const DepthViews& views, const std::string& source) {
  Expected<DepthCalibration> found = calibrate_depth(views);
  if (found) return CalibratedDepth{*std::move(found), source, views.views.size(), views.places};
  Error error = found.error();
  if (source == "arrays") {
    error.place = "measured";
  } else {
    error.file = source;
  }
  return error;
}

bool is_pair(const py::object& argument) {
  return py::isinstance<py::tuple>(argument) || py::isinstance<py::list>(argument);
}

CalibratedDepth calibrate_depth_of(const py::object& recording, int frames, bool skip_bad,
                                   const py::object& progress) {
  if (frames < 1 || frames > kMaxFrames) {
    raise_error({.message = std::to_string(frames) + " images are not from 1 to " +
                            std::to_string(kMaxFrames),
                 .place = "frames"});
  }
  if (is_pair(recording)) {
    const DepthViews views = views_of(recording);
    return run_interruptible(progress, [&](const Observer&) { return calibrate(views, "arrays"); });
  }
  const DepthInput input{.recording = path_of(recording, "recording"),
                         .max_frames = static_cast<std::size_t>(frames),
                         .skip_bad = skip_bad};
  return run_interruptible(progress, [&](const Observer& observer) -> Expected<CalibratedDepth> {
    const Expected<DepthViews> views = read_depth_views(input, observer);
    if (!views) return views.error();
    return calibrate(*views, input.recording.string());
  });
}

/// None for distances, which say nothing of a plane.
std::optional<double> of_planes(const CalibratedDepth& self, double value) {
  return self.source == "arrays" ? std::nullopt : std::optional(value);
}

template <typename T>
auto of_found(T DepthCalibration::*member) {
  return [member](const CalibratedDepth& self) { return self.found.*member; };
}

void bind_calibrated_depth(py::module_& module) {
  py::class_<CalibratedDepth>(module, "CalibratedDepth",
                              "True depth = scale * measured depth + offset.")
      .def_property_readonly("scale", of_found(&DepthCalibration::scale), "True over measured.")
      .def_property_readonly("scale_std", of_found(&DepthCalibration::scale_std), "Of the scale.")
      .def_property_readonly(
          "offset",
          [](const CalibratedDepth& self) {
            return self.found.has_offset ? std::optional(self.found.offset) : std::nullopt;
          },
          "[m]; None: the distances are too alike to show it.")
      .def_property_readonly(
          "offset_std",
          [](const CalibratedDepth& self) {
            return self.found.has_offset ? std::optional(self.found.offset_std) : std::nullopt;
          },
          "[m]; None where the offset is.")
      .def_property_readonly(
          "covariance",
          [](const CalibratedDepth& self) {
            Numbers covariance({2, 2});
            Eigen::Map<Eigen::Matrix2d>(covariance.mutable_data()) = self.found.covariance;
            return covariance;
          },
          "(2, 2) of scale and offset [m].")
      .def_property_readonly("depth_scale", of_found(&DepthCalibration::depth_scale),
                             "Units a metre, for a recording's camera; of arrays those of 1.")
      .def_property_readonly("depth_offset", of_found(&DepthCalibration::depth_offset),
                             "[m] for a recording's camera.")
      .def_property_readonly("nearest", of_found(&DepthCalibration::nearest), "[m] of the views.")
      .def_property_readonly("farthest", of_found(&DepthCalibration::farthest), "[m] of the views.")
      .def_property_readonly("before_rms", of_found(&DepthCalibration::before_rms),
                             "[m] of the places' errors, as the depth was read.")
      .def_property_readonly("fitted_rms", of_found(&DepthCalibration::fitted_rms),
                             "[m] with the correction.")
      .def_property_readonly("held_out_rms", of_found(&DepthCalibration::held_out_rms),
                             "[m] of each place by the others.")
      .def_property_readonly(
          "plane_rms",
          [](const CalibratedDepth& self) { return of_planes(self, self.found.plane_rms); },
          "[m] of a tag's pixels about their plane; None for arrays.")
      .def_property_readonly(
          "plane_tilt",
          [](const CalibratedDepth& self) { return of_planes(self, self.found.plane_tilt); },
          "[rad] of that plane against the tag's; None for arrays.")
      .def_readonly("views", &CalibratedDepth::views, "Number of views of a tag.")
      .def_readonly("places", &CalibratedDepth::places, "Number of places they are from.")
      .def_property_readonly(
          "verdict", [](const CalibratedDepth& self) { return describe_depth(self.found); },
          "A sentence: whether the depth agrees.")
      .def_property_readonly("notes", of_found(&DepthCalibration::notes), "Lines for the user.")
      .def(
          "text",
          [](const CalibratedDepth& self) {
            return format_depth(self.found, {.recording = self.source});
          },
          "The text of a calibration that a recording names (`calibration:`).");
}

}  // namespace

void bind_depth_calibration(py::module_& module) {
  bind_calibrated_depth(module);
  module.def("calibrate_depth", &calibrate_depth_of, py::arg("recording"), py::kw_only(),
             py::arg("frames") = 300, py::arg("skip_bad") = false, py::arg("progress") = py::none(),
             R"(Finds a depth camera's scale and offset, as `calibrate depth`.

recording  folder with depth images of tags at several distances; or a pair (measured, expected) of
           (N,) [m]: distances along the optical axis by depth and as they are, each from a place of
           its own
frames     images to use at most, evenly spaced
skip_bad   leaves out rows and images that can't be read instead of raising
progress   called with stage, done and total (0: unknown); what it raises ends the call

Returns CalibratedDepth. Releases the GIL. Doubtful inputs are warnings of category DataWarning.
Raises Error for a recording without depth images or tags, for fewer than five places, and for
distances that are not above 0.)");
}

}  // namespace pcavr::python
