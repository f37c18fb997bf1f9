// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object/parameter_fields.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr {
namespace parameter_file {

const Field* field_of_key(std::string_view key) {
  constexpr std::string_view kContact = "contact.";
  const bool is_contact = key.starts_with(kContact);
  if (is_contact) key.remove_prefix(kContact.size());
  const std::span<const Field> fields =
      is_contact ? std::span<const Field>(kContactFields) : std::span<const Field>(kFields);
  const auto field = std::find_if(fields.begin(), fields.end(),
                                  [key](const Field& one) { return one.key == key; });
  return field == fields.end() ? nullptr : &*field;
}

}  // namespace parameter_file

std::vector<std::pair<std::string, ParameterValue>> list_parameters(
    const ObjectParameters& parameters) {
  std::vector<std::pair<std::string, ParameterValue>> listed;
  const auto list = [&](const parameter_file::Field& field, const std::string& prefix) {
    const std::optional<ParameterValue>& parameter = parameters.*field.member;
    if (parameter) listed.emplace_back(prefix + field.key, *parameter);
  };
  for (const parameter_file::Field& field : parameter_file::kFields) list(field, "");
  for (const parameter_file::Field& field : parameter_file::kContactFields) list(field, "contact_");
  return listed;
}

std::optional<ParameterValue>* find_parameter(std::string_view key, ObjectParameters& parameters) {
  const parameter_file::Field* const field = parameter_file::field_of_key(key);
  return field == nullptr ? nullptr : &(parameters.*field->member);
}

}  // namespace pcavr
