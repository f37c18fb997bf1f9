// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "errors.hpp"

#include <exception>
#include <filesystem>

#include "pcavr/base/core/check.hpp"

#include "option_names.hpp"

namespace pcavr::python {
namespace py = pybind11;
namespace {

void set_error(const Error& of_command) {
  const Error error = with_argument_names(of_command);
  const py::object type = py::module_::import("pcavr._errors").attr("Error");
  const py::object instance =
      type(text_of(error.to_string()), text_of(error.message), text_of(error.file), error.line,
           text_of(error.place), text_of(error.hint));
  PyErr_SetObject(type.ptr(), instance.ptr());
}

}  // namespace

py::str text_of(std::string_view bytes) {
  PyObject* text =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "surrogateescape");
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

void raise_error(const Error& error) {
  set_error(error);
  throw py::error_already_set();
}

void translate_exceptions() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ContractError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
      set_error({.message = error.code().message(), .file = error.path1().string()});
    }
  });
}

}  // namespace pcavr::python
