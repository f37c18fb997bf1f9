// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace pcavr {

/// What tests of crashes change in a commit.
struct CommitHooks {
  /// Called before each step that changes the disk, and after the last one, with its name.
  std::function<void(const char* step)> before_step = [](const char*) {};
  /// False: as on a file system that can't exchange two names.
  bool can_exchange = true;
};

}  // namespace pcavr
