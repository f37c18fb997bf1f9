// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace pcavr::python {

/// Adds the class Camera.
void bind_camera(pybind11::module_& module);

}  // namespace pcavr::python
