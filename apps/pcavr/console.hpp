// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"

namespace pcavr::app {

/// What a subcommand has to say when it is done.
struct CommandResult {
  std::string summary;          ///< for a person; printed on standard output
  nlohmann::ordered_json json;  ///< the same for a program, printed instead with --json
  bool is_failure = false;      ///< done, but what was looked at is not sound: exit code 1
};

/// `indent` below 0: in one line. A path may hold bytes that are no UTF-8: they become U+FFFD.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent);

/// Set by the subcommand that was chosen, run after the whole command line was read.
using Action = std::function<Expected<CommandResult>(const Observer&)>;

/// Progress and warnings on standard error: a bar where that is a terminal, else a plain line as
/// each stage ends.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  [[nodiscard]] Observer observer();

 private:
  void progress(std::string_view stage, std::size_t done, std::size_t total);
  void warn(std::string_view line);
  void clear_bar();

  bool is_terminal_;
  bool bar_is_shown_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point stage_start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace pcavr::app
