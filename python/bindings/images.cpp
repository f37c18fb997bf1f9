// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "images.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

constexpr py::ssize_t kMaxSide = 65500;  // [px] as of the readers

py::array image_array(const py::handle& argument, const std::string& name, char kind,
                      const char* expected) {
  py::array array;
  if (!argument.is_none()) array = py::array::ensure(argument);
  if (!array || argument.is_none() || array.dtype().kind() != kind ||
      (kind == 'u' && array.itemsize() != 1)) {
    throw py::type_error(name + ": an array of " + expected + " is expected");
  }
  return array;
}

void check_image_shape(const py::array& array, const std::string& name, bool is_valid) {
  if (is_valid && array.shape(0) > 0 && array.shape(1) > 0 && array.shape(0) <= kMaxSide &&
      array.shape(1) <= kMaxSide) {
    return;
  }
  raise_error({.message = "the array's shape is not an image's",
               .place = name,
               .hint = "(height, width), or (height, width, 3) of colour"});
}

template <typename T>
py::array_t<T, py::array::c_style | py::array::forcecast> contiguous(const py::array& array) {
  auto copy = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!copy) throw py::error_already_set();
  return copy;
}

}  // namespace

ColorImage color_image_of(const py::handle& argument, const std::string& name) {
  const py::array array = image_array(argument, name, 'u', "uint8");
  check_image_shape(array, name, array.ndim() == 3 && array.shape(2) == 3);
  const auto bytes = contiguous<std::uint8_t>(array);
  ColorImage image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  static_assert(sizeof(Rgb8) == 3);
  std::memcpy(image.pixels().data(), bytes.data(), static_cast<std::size_t>(bytes.size()));
  return image;
}

GrayImage gray_image_of(const py::handle& argument, const std::string& name) {
  const py::array array = image_array(argument, name, 'u', "uint8");
  if (array.ndim() == 3) return to_gray(color_image_of(argument, name));
  check_image_shape(array, name, array.ndim() == 2);
  const auto bytes = contiguous<std::uint8_t>(array);
  GrayImage image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  std::copy_n(bytes.data(), bytes.size(), image.pixels().data());
  return image;
}

DepthImage depth_image_of(const py::handle& argument, const std::string& name) {
  const py::array array = image_array(argument, name, 'f', "floating-point numbers [m]");
  check_image_shape(array, name, array.ndim() == 2);
  const auto depths = contiguous<float>(array);
  DepthImage image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  std::transform(depths.data(), depths.data() + depths.size(), image.pixels().data(),
                 [](float z) { return std::isfinite(z) && z > 0.0F ? z : 0.0F; });
  return image;
}

}  // namespace pcavr::python
