// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>

#include "pcavr/base/geometry/camera.hpp"

#include "arrays.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr std::array kLensNames{std::pair{LensModel::plumb_bob, "plumb_bob"},
                                std::pair{LensModel::rational, "rational"},
                                std::pair{LensModel::fisheye, "fisheye"}};

LensDistortion distortion_of(const std::string& name, const py::object& coefficients) {
  const LensModel model = lens_of(name);
  const auto count = static_cast<py::ssize_t>(coefficient_count(model));
  const Numbers numbers = numbers_of(coefficients, "distortion", {count});
  return {model, {numbers.data(), static_cast<std::size_t>(count)}};
}

CameraModel make_camera(int width, int height, double fx, double fy, double cx, double cy,
                        const py::object& distortion, const std::string& lens) {
  const bool is_size = width > 0 && height > 0 && width <= 65500 && height <= 65500;
  if (!is_size) raise_error({.message = "width and height are not an image's", .place = "camera"});
  const bool is_focal = std::isfinite(fx) && std::isfinite(fy) && fx > 0.0 && fy > 0.0;
  if (!is_focal || !std::isfinite(cx) || !std::isfinite(cy)) {
    raise_error({.message = "focal lengths above 0 and a finite principal point are expected",
                 .place = "camera"});
  }
  CameraModel camera{.width = width, .height = height, .fx = fx, .fy = fy, .cx = cx, .cy = cy};
  if (!distortion.is_none()) camera.distortion = distortion_of(lens, distortion);
  if (const auto fold = find_fold(camera)) {
    raise_error({.message = fmt::format("the lens model is not one-to-one at pixel {:.0f}, {:.0f}",
                                        fold->pixel.x(), fold->pixel.y()),
                 .place = "distortion",
                 .hint = "check the order and signs of the coefficients"});
  }
  return camera;
}

}  // namespace

LensModel lens_of(const std::string& name) {
  for (const auto& [model, known] : kLensNames) {
    if (name == known) return model;
  }
  raise_error({.message = "'" + name + "' is not a lens model",
               .place = "lens",
               .hint = "give plumb_bob, rational or fisheye"});
}

void bind_camera(py::module_& module) {
  py::class_<CameraModel>(module, "Camera", R"(A pinhole camera with a lens, as in OpenCV and ROS.

Axes: x right, y down, z forward; the centre of pixel (0, 0) is at u = 0, v = 0.)")
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("fx"),
           py::arg("fy"), py::arg("cx"), py::arg("cy"), py::kw_only(),
           py::arg("distortion") = py::none(), py::arg("lens") = "plumb_bob",
           R"(All in pixels. `distortion` has the coefficients of the lens model: plumb_bob k1 k2 p1
p2 k3, rational k1 k2 p1 p2 k3 k4 k5 k6, fisheye k1 k2 k3 k4. Raises Error for a camera that can't
be, and a lens model that is not one-to-one in the image.)")
      .def_readonly("width", &CameraModel::width, "[px]")
      .def_readonly("height", &CameraModel::height, "[px]")
      .def_readonly("fx", &CameraModel::fx, "Focal length [px].")
      .def_readonly("fy", &CameraModel::fy, "Focal length [px].")
      .def_readonly("cx", &CameraModel::cx, "Principal point [px].")
      .def_readonly("cy", &CameraModel::cy, "Principal point [px].")
      .def_property_readonly(
          "distortion",
          [](const CameraModel& self) {
            const auto coefficients = self.distortion.coefficients();
            return std::vector<double>(coefficients.begin(), coefficients.end());
          },
          "Coefficients of the lens model.")
      .def_property_readonly(
          "lens",
          [](const CameraModel& self) {
            return kLensNames[static_cast<std::size_t>(self.distortion.model())].second;
          },
          "plumb_bob, rational or fisheye.")
      .def(
          "project",
          [](const CameraModel& self, const py::object& points) {
            const Numbers p = numbers_of(points, "points", {kAnySize, 3});
            Numbers pixels({p.shape(0), py::ssize_t{2}});
            for (py::ssize_t i = 0; i < p.shape(0); ++i) {
              if (p.at(i, 2) <= 0.0) {
                raise_error({.message = "is not in front of the camera",
                             .place = "points[" + std::to_string(i) + ']'});
              }
              Eigen::Map<Eigen::Vector2d>(pixels.mutable_data() + 2 * i) =
                  self.project(Eigen::Vector3d::Map(p.data() + 3 * i));
            }
            return pixels;
          },
          py::arg("points"), "Pixels (N, 2) of points (N, 3) [m] in camera axes, with z > 0.");
}

}  // namespace pcavr::python
