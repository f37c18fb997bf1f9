// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// Serialises an nlohmann::json to text, on one line where `indent` is below 0. Bytes of a name or
/// path that are not valid UTF-8 become U+FFFD. A template, so that the library stays out of here.
template <typename Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pcavr
