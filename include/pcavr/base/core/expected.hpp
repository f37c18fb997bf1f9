// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

/// A problem with external data. Printed as one line:
/// `file:line: place: message; hint`. Empty parts are left out.
struct Error {
  std::string message;     ///< what is wrong, with the offending value
  std::string file = {};   ///< the file or folder it is about
  int line = 0;            ///< 1-based; 0 where there are no lines
  std::string place = {};  ///< key, column or item inside the file
  std::string hint = {};   ///< what the user can do about it

  [[nodiscard]] std::string to_string() const;
};

/// A value, or the Error why there is none. Modelled on std::expected (C++23).
/// value() on an error, and error() on a value, throw ContractError.
template <typename T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Expected(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  [[nodiscard]] const T& value() const& {
    PCAVR_REQUIRE(has_value(), error().to_string());
    return std::get<0>(content_);
  }
  [[nodiscard]] T& value() & {
    PCAVR_REQUIRE(has_value(), error().to_string());
    return std::get<0>(content_);
  }
  [[nodiscard]] T&& value() && {
    PCAVR_REQUIRE(has_value(), error().to_string());
    return std::get<0>(std::move(content_));
  }
  [[nodiscard]] const Error& error() const {
    PCAVR_REQUIRE(!has_value());
    return std::get<1>(content_);
  }

  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

 private:
  std::variant<T, Error> content_;
};

/// Success, or the Error why there was none.
template <>
class [[nodiscard]] Expected<void> {
 public:
  Expected() = default;
  Expected(Error error) : error_(std::move(error)), has_value_(false) {}

  [[nodiscard]] bool has_value() const { return has_value_; }
  explicit operator bool() const { return has_value_; }
  [[nodiscard]] const Error& error() const {
    PCAVR_REQUIRE(!has_value_);
    return error_;
  }

 private:
  Error error_;
  bool has_value_ = true;
};

}  // namespace pcavr
