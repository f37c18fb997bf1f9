// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/core.h>

#include "pcavr/base/geometry/pixel.hpp"

#include "perception/marker/sheet_layout.hpp"

namespace pcavr {
namespace {

// All of the layout is in millimetres.
constexpr double kRuler = 100.0;
constexpr char kRulerText[] = "Print at 100 %. This ruler is ";  ///< on every page
constexpr double kRulerSpace = 14.0;
constexpr double kTextHeight = 3.0;
constexpr double kLabelSpace = 6.0;
constexpr double kCutMark = 4.0;

/// A number for a label: two decimals without trailing zeros.
std::string label_number(double value) {
  std::string result = fmt::format("{:.2f}", value);
  while (result.back() == '0') result.pop_back();
  if (result.back() == '.') result.pop_back();
  return result;
}

/// The space of one tag: its cells, a white cell around them, and a line of text below.
struct Slot {
  double cell = 0.0;     ///< edge of one cell
  double picture = 0.0;  ///< edge of all cells
  double width = 0.0;    ///< between cut marks
  double height = 0.0;
};

Slot slot_for(const TagPicture& picture, double size) {
  Slot slot;
  slot.cell = size / (picture.cells - 2 * picture.border);
  slot.picture = slot.cell * picture.cells;
  slot.width = slot.picture + 2.0 * slot.cell;
  slot.height = slot.width + kLabelSpace;
  return slot;
}

void draw_cells(const TagPicture& picture, double x, double y, double cell, SheetPage& page) {
  for (int row = 0; row < picture.cells; ++row) {
    // Neighbours in a row become one rectangle.
    for (int column = 0; column < picture.cells;) {
      const auto is_white = [&](int at) {
        return picture.is_white[static_cast<std::size_t>(row * picture.cells + at)];
      };
      int end = column + 1;
      while (end < picture.cells && is_white(end) == is_white(column)) ++end;
      if (!is_white(column)) {
        page.black.push_back({x + column * cell, y + row * cell, (end - column) * cell, cell});
      }
      column = end;
    }
  }
}

/// Corners of the slot, drawn outward, so that none remains on the cut piece.
void draw_cut_marks(double x, double y, const Slot& slot, SheetPage& page) {
  for (const double left : {0.0, 1.0}) {
    for (const double top : {0.0, 1.0}) {
      const double px = x + left * slot.width;
      const double py = y + top * slot.height;
      page.lines.push_back({px, py, px + (2.0 * left - 1.0) * kCutMark, py});
      page.lines.push_back({px, py, px, py + (2.0 * top - 1.0) * kCutMark});
    }
  }
}

void draw_tag(const TagPicture& picture, const TagSheetOptions& options, int id, double x, double y,
              SheetPage& page) {
  const Slot slot = slot_for(picture, options.size * 1e3);
  draw_cells(picture, x + slot.cell, y + slot.cell, slot.cell, page);
  const double base = y + slot.width + 0.5 * (kLabelSpace + kTextHeight) - 1.0;
  page.texts.push_back({x + slot.cell + 5.0, base, kTextHeight,
                        options.family + " " + std::to_string(id) + "  " +
                            label_number(options.size * 1e3) + " mm"});
  // An arrow to the tag's upper edge: the marker frame's y.
  const double arrow = x + slot.cell + 2.0;
  page.lines.push_back({arrow, base + 0.5, arrow, base - kTextHeight});
  page.lines.push_back({arrow, base - kTextHeight, arrow - 0.8, base - kTextHeight + 1.2});
  page.lines.push_back({arrow, base - kTextHeight, arrow + 0.8, base - kTextHeight + 1.2});
}

void draw_ruler(double x, double y, double length, SheetPage& page) {
  page.lines.push_back({x, y, x + length, y});
  for (int i = 0; i <= static_cast<int>(length); ++i) {
    const double tick = i % 10 == 0 ? 3.0 : (i % 5 == 0 ? 2.0 : 1.0);
    page.lines.push_back({x + i, y, x + i, y - tick});
  }
  page.texts.push_back(
      {x, y + 4.0, kTextHeight,
       kRulerText + label_number(length) + " mm long: measure it. Arrows point up."});
}

struct Grid {
  int columns = 0;
  int rows = 0;
  double step_x = 0.0;
  double step_y = 0.0;
  double left = 0.0;  ///< of the first slot
  double top = 0.0;
  bool has_cut_marks = true;
};

/// A tag too large for cut marks gets its own page. Its white border may extend into the unprinted
/// margin, below the ruler's line of text.
std::optional<Grid> single_tag_grid(const TagSheetOptions& options, const Slot& slot) {
  const double margin = options.margin * 1e3;
  const double width = options.page_width * 1e3;
  const double room = options.page_height * 1e3 - margin - kRulerSpace;
  if (slot.width > width || slot.picture > width - 2.0 * margin) return std::nullopt;
  if (slot.height > room) return std::nullopt;
  return Grid{1,    1, slot.width, slot.height, 0.5 * (width - slot.width), margin + kRulerSpace,
              false};
}

std::optional<Grid> grid_for(const TagSheetOptions& options, const Slot& slot) {
  const double margin = options.margin * 1e3;
  const double gap = 2.0 * kCutMark;
  const double width = options.page_width * 1e3 - 2.0 * margin - gap;
  const double height = options.page_height * 1e3 - 2.0 * margin - gap - kRulerSpace;
  Grid grid;
  grid.step_x = slot.width + gap;
  grid.step_y = slot.height + gap;
  constexpr int kMaxSlots = 10'000;  // along each axis: 10 m of paper with a slot per millimetre
  grid.columns = clamp_to_int((width + gap) / grid.step_x, 0, kMaxSlots);
  grid.rows = clamp_to_int((height + gap) / grid.step_y, 0, kMaxSlots);
  if (grid.columns == 0 || grid.rows == 0) return single_tag_grid(options, slot);
  grid.left = margin + kCutMark;
  grid.top = grid.left + kRulerSpace;
  return grid;
}

SheetPage empty_page(const TagSheetOptions& options) {
  SheetPage page;
  page.width = options.page_width * 1e3;
  page.height = options.page_height * 1e3;
  const double margin = options.margin * 1e3;
  // The ruler has as many whole centimetres as fit on narrow pages.
  const double room = std::floor((page.width - 2.0 * margin) / 10.0) * 10.0;
  draw_ruler(margin, margin + 4.0, std::min(kRuler, room), page);
  return page;
}

std::string manifest_lines(const TagSheetOptions& options) {
  const std::string size = fmt::format("{:.9g}", options.size);
  std::string yaml = "markers:\n";
  for (const int id : options.ids) {
    yaml += "  - family: " + options.family + "\n    id: " + std::to_string(id) +
            "\n    size: " + size +
            "\n    role: base  # or object, with a line `object: NAME`\n"
            "    pose: {t: [0, 0, 0], q: [0, 0, 0, 1]}  # where it is fixed: fill in\n";
  }
  return yaml;
}

Expected<void> check(const TagSheetOptions& options) {
  if (options.ids.empty()) {
    return Error{.message = "no tag ids given", .hint = "give at least one"};
  }
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!is_length(options.size) || !is_length(options.page_width) ||
      !is_length(options.page_height) || !(options.margin >= 0.0)) {
    return Error{.message = "sizes must be positive lengths", .hint = "give them in metres"};
  }
  return {};
}

}  // namespace

Expected<TagSheet> make_tag_sheet(const TagSheetOptions& options) {
  if (const auto checked = check(options); !checked) return checked.error();
  std::vector<TagPicture> pictures;
  for (const int id : options.ids) {
    Expected<TagPicture> picture = tag_picture(options.family, id);
    if (!picture) return picture.error();
    pictures.push_back(std::move(*picture));
  }
  const Slot slot = slot_for(pictures.front(), options.size * 1e3);
  const std::optional<Grid> grid = grid_for(options, slot);
  if (!grid) {
    return Error{.message = "a tag of " + label_number(options.size * 1e3) +
                            " mm with its white border (" + label_number(slot.width) +
                            " mm) does not fit on the page",
                 .hint = "use a larger page or a smaller tag"};
  }

  std::vector<SheetPage> pages;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int place = static_cast<int>(i) % (grid->columns * grid->rows);
    if (place == 0) pages.push_back(empty_page(options));
    const double x = grid->left + (place % grid->columns) * grid->step_x;
    const double y = grid->top + (place / grid->columns) * grid->step_y;
    draw_tag(pictures[i], options, options.ids[i], x, y, pages.back());
    if (grid->has_cut_marks) draw_cut_marks(x, y, slot, pages.back());
  }
  TagSheet sheet;
  for (const SheetPage& page : pages) sheet.svg_pages.push_back(draw_svg(page));
  sheet.pdf = draw_pdf(pages);
  sheet.manifest_yaml = manifest_lines(options);
  return sheet;
}

bool is_tag_sheet(std::string_view content) {
  const bool is_svg_or_pdf = content.substr(0, 5) == "<?xml" || content.substr(0, 4) == "%PDF";
  return is_svg_or_pdf && content.find(kRulerText) != content.npos;
}

}  // namespace pcavr
