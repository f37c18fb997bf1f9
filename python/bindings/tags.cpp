// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "images.hpp"
#include "tag_placement.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr std::array kStatusNames{"solved", "ambiguous", "not_seen", "failed"};

Numbers corners_of(const TagDetection& detection) {
  Numbers corners({4, 2});
  for (std::size_t i = 0; i < detection.corners.size(); ++i) {
    Eigen::Map<Eigen::Vector2d>(corners.mutable_data() + 2 * i) = detection.corners[i];
  }
  return corners;
}

TagDetection make_detection(const std::string& family, int id, const py::object& corners,
                            double corner_std) {
  TagDetection detection{.id = tag_id_of(family, id), .corners = {}, .corner_std = corner_std};
  const Numbers rows = numbers_of(corners, "corners", {4, 2});
  for (std::size_t i = 0; i < detection.corners.size(); ++i) {
    detection.corners[i] = Eigen::Vector2d::Map(rows.data() + 2 * i);
  }
  if (!std::isfinite(corner_std) || corner_std < 0.0) {
    raise_error({.message = "is not a std", .place = "corner_std", .hint = "0: not known"});
  }
  return detection;
}

/// A detector that several threads of Python may share: without the GIL they wait for each other.
struct SharedDetector {
  TagDetector detector;
  std::mutex in_use = {};
};

std::unique_ptr<SharedDetector> make_detector(const std::vector<std::string>& families,
                                              const std::optional<CameraModel>& camera) {
  TagDetectorOptions options;
  if (camera && camera->has_distortion()) options.lens = camera;
  return std::unique_ptr<SharedDetector>(
      new SharedDetector{value_of(TagDetector::create(families, options))});
}

std::vector<TagDetection> detect(SharedDetector& shared, const py::object& image) {
  const GrayImage gray = gray_image_of(image, "image");
  const py::gil_scoped_release released;
  const std::lock_guard lock(shared.in_use);
  return shared.detector.detect(gray);
}

BodyPose body_pose(const std::vector<TagPlacement>& tags,
                   const std::vector<TagDetection>& detections, const CameraModel& camera,
                   const py::object& depth, const py::object& last_pose) {
  BodyPoseHints hints;
  DepthImage depth_image;
  if (!depth.is_none()) {
    depth_image = depth_image_of(depth, "depth");
    const bool fits = depth_image.width() > 0 && camera.width % depth_image.width() == 0 &&
                      depth_image.height() * (camera.width / depth_image.width()) == camera.height;
    if (!fits) {
      raise_error({.message = "the depth image has not the camera's size, divided by one factor",
                   .place = "depth"});
    }
    hints.depth = &depth_image;
  }
  if (!last_pose.is_none()) hints.T_camera_body = pose_of(last_pose, "last_pose");
  const py::gil_scoped_release released;
  return solve_body_pose(tags, detections, camera, hints);
}

void bind_detection(py::module_& module) {
  py::class_<TagDetection>(module, "TagDetection", "A tag in an image.")
      .def(py::init(&make_detection), py::arg("family"), py::arg("id"), py::arg("corners"),
           py::kw_only(), py::arg("corner_std") = 0.0,
           R"(Of another detector than TagDetector.

family      of tag_families()
id          its number in the family
corners     (4, 2) [px], in the order of the property
corner_std  std of one coordinate of a corner [px]; 0: not known

Raises Error for an unknown family, and corners that are not finite.)")
      .def_property_readonly(
          "family", [](const TagDetection& self) { return self.id.family; }, "Of tag_families().")
      .def_property_readonly(
          "id", [](const TagDetection& self) { return self.id.id; }, "Its number in the family.")
      .def_property_readonly("corners", &corners_of,
                             R"((4, 2) [px], in the order (-,-) (+,-) (+,+) (-,+) of the tag's frame
(x right, y up, seen upright); the centre of pixel (0, 0) is at (0, 0).)")
      .def_readonly("hamming", &TagDetection::hamming, "Number of bits that were corrected.")
      .def_readonly("decision_margin", &TagDetection::decision_margin,
                    "Mean contrast between bits and threshold, of 255.")
      .def_readonly("corner_std", &TagDetection::corner_std,
                    "Std of one coordinate of a corner [px]; 0: not known.")
      .def("__repr__", [](const TagDetection& self) {
        return fmt::format("<TagDetection {}>", self.id.to_string());
      });
}

void bind_body_pose(py::module_& module) {
  py::class_<BodyPose>(module, "BodyPose", "The pose of a body in the camera, by its tags.")
      .def_property_readonly(
          "status",
          [](const BodyPose& self) { return kStatusNames[static_cast<std::size_t>(self.status)]; },
          "'solved'; 'ambiguous': two solutions fit equally well, and pose is the better one;\n"
          "'not_seen': none of its tags was detected; 'failed': no pose fits the corners.")
      .def_property_readonly(
          "pose",
          [](const BodyPose& self) -> py::object {
            const bool has_pose =
                self.status == BodyPoseStatus::solved || self.status == BodyPoseStatus::ambiguous;
            if (!has_pose) return py::none();
            return array_of(self.pose.T_camera_body);
          },
          "(7,) x y z [m] qx qy qz qw in camera axes; None where there is none.")
      .def_property_readonly(
          "reprojection_rms", [](const BodyPose& self) { return self.pose.reprojection_rms; },
          "[px]")
      .def_property_readonly(
          "second_pose",
          [](const BodyPose& self) -> py::object {
            if (!self.second_solution) return py::none();
            return array_of(self.second_solution->T_camera_body);
          },
          "(7,) the other solution of the planar ambiguity; None: there is none.")
      .def_property_readonly(
          "covariance",
          [](const BodyPose& self) {
            Numbers covariance({6, 6});
            Eigen::Map<Matrix6d>(covariance.mutable_data()) = self.covariance;
            return covariance;
          },
          "(6, 6) of the twist [v; w] in body axes: T exp([v; w]).")
      .def_readonly("tags_used", &BodyPose::tags_used, "Number of tags.")
      .def_readonly("tags_rejected", &BodyPose::tags_rejected,
                    "Number of tags that contradict the others.");
}

py::tuple tag_cells(const std::string& family, int id) {
  const TagPicture picture = value_of(tag_picture(family, id));
  py::array_t<bool> cells({picture.cells, picture.cells});
  std::copy(picture.is_white.begin(), picture.is_white.end(), cells.mutable_data());
  return py::make_tuple(cells, picture.border);
}

}  // namespace

void bind_tags(py::module_& module) {
  bind_tag_placement(module);
  bind_detection(module);
  bind_body_pose(module);
  module.def("tag_families", &tag_families, "Names of the supported tag families.");
  module.def("tag_cells", &tag_cells, py::arg("family"), py::arg("id"),
             R"(The picture of a tag: (cells, border).

cells   (n, n) bool, True where white, the top row first, without the quiet zone
border  number of cells from the picture's edge to the square through the detection corners

Raises Error for an unknown family, and an id that is not in it.)");
  py::class_<SharedDetector>(module, "TagDetector", R"(Detects AprilTags and ArUco tags.

Between full searches only regions around the previous image's tags are searched: use one detector
for each stream of images.)")
      .def(py::init(&make_detector), py::arg("families"), py::kw_only(),
           py::arg("camera") = py::none(),
           "families  a list of names, see tag_families\n"
           "camera    Camera whose lens distortion is taken into account\n\n"
           "Raises Error for an unknown family.")
      .def(
          "detect", &detect, py::arg("image"),
          "A list of TagDetection in an image (H, W) or (H, W, 3) uint8, sorted by id; ids at two\n"
          "places are left out. Releases the GIL. Raises TypeError for another dtype, and Error "
          "for\n"
          "another shape.");
  module.def("body_pose", &body_pose, py::arg("tags"), py::arg("detections"), py::arg("camera"),
             py::kw_only(), py::arg("depth") = py::none(), py::arg("last_pose") = py::none(),
             R"(The BodyPose of a rigid body from all of its tags at once.

tags        a list of Tag, in the body's frame
detections  of TagDetector.detect
camera      Camera of the image
depth       (H, W) float [m], registered to the image, resolves the planar ambiguity
last_pose   (7,) in the previous image, does so, too)");
}

}  // namespace pcavr::python
