// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "commands.hpp"

namespace pcavr::app {

/// Rewrites an MCAP file whose writer was killed, with an index, and states what was
/// kept and lost. Output without a name: beside the file, as NAME-recovered.mcap.
[[nodiscard]] Expected<CommandResult> recover_log(const std::string& file,
                                                  const OutputOption& output,
                                                  const Observer& observer);

}  // namespace pcavr::app
