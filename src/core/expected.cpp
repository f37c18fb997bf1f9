// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/core/expected.hpp"

namespace pcavr {

std::string Error::to_string() const {
  std::string text = file;
  if (line > 0) text += ':' + std::to_string(line);
  if (!place.empty()) text += (text.empty() ? "" : ": ") + place;
  text += (text.empty() ? "" : ": ") + message;
  if (!hint.empty()) text += "; " + hint;
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

}  // namespace pcavr
