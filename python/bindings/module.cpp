// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "errors.hpp"

namespace {

/// Classes and callbacks belong to the interpreter that loaded the extension: in another one of the
/// same process they would mix, and callbacks would wait for each other.
bool is_main_interpreter() { return PyInterpreterState_Get() == PyInterpreterState_Main(); }

}  // namespace

PYBIND11_MODULE(_pcavr, module) {
  using namespace pcavr::python;
  // Also a function: an interpreter that imports what another one has loaded does not come here.
  if (!is_main_interpreter()) {
    throw pybind11::import_error("pcavr works in the main interpreter of a process alone");
  }
  module.def("_is_main_interpreter", &is_main_interpreter);
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
}
