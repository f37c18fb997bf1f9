// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace pcavr {

/// Where the library's words go. The default is silence: a library that prints is a guest that
/// shouts. Called from the thread that called the library.
struct Observer {
  /// A stage went from `done - 1` to `done` of `total` steps (total 0: not known).
  std::function<void(std::string_view stage, std::size_t done, std::size_t total)> progress;
  /// A line that the user should see: something was left out, doubtful or unusual.
  std::function<void(std::string_view line)> warn;

  void on_progress(std::string_view stage, std::size_t done, std::size_t total) const {
    if (progress) progress(stage, done, total);
  }
  void on_warning(std::string_view line) const {
    if (warn) warn(line);
  }
};

}  // namespace pcavr
