// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/stl.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/pipeline/calibrate_tags.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "option_names.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

using Tags = std::vector<TagPlacement>;
using TagName = std::variant<int, std::string>;  ///< 3 or "tag36h11:3"

constexpr std::array kTagFormats{std::pair{"pcavr", TagFileFormat::pcavr},
                                 std::pair{"apriltag_ros", TagFileFormat::apriltag_ros},
                                 std::pair{"tagslam", TagFileFormat::tagslam}};

void add_markers(const Tags& tags, const std::string& object, TagWalk& walk) {
  for (const TagPlacement& tag : tags) {
    walk.known.markers.push_back({.id = tag.id,
                                  .size = tag.size,
                                  .role = object.empty() ? MarkerRole::base : MarkerRole::object,
                                  .object = object,
                                  .T_parent_marker = tag.T_body_marker});
  }
}

TagWalk walk_of(const py::object& argument, const CameraModel& camera) {
  const auto [t, detections] = pair_of(argument, "walk", "(t, detections)");
  TagWalk walk{.camera = camera};
  walk.stamps = stamps_of(t, "walk t");
  try {
    walk.frames = detections.cast<std::vector<std::vector<TagDetection>>>();
  } catch (const py::cast_error&) {
    throw py::type_error("walk detections: a list of TagDetection for each image is expected");
  }
  if (walk.frames.size() != walk.stamps.size()) {
    raise_error({.message = std::to_string(walk.frames.size()) + " images have detections, " +
                            std::to_string(walk.stamps.size()) + " have times",
                 .place = "walk",
                 .hint = "give an empty list for an image without tags"});
  }
  return walk;
}

CalibratedTags calibrate_tags_of(const py::object& walk_argument, const CameraModel& camera,
                                 const Tags& tags, const std::map<std::string, Tags>& objects,
                                 std::optional<double> size, const std::vector<TagName>& fixed) {
  TagWalk walk = walk_of(walk_argument, camera);
  add_markers(tags, {}, walk);
  for (const auto& [name, of_object] : objects) {
    if (name.empty()) raise_error({.message = "an object has no name", .place = "objects"});
    add_markers(of_object, name, walk);
  }
  TagWalkInput input;
  if (size) {
    if (auto error = check_range(ranges::kTagSize, *size)) {
      error->place = "size";
      raise_error(*error);
    }
    input.size = size;
  }
  for (const TagName& name : fixed) {
    const int* id = std::get_if<int>(&name);
    input.fixed.push_back(id != nullptr ? std::to_string(*id) : std::get<std::string>(name));
  }
  return run_interruptible(py::none(),
                           [&](const Observer&) { return calibrate_tags(walk, input); });
}

std::string text_of_tags(const CalibratedTags& self, const std::string& format) {
  TagWalkInput input;
  input.input = "arrays";
  for (const auto& [name, known] : kTagFormats) {
    if (format == name) return format_tags(self, input, known);
  }
  raise_error({.message = "'" + format + "' is not a format of tag files",
               .place = "format",
               .hint = "give pcavr, apriltag_ros or tagslam"});
}

void bind_calibrated_tag(py::module_& module) {
  py::class_<LaidOutTag>(module, "CalibratedTag", "Where a tag is on its body, by the images.")
      .def_property_readonly(
          "family", [](const LaidOutTag& self) { return self.id.family; }, "Of tag_families().")
      .def_property_readonly(
          "id", [](const LaidOutTag& self) { return self.id.id; }, "Its number in the family.")
      .def_readonly("size", &LaidOutTag::size, "[m]")
      .def_property_readonly(
          "pose", [](const LaidOutTag& self) { return array_of(self.T_body_tag); },
          "(7,) in base, or in the object's frame.")
      .def_property_readonly("position_std", &LaidOutTag::position_std,
                             "[m] in the worst direction; 0: this tag alone is the reference.")
      .def_property_readonly("rotation_std", &LaidOutTag::rotation_std,
                             "[rad] about the worst axis.")
      .def_property_readonly(
          "covariance",
          [](const LaidOutTag& self) {
            Numbers covariance({6, 6});
            Eigen::Map<Matrix6d>(covariance.mutable_data()) = self.covariance;
            return covariance;
          },
          "(6, 6) of the twist [v; w] in the tag's axes, against the reference tags.")
      .def_readonly("images", &LaidOutTag::views, "Number of images that were used.")
      .def_readonly("left_out", &LaidOutTag::rejected,
                    "Number of images in which its corners do not fit.")
      .def_readonly("pixel_rms", &LaidOutTag::pixel_rms, "[px] of a corner.")
      .def_readonly("is_reference", &LaidOutTag::is_reference,
                    "True: its stated pose is one of those that define the frame.")
      .def_property_readonly(
          "offset",
          [](const LaidOutTag& self) {
            return self.shift ? std::optional(self.shift->offset) : std::nullopt;
          },
          "[m] from where it is said to be; None: nothing is stated.")
      .def_property_readonly(
          "has_moved",
          [](const LaidOutTag& self) {
            return self.move.has_value() || (self.shift && self.shift->has_moved);
          },
          "True: it is not where it is said to be, or was moved meanwhile.")
      .def_property_readonly(
          "moved_between",
          [](const LaidOutTag& self) {
            return self.move
                       ? std::optional(std::pair(self.move->last_before, self.move->first_after))
                       : std::nullopt;
          },
          "Rows of the images between which it was moved; None: it was not. Its pose is the "
          "later.");
}

void bind_calibrated_tags(py::module_& module) {
  py::class_<CalibratedTags>(module, "CalibratedTags", "Where the tags of base and objects are.")
      .def_property_readonly(
          "bodies",
          [](const CalibratedTags& self) {
            std::map<std::string, std::vector<LaidOutTag>> bodies;
            for (const CalibratedBody& body : self.bodies) bodies[body.name] = body.layout.tags;
            return bodies;
          },
          "{name: list of CalibratedTag} of objects; that of the base is ''.")
      .def_property_readonly("verdict", &describe_tags,
                             "A sentence: what has moved, or that all agree.")
      .def_property_readonly(
          "notes", [](const CalibratedTags& self) { return with_argument_names(self.notes); },
          "Lines for the user.")
      .def("text", &text_of_tags, py::arg("format") = "pcavr",
           R"(The text of a file of the tags.

format  'pcavr', a calibration that a recording names; 'apriltag_ros' or 'tagslam'

Raises Error for another format.)");
}

}  // namespace

void bind_tag_calibration(py::module_& module) {
  bind_calibrated_tag(module);
  bind_calibrated_tags(module);
  module.def("calibrate_tags", &calibrate_tags_of, py::arg("walk"), py::arg("camera"),
             py::arg("tags") = Tags(), py::kw_only(),
             py::arg("objects") = std::map<std::string, Tags>(), py::arg("size") = py::none(),
             py::arg("fixed") = std::vector<TagName>(),
             R"(Finds where tags are from images of a walk past them, as `calibrate tags`.

walk     (t, detections): (N,) s in ascending order, and for each image a list of TagDetection
camera   Camera of the images
tags     list of Tag of the base, with the poses where they are said to be
objects  {name: list of Tag} of movable objects
size     [m] of the tags in view that nothing names, which are then tags of the base
fixed    tags, as 3 or 'tag36h11:3', whose stated poses are right; by default the largest set of
         stated poses that agree

Returns CalibratedTags. Releases the GIL. Raises Error where no two tags are in one image, where a
fixed tag is not known, and where stated poses disagree and nothing shows which is right.)");
}

}  // namespace pcavr::python
