// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace pcavr {

/// Callbacks for progress, events and warnings; none by default, because libraries do not print.
/// Called from the thread that called the library.
struct Observer {
  /// A stage went from `done - 1` to `done` of `total` steps (total 0: unknown).
  std::function<void(std::string_view stage, std::size_t done, std::size_t total)> progress;
  /// A line for the user: something was skipped, is doubtful or unusual.
  std::function<void(std::string_view line)> warn = {};
  /// A line for the user: an event of a program that runs on, as expected.
  std::function<void(std::string_view line)> note = {};

  void on_progress(std::string_view stage, std::size_t done, std::size_t total) const {
    if (progress) progress(stage, done, total);
  }
  void on_warning(std::string_view line) const {
    if (warn) warn(line);
  }
  void on_note(std::string_view line) const {
    if (note) note(line);
  }
};

}  // namespace pcavr
