// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/yaml_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/utf8.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {

YamlValue::YamlValue(const YAML::Node& node, std::string place)
    : node_(std::make_shared<const YAML::Node>(node)), place_(std::move(place)) {}

void YamlValue::fail(const std::string& message, const std::string& hint) const {
  throw YamlFailure(
      {.message = message, .line = node_->Mark().line + 1, .place = place_, .hint = hint});
}

void YamlValue::fail_at_key(const std::string& key, const std::string& message,
                            const std::string& hint) const {
  for (const auto& entry : *node_) {
    if (entry.first.IsScalar() && entry.first.Scalar() == key) {
      YamlValue(entry.first, place_).fail(message, hint);
    }
  }
  fail(message, hint);
}

std::string YamlValue::text() const {
  if (!node_->IsScalar()) fail("is not a text", "write one value");
  if (!is_utf8_text(node_->Scalar())) fail("is not UTF-8 text", "save the file as UTF-8");
  return node_->Scalar();
}

double YamlValue::number() const {
  const std::string scalar = text();
  const std::optional<double> number = parse_number(scalar);
  if (!number) fail("'" + scalar + "' is not a finite number", "write a decimal number");
  return *number;
}

double YamlValue::positive_number() const {
  const double value = number();
  if (!(value > 0.0)) fail("is " + text() + ", not positive", "write a positive number");
  return value;
}

double YamlValue::number_in(const InputRange& range) const {
  const double value = number();
  if (const std::optional<Error> error = check_range(range, value, text())) {
    fail(error->message, error->hint);
  }
  return value;
}

int YamlValue::integer(int min, int max) const {
  const double value = number();
  if (value != std::floor(value) || value < min || value > max) {
    fail("'" + text() + "' is not an integer from " + std::to_string(min) + " to " +
             std::to_string(max),
         "write an integer in this range");
  }
  return static_cast<int>(value);
}

bool YamlValue::boolean() const {
  const std::string scalar = text();
  if (scalar != "true" && scalar != "false") fail("is '" + scalar + "'", "write true or false");
  return scalar == "true";
}

std::vector<double> YamlValue::numbers(std::size_t count) const {
  const std::vector<YamlValue> values = items();
  if (values.size() != count) {
    fail("has " + std::to_string(values.size()) + " numbers, not " + std::to_string(count),
         "write " + std::to_string(count) + " numbers in brackets");
  }
  std::vector<double> numbers;
  numbers.reserve(values.size());
  for (const YamlValue& value : values) numbers.push_back(value.number());
  return numbers;
}

std::vector<double> YamlValue::numbers_in(std::size_t count, const InputRange& range) const {
  std::vector<double> inside = numbers(count);
  const std::vector<YamlValue> values = items();
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = values[i].number_in(range);
  return inside;
}

bool YamlValue::is_list() const { return node_->IsSequence(); }

std::vector<YamlValue> YamlValue::items() const {
  if (!node_->IsSequence())
    fail("is not a list", "write a list: [a, b] or lines that begin with -");
  std::vector<YamlValue> items;
  for (const YAML::Node& item : *node_) {
    items.emplace_back(item, place_ + "[" + std::to_string(items.size()) + "]");
  }
  return items;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  if (!node_->IsMap()) fail("is not a map of keys", "write 'key: value' lines");
  std::vector<std::pair<std::string, YamlValue>> entries;
  std::set<std::string> seen;
  for (const auto& entry : *node_) {
    const YamlValue key(entry.first, place_);
    const std::string name = key.text();
    if (!seen.insert(name).second) key.fail("key '" + name + "' is listed twice", "keep one");
    entries.emplace_back(name, YamlValue(entry.second, place_of(name)));
  }
  return entries;
}

void YamlValue::expect_keys(std::initializer_list<std::string_view> keys) const {
  if (!node_->IsMap()) fail("is not a map of keys", "write 'key: value' lines");
  for (const auto& entry : *node_) {
    const YamlValue key(entry.first, place_);
    const std::string name = key.text();
    if (std::find(keys.begin(), keys.end(), name) == keys.end()) {
      std::string known;
      for (const std::string_view k : keys) known += (known.empty() ? "" : ", ") + std::string(k);
      key.fail("unknown key '" + name + "'", "known keys: " + known);
    }
  }
  (void)entries();  // rejects duplicate keys
}

YamlValue YamlValue::at(const std::string& key) const {
  std::optional<YamlValue> value = find(key);
  if (!value) fail("key '" + key + "' is missing", "add it");
  return *std::move(value);
}

std::optional<YamlValue> YamlValue::find(const std::string& key) const {
  if (!node_->IsMap()) fail("is not a map of keys", "write 'key: value' lines");
  const YAML::Node value = (*node_)[key];
  if (!value || value.IsNull()) return std::nullopt;
  return YamlValue(value, place_of(key));
}

std::string YamlValue::place_of(const std::string& key) const {
  return place_.empty() ? key : place_ + "." + key;
}

std::optional<Error> read_yaml(const std::string& text, const std::string& file,
                               const std::function<void(const YamlValue& root)>& read) {
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) {
      return Error{.message = "is empty", .file = file, .hint = "write the required keys"};
    }
    read(YamlValue(root, ""));
    return std::nullopt;
  } catch (const YamlFailure& failure) {
    Error error = failure.error;
    error.file = file;
    return error;
  } catch (const YAML::Exception& exception) {
    return Error{.message = "is not YAML: " + exception.msg,
                 .file = file,
                 .line = exception.mark.line + 1,
                 .hint = "correct the line; check the indentation"};
  }
}

}  // namespace pcavr
