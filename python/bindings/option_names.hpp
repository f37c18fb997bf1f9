// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::python {

/// A message with the names of Python's arguments in place of the command's options: "--skip-bad"
/// becomes "skip_bad". Options in a command line ("pcavr inspect --recover") stay.
[[nodiscard]] std::string with_argument_names(const std::string& message);
[[nodiscard]] std::vector<std::string> with_argument_names(std::vector<std::string> messages);
/// Of message, place and hint.
[[nodiscard]] Error with_argument_names(Error error);

}  // namespace pcavr::python
