// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct TagSheetOptions {
  std::string family = "tag36h11";
  std::vector<int> ids;
  double size = 0.08;          ///< edge of the square through the detection corners [m]
  double page_width = 0.210;   ///< [m]; A4
  double page_height = 0.297;  ///< [m]
  double margin = 0.010;       ///< [m]; printers leave it blank
};

/// A sheet to print at 100 %, with a ruler to check the scale, and the matching manifest lines.
struct TagSheet {
  std::vector<std::string> svg_pages;
  std::string pdf;            ///< all pages
  std::string manifest_yaml;  ///< a `markers:` list to paste into recording.yaml
};

/// Errors: unknown family, id not in it, tag larger than the page.
[[nodiscard]] Expected<TagSheet> make_tag_sheet(const TagSheetOptions& options);

/// Whether `content` is an SVG or PDF file that make_tag_sheet wrote.
[[nodiscard]] bool is_tag_sheet(std::string_view content);

/// The tag's cells, true where white, without quiet zone; for drawing and simulation. `border` is
/// the number of cells from the image's edge to the square through the detection corners.
struct TagPicture {
  int cells = 0;  ///< edge length
  int border = 0;
  std::vector<bool> is_white;  ///< row-major, top row first
};
[[nodiscard]] Expected<TagPicture> tag_picture(const std::string& family, int id);

}  // namespace pcavr
