// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/object/damping_choice.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr::app {

/// The values of --damping-law: exact, criterion, and the published laws.
inline std::vector<std::string> damping_law_names() {
  std::vector<std::string> laws{std::string(key_of(DampingLaw::exact)), "criterion"};
  for (const DampingLaw law : kPublishedDampingLaws) laws.emplace_back(key_of(law));
  return laws;
}

/// --damping-law of the commands that use a parameter file; `needs` is its option.
inline void add_damping_law(CLI::App& command, std::string& law, const std::string& needs) {
  command
      .add_option("--damping-law", law,
                  "Contact damping from the file's restitution: by the exact relation, a published "
                  "law, or criterion: the published law with the smallest error there; default: "
                  "the file's damping")
      ->check(CLI::IsMember(damping_law_names()))
      ->needs(needs);
}

/// A parameter file, its damping by the law that the option names, if any.
inline Expected<ParameterTable> read_parameters_with_damping(const std::string& file,
                                                             const std::string& law,
                                                             std::vector<std::string>& notes) {
  Expected<ParameterTable> parameters = read_parameters(file);
  if (!parameters || law.empty()) return parameters;
  notes = apply_damping_law(damping_law_of(law), *parameters);  // none: by the criterion
  return parameters;
}

}  // namespace pcavr::app
