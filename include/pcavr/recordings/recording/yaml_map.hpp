// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/input_ranges.hpp"

namespace YAML {
class Node;
}

namespace pcavr {

/// Exception for an invalid YAML value; parse_yaml() catches it, like the exceptions of yaml-cpp,
/// and returns it as an Error. Never leaves parse_yaml().
struct YamlFailure : std::runtime_error {
  explicit YamlFailure(Error failure)
      : std::runtime_error(failure.to_string()), error(std::move(failure)) {}
  Error error;  ///< without the file's name
};

/// A YAML node with its path of keys, for errors. All getters throw YamlFailure.
class YamlValue {
 public:
  YamlValue(const YAML::Node& node, std::string place);

  [[noreturn]] void fail(const std::string& message, const std::string& hint) const;
  /// Fails at the line of a key of this map.
  [[noreturn]] void fail_at_key(const std::string& key, const std::string& message,
                                const std::string& hint) const;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] double positive_number() const;
  /// Fails with the range's limits and unit where the number lies outside.
  [[nodiscard]] double number_in(const InputRange& range) const;
  [[nodiscard]] int integer(int min, int max) const;
  [[nodiscard]] bool boolean() const;
  /// Exactly `count` numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  /// Each of them in the range.
  [[nodiscard]] std::vector<double> numbers_in(std::size_t count, const InputRange& range) const;
  [[nodiscard]] bool is_list() const;
  [[nodiscard]] std::vector<YamlValue> items() const;

  /// The entries of a map in the file's order, for keys that are names chosen by the user. Fails on
  /// duplicate keys.
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// Fails unless the node is a map that has only these keys, each at most once.
  void expect_keys(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] YamlValue at(const std::string& key) const;
  /// nullopt where the key is absent or its value is empty.
  [[nodiscard]] std::optional<YamlValue> find(const std::string& key) const;

 private:
  [[nodiscard]] std::string place_of(const std::string& key) const;

  std::shared_ptr<const YAML::Node> node_;
  std::string place_;
};

/// Parses the text and hands its root to `read`. What YamlFailure, YAML itself or an empty text
/// reports is returned with the file's name.
[[nodiscard]] std::optional<Error> read_yaml(
    const std::string& text, const std::string& file,
    const std::function<void(const YamlValue& root)>& read);

/// Applies `read` to the root of the YAML text; its failures and syntax errors become Errors.
template <typename Result, typename Read>
[[nodiscard]] Expected<Result> parse_yaml(const std::string& text, const std::string& file,
                                          Read read) {
  std::optional<Expected<Result>> result;
  std::optional<Error> error =
      read_yaml(text, file, [&](const YamlValue& root) { result.emplace(read(root)); });
  if (error) return *std::move(error);
  return *std::move(result);
}

}  // namespace pcavr
