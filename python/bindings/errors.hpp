// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <pybind11/pybind11.h>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::python {

/// Raises pcavr.Error, with arguments named in place of options. The caller has the GIL.
[[noreturn]] void raise_error(const Error& error);

/// The value; raises the Error otherwise.
template <typename T>
[[nodiscard]] T value_of(Expected<T> result) {
  if (!result) raise_error(result.error());
  return *std::move(result);
}
inline void check(const Expected<void>& result) {
  if (!result) raise_error(result.error());
}

/// A text that may have bytes that are not UTF-8, as names of files and cells of broken tables do.
[[nodiscard]] pybind11::str text_of(std::string_view bytes);

/// Makes ContractError a ValueError, and errors of the file system pcavr.Error.
void translate_exceptions();

}  // namespace pcavr::python
