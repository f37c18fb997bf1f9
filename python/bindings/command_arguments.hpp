// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "settings.hpp"

/// Arguments that the functions that read and write folders have in common.
namespace pcavr::python {

/// Empty for None.
[[nodiscard]] std::filesystem::path optional_path(const pybind11::object& argument,
                                                  const std::string& name);

/// Where a call writes, and whether it may replace what is there.
struct OutputArgument {
  std::filesystem::path folder;
  bool replace = false;

  /// Fails where the folder overlaps one of the inputs (empty ones are ignored).
  [[nodiscard]] Expected<OutputFolder> create(
      std::optional<OutputKind> kind, const std::vector<std::filesystem::path>& inputs) const;
};

/// Known parameters: a dict, the file of one, or None.
struct ParametersArgument {
  std::optional<ParameterTable> table = {};
  std::filesystem::path file = {};  ///< empty for a dict
};
[[nodiscard]] ParametersArgument parameters_of(const pybind11::object& argument);

/// Reports the recording's warnings.
[[nodiscard]] Expected<Recording> read_with_warnings(const std::filesystem::path& folder,
                                                     bool skip_bad, const Settings& settings,
                                                     const Observer& observer);

}  // namespace pcavr::python
