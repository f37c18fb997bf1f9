// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace pcavr {

/// Test hooks for fault injection in a commit.
struct CommitHooks {
  /// Called with the step's name before each step that changes the disk, and after the last one.
  std::function<void(const char* step)> before_step = [](const char*) {};
  /// False: behaves as a file system without RENAME_EXCHANGE.
  bool can_exchange = true;
};

}  // namespace pcavr
