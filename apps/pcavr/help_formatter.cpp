// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "help_formatter.hpp"

#include <algorithm>
#include <sstream>
#include <vector>

#include "terminal.hpp"

namespace pcavr::app {
namespace {

constexpr std::size_t kEntryIndent = 2;  ///< of an option or a command
constexpr std::size_t kWrappedNameIndent = 6;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

const CLI::App& root_of(const CLI::App& app) {
  const CLI::App* root = &app;
  while (root->get_parent() != nullptr) root = root->get_parent();
  return *root;
}

bool is_heading(const std::string& line) { return line.ends_with(':') && !line.starts_with(' '); }

/// Headings and the word "Usage:" in bold.
std::string with_bold_headings(const std::string& help) {
  constexpr std::string_view kUsage = "Usage:";
  std::string result;
  for (const std::string& line : lines_of(help)) {
    if (is_heading(line)) {
      result += styled(line, TextStyle::kHeading, true);
    } else if (line.starts_with(kUsage)) {
      result += styled(kUsage, TextStyle::kHeading, true) + line.substr(kUsage.size());
    } else {
      result += line;
    }
    result += '\n';
  }
  return result;
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent,
                    std::size_t used) {
  std::string result;
  bool is_line_start = true;  // no space before the next word
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    const std::size_t space = is_line_start ? 0 : 1;
    if (!is_line_start && used + space + word.size() > width) {
      result += '\n' + std::string(indent, ' ');
      used = indent;
    } else if (!is_line_start) {
      result += ' ';
      ++used;
    }
    result += word;
    used += word.size();
    is_line_start = false;
    if (end < text.size() && text[end] == '\n') {
      result += '\n' + std::string(indent, ' ');
      used = indent;
      is_line_start = true;
    }
    begin = end + 1;
  }
  return result;
}

std::vector<const CLI::Option*> common_options(const CLI::App& program) {
  return program.get_options([&program](const CLI::Option* option) {
    return option->nonpositional() && !option->get_group().empty() &&
           option != program.get_help_ptr() && option != program.get_version_ptr();
  });
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name,
                                     CLI::AppFormatMode mode) const {
  const std::string help = Formatter::make_help(app, std::move(name), mode);
  return with_colors_ && mode == CLI::AppFormatMode::Normal ? with_bold_headings(help) : help;
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(Formatter::make_description(app), width_);
}

/// A name, and its description beside it, or below where the name is long.
std::string HelpFormatter::entry(const std::string& name, const std::string& description) const {
  const std::size_t column = get_column_width();
  std::string text =
      std::string(kEntryIndent, ' ') + wrapped(name, width_, kWrappedNameIndent, kEntryIndent);
  if (description.empty()) return text + '\n';
  text += text.size() < column ? std::string(column - text.size(), ' ')
                               : '\n' + std::string(column, ' ');
  return text + wrapped(description, width_, column, column) + '\n';
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return entry(make_option_name(option, is_positional) + make_option_opts(option),
               make_option_desc(option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_display_name(true), command->get_description());
}

std::string HelpFormatter::make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const {
  std::string text;
  const CLI::App& root = root_of(*app);
  if (mode == CLI::AppFormatMode::Normal && &root != app) {
    text = make_group("Options of every command", false, common_options(root));
  }
  return text + Formatter::make_subcommands(app, mode);
}

/// CLI11 indents a group of options by two characters.
std::string HelpFormatter::make_expanded(const CLI::App* group) const {
  return HelpFormatter(width_ - kEntryIndent, false).Formatter::make_expanded(group);
}

/// Lines that start with a space are commands, to be copied: they stay whole.
std::string HelpFormatter::make_footer(const CLI::App* app) const {
  std::string text;
  for (const std::string& line : lines_of(Formatter::make_footer(app))) {
    text += (line.starts_with(' ') ? line : wrapped(line, width_)) + '\n';
  }
  return text;
}

}  // namespace pcavr::app
