// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "pcavr/base/geometry/lens.hpp"

namespace pcavr::python {

/// The lens model of a name; raises Error for another one.
[[nodiscard]] LensModel lens_of(const std::string& name);

/// Adds the class Camera.
void bind_camera(pybind11::module_& module);

}  // namespace pcavr::python
