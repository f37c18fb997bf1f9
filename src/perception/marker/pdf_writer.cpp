// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/pdf_writer.hpp"

#include <cstddef>

#include <fmt/core.h>

namespace pcavr {
namespace {

std::string pdf_number(double value) { return fmt::format("{:.3f}", value); }

/// The numbered objects of the file, in order: catalogue, list of pages, font, then for
/// each page the page and its content.
std::vector<std::string> objects_of(const std::vector<PdfPage>& pages) {
  constexpr int kFirstPage = 4;  // after catalogue, pages and font
  std::string kids;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    kids += std::to_string(kFirstPage + 2 * i) + " 0 R ";
  }
  std::vector<std::string> objects{
      "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
      "<< /Type /Pages /Count " + std::to_string(pages.size()) + " /Kids [" + kids + "] >>",
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const PdfPage& page = pages[i];
    objects.push_back("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + pdf_number(page.width) +
                      " " + pdf_number(page.height) +
                      "] /Resources << /Font << /F1 3 0 R >> >> /Contents " +
                      std::to_string(kFirstPage + 2 * i + 1) + " 0 R >>");
    objects.push_back("<< /Length " + std::to_string(page.content.size()) + " >>\nstream\n" +
                      page.content + "\nendstream");
  }
  return objects;
}

}  // namespace

std::string write_pdf(const std::vector<PdfPage>& pages) {
  const std::vector<std::string> objects = objects_of(pages);
  std::string file = "%PDF-1.4\n";
  std::string table = "0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", file.size());
    file += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string size = std::to_string(objects.size() + 1);
  const std::string start = std::to_string(file.size());
  file += "xref\n0 " + size + "\n" + table + "trailer\n<< /Size " + size +
          " /Root 1 0 R >>\nstartxref\n" + start + "\n%%EOF\n";
  return file;
}

}  // namespace pcavr
