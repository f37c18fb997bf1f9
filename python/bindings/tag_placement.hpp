// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr::python {

/// A tag of a known family; raises Error otherwise, and for a negative number.
[[nodiscard]] MarkerId tag_id_of(const std::string& family, int id);

/// Adds the class Tag.
void bind_tag_placement(pybind11::module_& module);

}  // namespace pcavr::python
