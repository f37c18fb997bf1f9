// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "errors.hpp"

PYBIND11_MODULE(_pcavr, module) {
  using namespace pcavr::python;
  module.doc() = "The C++ library pcavr; use it as the package pcavr.";
  translate_exceptions();
  bind_parameters(module);
  bind_identification(module);
  bind_recordings(module);
  bind_tags(module);
  bind_recording_writer(module);
  bind_world(module);
  bind_build(module);
  bind_replay(module);
  bind_evaluate(module);
  bind_export(module);
  bind_simulate(module);
  bind_robots(module);
  bind_robot_identification(module);
  bind_calibration(module);
  bind_camera_calibration(module);
  bind_tag_calibration(module);
  bind_depth_calibration(module);
  bind_object_calibration(module);
}
