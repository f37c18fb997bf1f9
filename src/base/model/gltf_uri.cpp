// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/gltf_uri.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"

#include "base/model/mesh_fault.hpp"

namespace pcavr::model {
namespace {

std::string decoded_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) throw MeshFault("it has a buffer that is not base64");
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> static_cast<unsigned>(count));
  }
  return bytes;
}

/// %20 and the like [RFC 3986].
std::string decoded_percent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned code = 0;
    const char* digits = text.data() + i + 1;
    const bool is_escape = text[i] == '%' && i + 2 < text.size() &&
                           std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    decoded += is_escape ? static_cast<char>(code) : text[i];
    if (is_escape) i += 2;
  }
  return decoded;
}

}  // namespace

std::string read_gltf_uri(const std::string& uri, const std::filesystem::path& file) {
  const std::string_view text = uri;
  if (text.starts_with("data:")) {
    constexpr std::string_view kMark = ";base64,";
    const std::size_t mark = text.find(kMark);
    if (mark == text.npos) throw MeshFault("it has a buffer that is not base64");
    return decoded_base64(text.substr(mark + kMark.size()));
  }
  const std::filesystem::path relative = decoded_percent(text);
  const bool leaves = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (relative.empty() || relative.is_absolute() || leaves || text.find("://") != text.npos) {
    throw MeshFault("its buffer '" + uri.substr(0, 60) + "' is not in the file's folder", 0,
                    "put it there, or export the mesh as .glb");
  }
  const std::filesystem::path path = file.parent_path() / relative;
  const Expected<std::uintmax_t> size = regular_file_size(path);
  if (!size) throw MeshFault("its buffer " + uri.substr(0, 60) + " " + size.error().message);
  Expected<std::string> bytes = read_file(path);
  if (!bytes) throw MeshFault("its buffer " + uri.substr(0, 60) + " " + bytes.error().message);
  return *std::move(bytes);
}

}  // namespace pcavr::model
