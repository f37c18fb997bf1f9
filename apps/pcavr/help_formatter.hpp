// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace pcavr::app {

/// Breaks a text at spaces into lines of at most `width` characters, except for single words that
/// are longer. Lines after the first start with `indent` spaces; the first one continues a line of
/// which `used` characters are taken. Line ends of the text are kept.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0,
                                  std::size_t used = 0);

/// CLI11's help texts, wrapped at a width, with the options that every command accepts, and with
/// bold headings if `with_colors`. Not thread-safe.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter(std::size_t width, bool with_colors) : width_(width), with_colors_(with_colors) {}

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override;
  std::string make_expanded(const CLI::App* group) const override;
  std::string make_footer(const CLI::App* app) const override;

 private:
  [[nodiscard]] std::string entry(const std::string& name, const std::string& description) const;

  std::size_t width_;  ///< [characters]
  bool with_colors_;
};

/// The options of the program that every command accepts, too: all but help and version.
[[nodiscard]] std::vector<const CLI::Option*> common_options(const CLI::App& program);

}  // namespace pcavr::app
