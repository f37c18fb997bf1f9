// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "usage_error.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace pcavr::app {
namespace {

constexpr std::size_t kMaxWord = 40;  ///< characters: no command or option is as long
constexpr std::size_t kMaxEdits = 2;  ///< beyond, it is another word

/// Number of characters to insert, remove or replace to turn one into the other [Levenshtein 1966].
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// The most similar of the names, at most two edits away; empty where there is none.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t fewest = kMaxEdits + 1;
  if (word.size() > kMaxWord) return nearest;
  for (const std::string& name : names) {
    const std::size_t edits = edits_between(word, name);
    if (edits >= std::min(fewest, name.size())) continue;
    fewest = edits;
    nearest = name;
  }
  return nearest;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_name().empty()) names.push_back(command->get_name());
  }
  return names;
}

void append_option_names(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  // Option groups are subcommands without a name.
  for (const CLI::App* group : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (group->get_name().empty()) append_option_names(*group, names);
  }
}

/// The options of a command and of those that it belongs to.
std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) {
    append_option_names(*app, names);
  }
  return names;
}

/// The first long option that no command has, without a value; else empty.
std::string unknown_option(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  const auto word = std::find_if(words.begin(), words.end(), [](const std::string& each) {
    return each.starts_with("--") && each.size() > 2;
  });
  return word == words.end() ? std::string() : word->substr(0, word->find('='));
}

Error unknown_word(const std::string& kind, const std::string& word,
                   const std::vector<std::string>& known, const std::string& help) {
  const std::string meant = nearest_name(word, known);
  return {.message = "unknown " + kind + " '" + word + "'",
          .hint = meant.empty() ? help : "did you mean " + meant + "? " + help};
}

}  // namespace

std::string unknown_command(const CLI::App& app) {
  const CLI::App& command = invoked_command(app);
  // A word that a nested command does not know is left to those that it belongs to.
  const std::vector<std::string> words = app.remaining(true);
  const auto word = std::find_if(words.begin(), words.end(),
                                 [](const std::string& each) { return !each.starts_with('-'); });
  return command_names(command).empty() || word == words.end() ? std::string() : *word;
}

const CLI::App& invoked_command(const CLI::App& app) {
  const CLI::App* command = &app;
  for (auto parsed = command->get_subcommands(); !parsed.empty();
       parsed = command->get_subcommands()) {
    if (parsed.front()->get_name().empty()) break;  // a group of options
    command = parsed.front();
  }
  return *command;
}

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent == nullptr ? std::string() : full_name(*parent) + ' ') + command.get_name();
}

Error usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = invoked_command(app);
  const std::string help = "see " + full_name(command) + " --help";
  if (const std::string word = unknown_command(app); !word.empty()) {
    return unknown_word("command", word, command_names(command), help);
  }
  if (const std::string word = unknown_option(app); !word.empty()) {
    return unknown_word("option", word, option_names(command), help);
  }
  return {.message = error.what(), .hint = help};
}

}  // namespace pcavr::app
