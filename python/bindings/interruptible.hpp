// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <utility>

#include <pybind11/pybind11.h>

#include "pcavr/base/core/observer.hpp"

#include "errors.hpp"

namespace pcavr::python {

/// Unwinds the library where Python raised an exception in a callback.
struct Interrupted : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// Python's side of a long call: the callbacks, and the exception that one of them raised. Python
/// exceptions do not cross the library, which may catch what it does not know: the exception is
/// stored here, and Interrupted unwinds.
class Callbacks {
 public:
  /// `progress`: called with stage, done and total; None: nothing is called.
  explicit Callbacks(pybind11::object progress);
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;

  /// For a thread without the GIL. Progress lets signals in, so that Ctrl-C ends the call; warnings
  /// become those of Python's module `warnings`.
  [[nodiscard]] Observer observer();

  /// Raises the stored exception, if there is one. The caller has the GIL.
  void raise_pending();

 private:
  template <typename Call>
  void call_python(Call&& call);

  pybind11::object progress_;
  pybind11::object type_, value_, traceback_;  ///< the stored exception
  bool is_interrupted_ = false;
};

/// Runs `work(observer)` without the GIL, and returns the value of its Expected result.
template <typename Work>
auto run_interruptible(const pybind11::object& progress, Work&& work) {
  Callbacks callbacks(progress);
  auto result = [&]() -> decltype(work(Observer())) {
    const pybind11::gil_scoped_release released;
    try {
      return work(callbacks.observer());
    } catch (const Interrupted& interrupted) {
      return Error{.message = interrupted.what()};
    }
  }();
  callbacks.raise_pending();
  if constexpr (std::is_same_v<decltype(result), Expected<void>>) {
    check(result);
  } else {
    return value_of(std::move(result));
  }
}

}  // namespace pcavr::python
