// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The result of `work`, or an Error with the text of the exception that it threw. Used for threads
/// and for functions of libraries, whose failure must not end the caller.
template <typename Work>
[[nodiscard]] auto caught(Work&& work) -> Expected<decltype(work())> {
  try {
    return work();
  } catch (const std::exception& failure) {
    return Error{.message = failure.what()};
  } catch (...) {
    return Error{.message = "an exception of unknown type"};
  }
}

}  // namespace pcavr
