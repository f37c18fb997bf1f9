// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <cstdint>
#include <string>

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "command_arguments.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "threads.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

const SimulationCase& case_of(const std::string& name) {
  std::string known;
  for (const SimulationCase& each : simulation_cases()) {
    if (each.name == name) return each;
    known += (known.empty() ? "" : ", ") + each.name;
  }
  raise_error(
      {.message = "'" + name + "' is not a case", .place = "case", .hint = "give one of " + known});
}

Expected<void> simulate_into(const OutputArgument& output, const SimulationCase& simulation,
                             std::uint64_t seed, Parallelism parallelism,
                             const Observer& observer) {
  Expected<OutputFolder> folder = output.create(OutputKind::recording, {});
  if (!folder) return folder.error();
  if (auto done = simulate(simulation, seed, folder->path(), parallelism, observer); !done) {
    return done;
  }
  return folder->commit();
}

void simulate_case(const std::string& name, const py::object& output, std::uint64_t seed,
                   bool images, bool replace, int threads, const py::object& progress) {
  SimulationCase simulation = case_of(name);
  simulation.with_images = images;
  if (!images && simulation.task == ToolTask::none) {
    raise_error({.message = "without images the case '" + name + "' records nothing",
                 .place = "images",
                 .hint = "choose a case with a tool"});
  }
  const OutputArgument target{path_of(output, "output"), replace};
  const Parallelism parallelism = parallelism_of(threads);
  run_interruptible(progress, [&](const Observer& observer) {
    return simulate_into(target, simulation, seed, parallelism, observer);
  });
}

constexpr char kSimulateDoc[] =
    R"(Writes a simulated recording with exact ground truth, as `pcavr simulate`.

case      a name of `pcavr simulate --help`, such as 'push' or 'tabletop'
output    folder for the recording; a new one, or with `replace` a recording
seed      the same seed gives the same bytes
images    False: poses and tracking are in the recording, and no frames
threads, progress: see build

Releases the GIL; Ctrl-C ends it at the next progress. Raises Error.)";

}  // namespace

void bind_simulate(py::module_& module) {
  module.def("simulate", &simulate_case, py::arg("case"), py::arg("output"), py::kw_only(),
             py::arg("seed") = std::uint64_t{1}, py::arg("images") = true,
             py::arg("replace") = false, py::arg("threads") = 0, py::arg("progress") = py::none(),
             kSimulateDoc);
}

}  // namespace pcavr::python
