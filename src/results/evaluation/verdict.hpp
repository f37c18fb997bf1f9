// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report.hpp"

namespace pcavr {

/// The findings of an evaluation in one or two sentences; empty where nothing could be compared.
[[nodiscard]] std::string verdict_of(const Findings& findings);

}  // namespace pcavr
