// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// One page: PDF drawing operators in points of 1/72 inch, origin bottom left. The font /F1 is
/// Helvetica, which every viewer has.
struct PdfPage {
  double width = 0.0;   ///< [pt]
  double height = 0.0;  ///< [pt]
  std::string content;
};

/// A PDF 1.4 file of these pages [ISO 32000-1, 7.5] with print scaling disabled.
[[nodiscard]] std::string write_pdf(const std::vector<PdfPage>& pages);

}  // namespace pcavr
