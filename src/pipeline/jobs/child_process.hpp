// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// How a process has ended.
struct ProcessEnd {
  int exit_code = 0;
  int signal = 0;  ///< 0: it ended on its own
  double cpu_seconds = 0.0;
  double memory = 0.0;  ///< maximum resident size [bytes]
};

/// A program that runs beside this one, with its output in a file and no input. It gets SIGTERM
/// when the thread that started it ends, also when that is killed.
class ChildProcess {
 public:
  /// `words` follow the program's name. `kept` is a descriptor that it inherits, or -1.
  [[nodiscard]] static Expected<ChildProcess> start(const std::filesystem::path& program,
                                                    const std::vector<std::string>& words,
                                                    const std::filesystem::path& log, int kept);
  /// Empty while it runs. Call no more once it has ended.
  [[nodiscard]] std::optional<ProcessEnd> poll() const;
  /// Sleeps until one of them has ended, and no longer than `timeout`; poll() says which.
  static void wait_for_end(const std::vector<ChildProcess>& children,
                           std::chrono::milliseconds timeout);

 private:
  explicit ChildProcess(pid_t process) : process_(process) {}

  pid_t process_;
};

}  // namespace pcavr
