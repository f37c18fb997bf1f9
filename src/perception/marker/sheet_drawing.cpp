// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "perception/marker/pdf_writer.hpp"
#include "perception/marker/sheet_layout.hpp"

namespace pcavr {
namespace {

constexpr double kHairline = 0.1;                     // [mm]
constexpr double kPointsPerMillimetre = 72.0 / 25.4;  // PDF units are 1/72 inch

/// Four decimals are a tenth of a micrometre.
std::string svg_number(double value) { return fmt::format("{:.4f}", value); }

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + svg_number(value) + "\"";
}

/// Draws in millimetres from the top left: the page's matrix turns y up and scales to points, and
/// text is turned back.
std::string pdf_content(const SheetPage& page) {
  const std::string scale = svg_number(kPointsPerMillimetre);
  std::string content = scale + " 0 0 -" + scale + " 0 " +
                        svg_number(page.height * kPointsPerMillimetre) + " cm\n0 g 0 G " +
                        svg_number(kHairline) + " w\n";
  for (const SheetRectangle& r : page.black) {
    content += svg_number(r.x) + " " + svg_number(r.y) + " " + svg_number(r.width) + " " +
               svg_number(r.height) + " re\n";
  }
  if (!page.black.empty()) content += "f\n";
  for (const SheetLine& line : page.lines) {
    content += svg_number(line.x1) + " " + svg_number(line.y1) + " m " + svg_number(line.x2) + " " +
               svg_number(line.y2) + " l S\n";
  }
  for (const SheetText& text : page.texts) {
    content += "BT /F1 " + svg_number(text.height) + " Tf 1 0 0 -1 " + svg_number(text.x) + " " +
               svg_number(text.y) + " Tm (" + text.text + ") Tj ET\n";
  }
  return content;
}

}  // namespace

std::string draw_svg(const SheetPage& page) {
  const std::string width = svg_number(page.width);
  const std::string height = svg_number(page.height);
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n";
  svg += "<rect" + attribute("width", page.width) + attribute("height", page.height) +
         " fill=\"white\"/>\n";
  // One path for all cells, so that no viewer renders seams between neighbours.
  svg += "<path fill=\"black\" shape-rendering=\"crispEdges\" d=\"";
  for (const SheetRectangle& r : page.black) {
    svg += "M" + svg_number(r.x) + " " + svg_number(r.y) + "h" + svg_number(r.width) + "v" +
           svg_number(r.height) + "h-" + svg_number(r.width) + "z";
  }
  svg += "\"/>\n";
  for (const SheetLine& line : page.lines) {
    svg += "<line" + attribute("x1", line.x1) + attribute("y1", line.y1) +
           attribute("x2", line.x2) + attribute("y2", line.y2) + " stroke=\"black\"" +
           attribute("stroke-width", kHairline) + "/>\n";
  }
  for (const SheetText& text : page.texts) {
    svg += "<text" + attribute("x", text.x) + attribute("y", text.y) +
           attribute("font-size", text.height) +
           " stroke=\"none\" font-family=\"Helvetica, Arial, sans-serif\">" + text.text +
           "</text>\n";
  }
  return svg + "</svg>\n";
}

std::string draw_pdf(const std::vector<SheetPage>& pages) {
  std::vector<PdfPage> drawn;
  for (const SheetPage& page : pages) {
    drawn.push_back(
        {page.width * kPointsPerMillimetre, page.height * kPointsPerMillimetre, pdf_content(page)});
  }
  return write_pdf(drawn);
}

}  // namespace pcavr
