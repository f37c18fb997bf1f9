// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "commands.hpp"

namespace pcavr::app {

struct EvaluateArguments {
  std::vector<std::string> subjects;
  std::string truth;
  std::string reference;
  bool own_truth = false;
  OutputOption output;
  int threads = 1;
};

/// Evaluates several runs into one table.
[[nodiscard]] Expected<CommandResult> evaluate_runs(const EvaluateArguments& arguments,
                                                    Configuration& configuration,
                                                    const Observer& observer);

}  // namespace pcavr::app
