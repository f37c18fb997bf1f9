// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <pybind11/numpy.h>

namespace pcavr::python {

/// A read-only array over memory that `owner` keeps alive; nothing is copied. `strides` [bytes].
template <typename T>
[[nodiscard]] pybind11::array_t<T> view_of(const T* first, std::vector<pybind11::ssize_t> shape,
                                           std::vector<pybind11::ssize_t> strides,
                                           const pybind11::handle& owner) {
  pybind11::array_t<T> view(std::move(shape), std::move(strides), first, owner);
  view.attr("setflags")(pybind11::arg("write") = false);
  return view;
}

/// The same over one member of each element of a vector: `width` numbers of `at(element)`.
template <typename Element, typename At>
[[nodiscard]] auto member_view(const std::vector<Element>& elements, pybind11::ssize_t width, At at,
                               const pybind11::handle& owner) {
  using T = std::remove_cvref_t<decltype(*at(elements.front()))>;
  if (elements.empty()) {
    return pybind11::array_t<T>(pybind11::array::ShapeContainer{pybind11::ssize_t{0}, width});
  }
  return view_of<T>(
      at(elements.front()), {static_cast<pybind11::ssize_t>(elements.size()), width},
      {static_cast<pybind11::ssize_t>(sizeof(Element)), static_cast<pybind11::ssize_t>(sizeof(T))},
      owner);
}

}  // namespace pcavr::python
