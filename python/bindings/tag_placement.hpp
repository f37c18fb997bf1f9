// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr::python {

/// Adds the class Tag.
void bind_tag_placement(pybind11::module_& module);

}  // namespace pcavr::python
