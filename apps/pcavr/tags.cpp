// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"
#include "pcavr/perception/marker/tag_sheet.hpp"

#include "commands.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr int kMaxTags = 1000;  ///< of a sheet: more pages than anyone prints

struct TagsArguments {
  TagSheetOptions options;
  std::string ids;
  std::string output;
  bool replace = false;
};

/// Reads "0-5,9" to 0 1 2 3 4 5 9.
Expected<std::vector<int>> parse_ids(const std::string& text) {
  const Error bad{.message = "'" + text + "' is not a list of tag ids",
                  .place = "--ids",
                  .hint = "give ids and ranges of ids, such as 0-5,9"};
  const Error too_many{.message = fmt::format("more than {} tag ids", kMaxTags),
                       .place = "--ids",
                       .hint = "write several sheets"};
  std::vector<int> ids;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = std::min(part.find('-'), part.size());
    const std::optional<int> first = parse_number<int>(part.substr(0, dash));
    const std::optional<int> last =
        dash == part.size() ? first : parse_number<int>(part.substr(dash + 1));
    if (!first || !last || *first < 0 || *last < *first) return bad;
    if (*last - *first >= kMaxTags - static_cast<int>(ids.size())) return too_many;
    for (int id = *first; id <= *last; ++id) ids.push_back(id);
  }
  if (ids.empty()) return bad;
  return ids;
}

/// Whether --force may replace the file.
bool is_sheet(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxSize = 1U << 28U;  // [bytes] far above a sheet of a thousand tags
  std::error_code code;
  if (!(std::filesystem::file_size(file, code) <= kMaxSize)) return false;
  const Expected<std::string> content = read_file(file);
  return content && is_tag_sheet(*content);
}

/// Atomic: all files or none. All are first written under temporary names.
Expected<void> write_all(
    const std::vector<std::pair<std::filesystem::path, const std::string*>>& pages, bool replace) {
  std::vector<OutputFile> files;
  for (const auto& [target, content] : pages) {
    Expected<OutputFile> file = OutputFile::create(
        target, {.replace = replace, .kind = "sheet of tags", .is_replaceable = is_sheet});
    if (!file) return file.error();
    const Expected<void> written = file->write(*content);
    if (!written) return written;
    files.push_back(*std::move(file));
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Expected<void> committed = files[i].commit();
    if (committed) continue;
    for (std::size_t done = 0; done < i; ++done) files[done].undo();
    return committed;
  }
  return {};
}

Expected<CommandResult> write_sheet(TagsArguments arguments) {
  if (!std::filesystem::path(arguments.output).has_filename()) {
    return Error{.message = "'" + arguments.output + "' is not a file name",
                 .place = "--output",
                 .hint = "give the name of an SVG file"};
  }
  const Expected<std::vector<int>> ids = parse_ids(arguments.ids);
  if (!ids) return ids.error();
  arguments.options.ids = *ids;
  const Expected<TagSheet> sheet = make_tag_sheet(arguments.options);
  if (!sheet) return sheet.error();

  std::vector<std::pair<std::filesystem::path, const std::string*>> pages;
  const std::filesystem::path target = arguments.output;
  const std::filesystem::path stem = target.parent_path() / target.stem();
  for (std::size_t page = 0; page < sheet->svg_pages.size(); ++page) {
    const std::string suffix = page == 0 ? "" : "-" + std::to_string(page + 1);
    pages.emplace_back(stem.string() + suffix + ".svg", &sheet->svg_pages[page]);
  }
  pages.emplace_back(stem.string() + ".pdf", &sheet->pdf);
  const Expected<void> written = write_all(pages, arguments.replace);
  if (!written) return written.error();
  CommandResult result;
  for (const auto& [file, content] : pages) {
    result.summary += "wrote " + file.string() + '\n';
    result.json["files"].push_back(file.string());
  }
  result.summary += "print at 100 %, check the ruler, and paste this into recording.yaml:\n\n" +
                    sheet->manifest_yaml;
  result.json["manifest"] = sheet->manifest_yaml;
  return result;
}

}  // namespace

void add_tags(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("tags", "Write a printable sheet of tags, and their manifest entries");
  command->footer("Example:\n  pcavr tags --family tag36h11 --ids 0-5 --size 0.08 -o sheet.svg");
  auto arguments = std::make_shared<TagsArguments>();
  TagSheetOptions& options = arguments->options;
  command->add_option("--family", options.family, "Tag family or ArUco dictionary")
      ->capture_default_str();
  command->add_option("--ids", arguments->ids, "Tag ids and ranges, such as 0-5,9")->required();
  add_number(*command, "--size", options.size, ranges::kTagSize,
             "Edge length of a tag, between its corners [m]")
      ->capture_default_str();
  add_number(*command, "--page-width", options.page_width, ranges::kPageSize, "Page width [m]")
      ->capture_default_str();
  add_number(*command, "--page-height", options.page_height, ranges::kPageSize, "Page height [m]")
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output, "SVG file; a PDF is written next to it")
      ->required();
  command->add_flag("--force", arguments->replace,
                    "Replace existing sheets of tags; other files are never replaced");
  command->callback([arguments, &action] {
    action = [arguments](const Observer&) { return write_sheet(*arguments); };
  });
}

}  // namespace pcavr::app
