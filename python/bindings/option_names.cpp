// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "option_names.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace pcavr::python {
namespace {

constexpr std::string_view kCommand = "pcavr ";
constexpr std::string_view kEndsOfCommand = ";,)'";
/// Options whose arguments have another name; all others have their own, with _ for -.
constexpr std::array kOtherNames{std::pair{std::string_view("config"), std::string_view("options")},
                                 std::pair{std::string_view("force"), std::string_view("replace")},
                                 std::pair{std::string_view("layout"), std::string_view("tags")},
                                 std::pair{std::string_view("robot"), std::string_view("urdf")}};

bool is_in_option(char c) { return (c >= 'a' && c <= 'z') || c == '-'; }

/// Whether an option begins at `at`: "--" and a letter, not within a word.
bool is_option(std::string_view message, std::size_t at) {
  const bool is_within = at > 0 && (is_in_option(message[at - 1]) || message[at - 1] == '_');
  return !is_within && message.substr(at).starts_with("--") && at + 2 < message.size() &&
         message[at + 2] >= 'a' && message[at + 2] <= 'z';
}

std::string argument_of(std::string_view option) {
  for (const auto& [name, argument] : kOtherNames) {
    if (option == name) return std::string(argument);
  }
  std::string argument(option);
  for (char& c : argument) c = c == '-' ? '_' : c;
  return argument;
}

}  // namespace

std::string with_argument_names(const std::string& message) {
  std::string text;
  bool is_command = false;
  for (std::size_t at = 0; at < message.size();) {
    const std::string_view rest = std::string_view(message).substr(at);
    if (rest.starts_with(kCommand)) is_command = true;
    if (kEndsOfCommand.find(message[at]) != std::string_view::npos) is_command = false;
    if (is_command || !is_option(message, at)) {
      text += message[at++];
      continue;
    }
    std::size_t end = at + 2;
    while (end < message.size() && is_in_option(message[end])) ++end;
    text += argument_of(std::string_view(message).substr(at + 2, end - at - 2));
    at = end;
  }
  return text;
}

std::vector<std::string> with_argument_names(std::vector<std::string> messages) {
  for (std::string& message : messages) message = with_argument_names(message);
  return messages;
}

Error with_argument_names(Error error) {
  error.message = with_argument_names(error.message);
  error.place = with_argument_names(error.place);
  error.hint = with_argument_names(error.hint);
  return error;
}

}  // namespace pcavr::python
