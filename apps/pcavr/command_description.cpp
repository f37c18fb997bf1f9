// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "command_description.hpp"

#include <sstream>
#include <string>
#include <vector>

namespace pcavr::app {
namespace {

using Json = nlohmann::ordered_json;

/// CLI11 has the words that an option accepts only in its type's name: "TEXT:{page,gamepad}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.rfind('}');
  std::vector<std::string> choices;
  if (begin == std::string::npos || end == std::string::npos) return choices;
  std::istringstream words(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(words, word, ',');) choices.push_back(word);
  return choices;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back('-' + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

void append_options(const CLI::App& app, Json& description) {
  const CLI::Formatter formatter;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    Json entry{{"text", formatter.make_option_opts(option)},
               {"description", option->get_description()},
               {"takes_value", option->get_expected_max() > 0},
               {"choices", choices_of(*option)}};
    if (option->get_positional()) {
      entry["name"] = option->get_name(true, false);
      description["arguments"].push_back(entry);
    } else {
      entry["names"] = names_of(*option);
      description["options"].push_back(entry);
    }
  }
}

}  // namespace

Json describe_command(const CLI::App& app) {
  Json description{{"name", app.get_name()},     {"description", app.get_description()},
                   {"footer", app.get_footer()}, {"arguments", Json::array()},
                   {"options", Json::array()},   {"commands", Json::array()}};
  append_options(app, description);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name().empty()) {
      append_options(*command, description);  // a group of options
    } else {
      description["commands"].push_back(describe_command(*command));
    }
  }
  return description;
}

}  // namespace pcavr::app
