// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// Drawing primitives, in millimetres from the page's top left corner, y down.
struct SheetRectangle {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};
struct SheetLine {
  double x1 = 0.0;
  double y1 = 0.0;
  double x2 = 0.0;
  double y2 = 0.0;
};
struct SheetText {
  double x = 0.0;  ///< where it begins
  double y = 0.0;  ///< its base line
  double height = 0.0;
  std::string text;  ///< plain ASCII
};
struct SheetPage {
  double width = 0.0;
  double height = 0.0;
  std::vector<SheetRectangle> black;
  std::vector<SheetLine> lines;  ///< hairlines
  std::vector<SheetText> texts;
};

[[nodiscard]] std::string draw_svg(const SheetPage& page);
[[nodiscard]] std::string draw_pdf(const std::vector<SheetPage>& pages);

}  // namespace pcavr
