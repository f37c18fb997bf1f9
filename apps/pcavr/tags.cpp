// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "pcavr/core/output.hpp"
#include "pcavr/marker/tag_sheet.hpp"

#include "commands.hpp"

namespace pcavr::app {
namespace {

struct TagsArguments {
  TagSheetOptions options;
  std::string ids;
  std::string output;
};

/// Reads "0-5,9" to 0 1 2 3 4 5 9.
Expected<std::vector<int>> parse_ids(const std::string& text) {
  const Error bad{.message = "'" + text + "' is no list of tag ids",
                  .place = "--ids",
                  .hint = "write numbers and ranges, such as 0-5,9"};
  std::vector<int> ids;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    int first = 0;
    int last = 0;
    char rest = 0;
    const int fields = std::sscanf(part.c_str(), "%d-%d%c", &first, &last, &rest);
    if (fields == 1 && part.find('-') == part.npos) last = first;
    if (fields < 1 || fields > 2 || first < 0 || last < first || last - first > 1000) return bad;
    for (int id = first; id <= last; ++id) ids.push_back(id);
  }
  if (ids.empty()) return bad;
  return ids;
}

Expected<CommandResult> write_sheet(TagsArguments arguments) {
  const Expected<std::vector<int>> ids = parse_ids(arguments.ids);
  if (!ids) return ids.error();
  arguments.options.ids = *ids;
  const Expected<TagSheet> sheet = make_tag_sheet(arguments.options);
  if (!sheet) return sheet.error();

  const std::filesystem::path target = arguments.output;
  const std::filesystem::path stem = target.parent_path() / target.stem();
  CommandResult result;
  const auto write = [&](const std::filesystem::path& file, const std::string& content) {
    result.summary += "wrote " + file.string() + '\n';
    result.json["files"].push_back(file.string());
    return write_file(file, content);
  };
  for (std::size_t page = 0; page < sheet->svg_pages.size(); ++page) {
    const std::string suffix = page == 0 ? "" : "-" + std::to_string(page + 1);
    const auto written = write(stem.string() + suffix + ".svg", sheet->svg_pages[page]);
    if (!written) return written.error();
  }
  const auto written = write(stem.string() + ".pdf", sheet->pdf);
  if (!written) return written.error();
  result.summary += "print at 100 %, check the ruler, and paste this into recording.yaml:\n\n" +
                    sheet->manifest_yaml;
  result.json["manifest"] = sheet->manifest_yaml;
  return result;
}

}  // namespace

void add_tags(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("tags", "Write a sheet of tags to print, and their manifest lines");
  command->footer("Example:\n  pcavr tags --family tag36h11 --ids 0-5 --size 0.08 -o sheet.svg");
  auto arguments = std::make_shared<TagsArguments>();
  TagSheetOptions& options = arguments->options;
  command->add_option("--family", options.family, "Tag family or ArUco dictionary")
      ->capture_default_str();
  command->add_option("--ids", arguments->ids, "Numbers and ranges, such as 0-5,9")->required();
  command->add_option("--size", options.size, "Edge of the square through the corners [m]")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--page-width", options.page_width, "[m]")->capture_default_str();
  command->add_option("--page-height", options.page_height, "[m]")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "SVG file; a PDF is written beside it")
      ->required();
  command->callback([arguments, &action] {
    action = [arguments](const Observer&) { return write_sheet(*arguments); };
  });
}

}  // namespace pcavr::app
