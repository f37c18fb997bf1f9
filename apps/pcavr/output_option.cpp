// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "output_option.hpp"

#include "pcavr/base/core/output_paths.hpp"

namespace pcavr::app {

void add_output_option(CLI::App& command, OutputOption& output, const std::string& what) {
  command.add_option("-o,--output", output.folder, what)->required();
  command.add_flag("--force", output.replace,
                   "Replace an existing output that this command wrote and that contains "
                   "nothing else");
}

Expected<OutputFolder> create_output(const OutputOption& output, OutputKind kind,
                                     const std::vector<std::filesystem::path>& inputs) {
  const Expected<void> apart = check_outputs({output.folder}, inputs);
  if (!apart) return apart.error();
  return OutputFolder::create(output.folder, {.kind = kind, .replace = output.replace});
}

}  // namespace pcavr::app
