// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tag_placement.hpp"

#include <algorithm>
#include <string>

#include "pcavr/base/core/input_ranges.hpp"

#include "arrays.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

TagPlacement make_tag(const std::string& family, int id, double size, const py::object& pose) {
  const MarkerId tag = tag_id_of(family, id);
  if (auto error = check_range(ranges::kTagSize, size)) {
    error->place = "size";
    raise_error(*error);
  }
  return {tag, size, pose.is_none() ? Pose() : pose_of(pose, "pose")};
}

}  // namespace

MarkerId tag_id_of(const std::string& family, int id) {
  const std::vector<std::string>& families = tag_families();
  if (std::find(families.begin(), families.end(), family) == families.end()) {
    raise_error({.message = "'" + family + "' is not a family of tags",
                 .place = "family",
                 .hint = "pcavr.tag_families() lists them"});
  }
  if (id < 0) raise_error({.message = "is negative", .place = "id"});
  return {family, id};
}

void bind_tag_placement(py::module_& module) {
  py::class_<TagPlacement>(module, "Tag", "A tag on a body: in base, or on an object.")
      .def(py::init(&make_tag), py::arg("family"), py::arg("id"), py::arg("size"),
           py::arg("pose") = py::none(),
           R"(family  such as 'tag36h11', see tag_families
id      its number in the family
size    [m], the edge of the square through the detection corners
pose    (7,) x y z [m] qx qy qz qw in the body's frame; None: the body's frame is the tag's (x right,
        y up, z towards the viewer)

Raises Error for an unknown family and a size out of range.)")
      .def_property_readonly(
          "family", [](const TagPlacement& self) { return self.id.family; }, "As given.")
      .def_property_readonly(
          "id", [](const TagPlacement& self) { return self.id.id; }, "Its number in the family.")
      .def_readonly("size", &TagPlacement::size, "[m]")
      .def_property_readonly(
          "pose", [](const TagPlacement& self) { return array_of(self.T_body_marker); },
          "(7,) in the body's frame.");
}

}  // namespace pcavr::python
