// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"

namespace pcavr::app {

/// The result of a subcommand.
struct CommandResult {
  std::string summary;          ///< human-readable; printed on standard output
  nlohmann::ordered_json json;  ///< machine-readable, printed instead with --json
  bool is_failure = false;      ///< finished, but the checked data are not sound: exit code 1
  bool is_no = false;           ///< the answer is no, or some inputs disagree: exit code 3
};

/// Set by the invoked subcommand, run after the whole command line is parsed.
using Action = std::function<Expected<CommandResult>(const Observer&)>;

/// Progress, events and warnings on standard error: a bar on a terminal, else a line at the end of
/// each stage.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  [[nodiscard]] Observer observer();

 private:
  void progress(std::string_view stage, std::size_t done, std::size_t total);
  void print_line(std::string_view prefix, std::string_view line);
  void clear_bar();

  bool is_terminal_;
  bool has_colors_;
  bool bar_is_shown_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point stage_start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace pcavr::app
