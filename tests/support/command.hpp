// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"

/// Exit code and output of a run of the real command.
struct CommandOutcome {
  int exit_code = -1;  ///< -1 where it was ended by a signal
  std::string standard_output;
  std::string standard_error;

  [[nodiscard]] std::size_t error_lines() const {
    std::size_t lines = 0;
    for (const char c : standard_error) lines += c == '\n' ? 1 : 0;
    return lines;
  }
};

/// Runs `pcavr` with these arguments, each quoted; `prefix` goes before it (such as "ulimit ...;").
inline CommandOutcome run_pcavr(const std::vector<std::string>& arguments,
                                const std::string& prefix = {}) {
  const TemporaryFolder folder;
  const std::string output = (folder.path() / "out").string();
  const std::string errors = (folder.path() / "err").string();
  std::string line = prefix + "'" PCAVR_COMMAND "'";
  for (const std::string& argument : arguments) line += " '" + argument + "'";
  const int status = std::system((line + " > '" + output + "' 2> '" + errors + "'").c_str());
  CommandOutcome outcome;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  outcome.standard_output = pcavr::read_file(output).value();
  outcome.standard_error = pcavr::read_file(errors).value();
  return outcome;
}
