// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/pipeline/identify.hpp"
#include "pcavr/report/report_page.hpp"

namespace pcavr {

/// What was found and the main parameters of all objects, then for each object its parameters,
/// contacts, breakaways and slides.
[[nodiscard]] ReportPage identification_page(const Identification& found,
                                             const std::string& recording);

}  // namespace pcavr
