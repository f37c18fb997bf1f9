// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "interruptible.hpp"

#include <string>
#include <string_view>

#include "option_names.hpp"

namespace pcavr::python {
namespace py = pybind11;

Callbacks::Callbacks(py::object progress) : progress_(std::move(progress)) {
  if (!progress_.is_none() && PyCallable_Check(progress_.ptr()) == 0) {
    throw py::type_error("progress: a function of (stage, done, total) is expected");
  }
}

template <typename Call>
void Callbacks::call_python(Call&& call) {
  if (is_interrupted_) throw Interrupted();
  {
    const py::gil_scoped_acquire acquired;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      call();
    } catch (py::error_already_set& raised) {
      type_ = raised.type();
      value_ = raised.value();
      traceback_ = raised.trace();
      is_interrupted_ = true;
    }
  }
  if (is_interrupted_) throw Interrupted();
}

Observer Callbacks::observer() {
  return {.progress =
              [this](std::string_view stage, std::size_t done, std::size_t total) {
                call_python([&] {
                  if (!progress_.is_none()) progress_(text_of(stage), done, total);
                });
              },
          .warn =
              [this](std::string_view line) {
                call_python([&] {
                  const py::object category =
                      py::module_::import("pcavr._errors").attr("DataWarning");
                  const std::string text = with_argument_names(std::string(line));
                  if (PyErr_WarnEx(category.ptr(), text.c_str(), 1) != 0) {
                    throw py::error_already_set();
                  }
                });
              }};
}

void Callbacks::raise_pending() {
  if (!is_interrupted_) return;
  PyErr_Restore(type_.release().ptr(), value_.release().ptr(), traceback_.release().ptr());
  throw py::error_already_set();
}

}  // namespace pcavr::python
