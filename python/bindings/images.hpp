// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <pybind11/numpy.h>

#include "pcavr/base/geometry/image.hpp"

/// Images from arrays of any strides: a wrong dtype is a TypeError, a wrong shape pcavr.Error.
namespace pcavr::python {

/// (H, W, 3) uint8.
[[nodiscard]] ColorImage color_image_of(const pybind11::handle& argument, const std::string& name);
/// (H, W) uint8; (H, W, 3) uint8 is converted to grey.
[[nodiscard]] GrayImage gray_image_of(const pybind11::handle& argument, const std::string& name);
/// (H, W) of real numbers [m]; NaN becomes 0, which is "not measured".
[[nodiscard]] DepthImage depth_image_of(const pybind11::handle& argument, const std::string& name);

}  // namespace pcavr::python
