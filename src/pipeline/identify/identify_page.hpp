// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// A page with the findings and the main parameters of all objects, then the parameters, contacts,
/// breakaways and slides of each object.
[[nodiscard]] ReportPage identification_page(const Identification& found,
                                             const std::string& recording);

}  // namespace pcavr
