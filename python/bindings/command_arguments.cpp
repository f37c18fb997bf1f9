// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "command_arguments.hpp"

#include <pybind11/stl.h>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "arrays.hpp"
#include "errors.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace fs = std::filesystem;

fs::path optional_path(const py::object& argument, const std::string& name) {
  return argument.is_none() ? fs::path() : path_of(argument, name);
}

Expected<OutputFolder> OutputArgument::create(std::optional<OutputKind> kind,
                                              const std::vector<fs::path>& inputs) const {
  const Expected<void> apart = check_outputs({folder}, inputs);
  if (!apart) return apart.error();
  return OutputFolder::create(folder, {.kind = kind, .replace = kind && replace});
}

ParametersArgument parameters_of(const py::object& argument) {
  if (argument.is_none()) return {};
  if (py::isinstance<py::dict>(argument)) return {argument.cast<ParameterTable>(), {}};
  const fs::path file = path_of(argument, "parameters");
  return {value_of(read_parameters(file)), file};
}

Expected<Recording> read_with_warnings(const fs::path& folder, bool skip_bad,
                                       const Settings& settings, const Observer& observer) {
  ReadOptions options = settings.reading;
  options.skip_bad = skip_bad;
  Expected<Recording> recording = read_recording(folder, options);
  if (!recording) return recording;
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  return recording;
}

}  // namespace pcavr::python
