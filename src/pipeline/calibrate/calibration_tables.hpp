// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/report/report_page.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// The report of a hand-eye calibration, without its inputs and footer.
[[nodiscard]] ReportPage hand_eye_page(const HandEyeResult& found);

}  // namespace pcavr
