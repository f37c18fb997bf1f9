// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/base/core/output.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// Creates the folder of -o, before any work: fails where it is, contains or lies in one of the
/// inputs (empty ones are ignored), or exists and may not be replaced by --force.
[[nodiscard]] Expected<OutputFolder> create_output(
    const OutputOption& output, OutputKind kind, const std::vector<std::filesystem::path>& inputs);

}  // namespace pcavr::app
