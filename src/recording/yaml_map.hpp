// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/input_ranges.hpp"

namespace pcavr {

/// Leaves the depths of a YAML tree in one step; caught where the parser begins, as exceptions of
/// yaml-cpp itself must be. Never leaves the module.
struct YamlFailure {
  Error error;  ///< without the file's name
};

/// A YAML node with the path of keys that leads to it, for errors. All getters throw YamlFailure.
class YamlValue {
 public:
  YamlValue(YAML::Node node, std::string place)
      : node_(std::move(node)), place_(std::move(place)) {}

  [[noreturn]] void fail(const std::string& message, const std::string& hint) const;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] double positive_number() const;
  /// Fails with the range's ends and unit where the number lies outside.
  [[nodiscard]] double number_in(const InputRange& range) const;
  [[nodiscard]] int integer(int least, int most) const;
  [[nodiscard]] bool boolean() const;
  /// Exactly `count` numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  /// Each of them in the range.
  [[nodiscard]] std::vector<double> numbers_in(std::size_t count, const InputRange& range) const;
  [[nodiscard]] std::vector<YamlValue> items() const;

  /// What a map holds, in the file's order, where its keys are names that are not known beforehand.
  /// Refuses a key that is there twice.
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// Refuses anything but a map with some of these keys, each at most once.
  void expect_keys(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] YamlValue at(const std::string& key) const;
  /// Nothing where the key is absent or its value is empty.
  [[nodiscard]] std::optional<YamlValue> find(const std::string& key) const;

 private:
  [[nodiscard]] std::string place_of(const std::string& key) const;

  YAML::Node node_;
  std::string place_;
};

/// What `read` makes of the YAML text's root; its faults, and those of the syntax, as Errors.
template <typename Result, typename Read>
[[nodiscard]] Expected<Result> parse_yaml(const std::string& text, const std::string& file,
                                          Read read) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) {
      return Error{.message = "is empty", .file = file, .hint = "write its keys"};
    }
    return read(YamlValue(root, ""));
  } catch (const YamlFailure& failure) {
    Error error = failure.error;
    error.file = file;
    return error;
  } catch (const YAML::Exception& exception) {
    return Error{.message = "is not YAML: " + exception.msg,
                 .file = file,
                 .line = exception.mark.line + 1,
                 .hint = "correct the line, mind the indentation"};
  }
}

}  // namespace pcavr
