// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "recordings/cloud/parse_formats.hpp"

namespace pcavr {
namespace {

/// The longest match is 264 bytes, coded in 3.
constexpr std::size_t kMaxRatio = 88;

/// Bytes of the input, one by one; past the end it is invalid.
struct LzfInput {
  std::string_view rest;
  bool is_valid = true;

  unsigned take() {
    if (rest.empty()) {
      is_valid = false;
      return 0;
    }
    const auto byte = static_cast<unsigned char>(rest.front());
    rest.remove_prefix(1);
    return byte;
  }
};

/// Copies the match that starts with `control`; false where it lies outside of the output so far.
bool copy_match(unsigned control, std::size_t size, LzfInput& input, std::string& output) {
  std::size_t length = control >> 5;
  if (length == 7) length += input.take();
  length += 2;
  const std::size_t offset = ((control & 31U) << 8 | input.take()) + 1;
  if (!input.is_valid || offset > output.size() || length > size - output.size()) return false;
  // A match may overlap what it produces: it then repeats what is there.
  const std::size_t from = output.size() - offset;
  while (length > 0) {
    const std::size_t copied = std::min(length, output.size() - from);
    output.append(output, from, copied);
    length -= copied;
  }
  return true;
}

}  // namespace

std::optional<std::string> decompress_lzf(std::string_view compressed, std::size_t size) {
  if (size / kMaxRatio > compressed.size()) return std::nullopt;
  std::string output;
  output.reserve(size);
  LzfInput input{compressed};
  while (!input.rest.empty()) {
    const unsigned control = input.take();
    if (control >= 32) {
      if (!copy_match(control, size, input, output)) return std::nullopt;
      continue;
    }
    const std::size_t literals = control + 1;
    if (literals > input.rest.size() || literals > size - output.size()) return std::nullopt;
    output.append(input.rest.substr(0, literals));
    input.rest.remove_prefix(literals);
  }
  if (output.size() != size) return std::nullopt;
  return output;
}

}  // namespace pcavr
