// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::app {

/// The recordings that arguments name: each is a recording's folder; a folder of such folders,
/// taken by name; or a text file with one folder in each line, relative to its own. Empty lines and
/// those that begin with # are skipped. A folder that is neither stays as it is, for the reader's
/// error.
[[nodiscard]] Expected<std::vector<std::string>> list_recordings(
    const std::vector<std::string>& arguments);

}  // namespace pcavr::app
