// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace pcavr::python {

/// Each adds the classes and functions of one source file to the extension `pcavr._pcavr`.
void bind_parameters(pybind11::module_& module);
void bind_identification(pybind11::module_& module);
void bind_recordings(pybind11::module_& module);
void bind_recording_writer(pybind11::module_& module);
void bind_world(pybind11::module_& module);
void bind_build(pybind11::module_& module);
void bind_replay(pybind11::module_& module);
void bind_evaluate(pybind11::module_& module);
void bind_export(pybind11::module_& module);
void bind_simulate(pybind11::module_& module);
void bind_tags(pybind11::module_& module);
void bind_robots(pybind11::module_& module);
void bind_robot_identification(pybind11::module_& module);
void bind_calibration(pybind11::module_& module);
void bind_camera_calibration(pybind11::module_& module);
void bind_tag_calibration(pybind11::module_& module);
void bind_depth_calibration(pybind11::module_& module);
void bind_object_calibration(pybind11::module_& module);

}  // namespace pcavr::python
