// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/evaluate.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "command_arguments.hpp"
#include "errors.hpp"
#include "interruptible.hpp"
#include "settings.hpp"
#include "threads.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

Expected<std::string> evaluate_into(const std::optional<OutputArgument>& output,
                                    const EvaluationInput& input, Parallelism parallelism,
                                    const Observer& observer) {
  if (!output) return evaluation_metrics(input, parallelism, observer);
  Expected<OutputFolder> folder =
      output->create(OutputKind::report, {input.subject, input.reference});
  if (!folder) return folder.error();
  Expected<std::string> report = evaluate(input, folder->path(), parallelism, observer);
  if (!report) return report.error();
  if (auto done = folder->commit(); !done) return done.error();
  return report;
}

py::object evaluate_subject(const py::object& subject, const py::object& reference,
                            const py::object& output, bool replace, int threads,
                            const py::object& options, const py::object& progress) {
  Settings settings;
  settings.set(options);
  const EvaluationInput input{.subject = path_of(subject, "subject"),
                              .reference = optional_path(reference, "reference"),
                              .options = settings.evaluation,
                              .configuration = settings.changed()};
  std::optional<OutputArgument> target;
  if (!output.is_none()) target = OutputArgument{path_of(output, "output"), replace};
  const Parallelism parallelism = parallelism_of(threads);
  const std::string report = run_interruptible(progress, [&](const Observer& observer) {
    return evaluate_into(target, input, parallelism, observer);
  });
  return py::module_::import("json").attr("loads")(report);
}

constexpr char kEvaluateDoc[] =
    R"(Compares a scene, a run or parameters with a reference, as `pcavr evaluate`.

subject    folder of a scene or a run, or a parameter file
reference  a recording's `truth` folder, or a second scene, run or parameter file; None, for a run:
           its prediction is compared with its own tracking
output     folder for report.json and report.html; None: nothing is written
threads, options, progress: see build

Returns the content of report.json as a dict: "headline" is a list of figures for people, the other
keys are flat and in SI units. Releases the GIL. Raises Error where the two have nothing in common.)";

}  // namespace

void bind_evaluate(py::module_& module) {
  module.def("evaluate", &evaluate_subject, py::arg("subject"), py::arg("reference") = py::none(),
             py::kw_only(), py::arg("output") = py::none(), py::arg("replace") = false,
             py::arg("threads") = 0, py::arg("options") = py::none(),
             py::arg("progress") = py::none(), kEvaluateDoc);
}

}  // namespace pcavr::python
