// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>

namespace pcavr {

/// Settings for running a site's tasks that take longer than one of its cycles.
struct Background {
  std::launch policy = std::launch::deferred;  ///< async: by threads
  /// Each task calls it first, by its name: a test makes a task fail.
  std::function<void(const char* task)> before_task = {};
};

}  // namespace pcavr
