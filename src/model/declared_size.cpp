// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/declared_size.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "model/file_start.hpp"

namespace pcavr::model {
namespace fs = std::filesystem;
namespace {

std::vector<std::string_view> header_words(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == line.npos) return words;
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

/// [byte] Of a number in a binary PLY; 1 for an unknown type, so that no valid file is rejected.
std::uintmax_t bytes_of_type(std::string_view type) {
  for (const std::string_view two : {"short", "ushort", "int16", "uint16"}) {
    if (type == two) return 2;
  }
  for (const std::string_view four : {"int", "uint", "int32", "uint32", "float", "float32"}) {
    if (type == four) return 4;
  }
  return type == "double" || type == "float64" ? 8 : 1;
}

/// One element of a PLY header: the declared count, and the minimum bytes of one.
struct PlyElement {
  std::string_view name;
  std::uintmax_t count = 0;
  std::uintmax_t min_bytes = 0;
};

std::optional<std::string> find_element_mismatch(const std::vector<PlyElement>& elements,
                                                 std::uintmax_t content) {
  std::uintmax_t needed = 0;
  for (const PlyElement& element : elements) {
    const std::uintmax_t room =
        element.min_bytes == 0 ? content : (content - needed) / element.min_bytes;
    if (element.count > room) {
      return "its header declares " + std::to_string(element.count) + " of " +
             std::string(element.name) + ", and the file has room for " + std::to_string(room);
    }
    needed += element.count * element.min_bytes;
  }
  return std::nullopt;
}

std::optional<std::string> find_ply_mismatch(const FileStart& start) {
  std::string_view rest = start.text;
  if (!rest.starts_with("ply")) return "its header is not that of a PLY file";
  bool is_text = true;
  std::vector<PlyElement> elements;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    if (end == rest.npos) break;
    const std::vector<std::string_view> words = header_words(rest.substr(0, end));
    rest.remove_prefix(end + 1);
    if (words.empty()) continue;
    if (words[0] == "end_header") {
      return find_element_mismatch(elements, start.size - (start.text.size() - rest.size()));
    }
    if (words[0] == "format" && words.size() > 1) is_text = words[1] == "ascii";
    if (words[0] == "element" && words.size() > 2) {
      PlyElement element{.name = words[1]};
      const std::string_view digits = words[2];
      const auto [at, code] =
          std::from_chars(digits.data(), digits.data() + digits.size(), element.count);
      if (code != std::errc{} || at != digits.data() + digits.size()) {
        return "its header declares '" + std::string(digits) + "' of " + std::string(words[1]);
      }
      elements.push_back(element);
    }
    if (words[0] == "property" && words.size() > 2 && !elements.empty()) {
      // A list has at least its count. In text a number takes a digit and a blank, except the last
      // of a file.
      const bool is_list = words[1] == "list";
      elements.back().min_bytes += is_text ? 1 : bytes_of_type(words[is_list ? 2 : 1]);
    }
  }
  return "its header has no end";
}

/// Little-endian.
std::uint32_t read_uint32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i > 0; --i) {
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + i - 1]);
  }
  return value;
}

/// A binary STL is an arbitrary header of 80 bytes, a count, and 50 bytes per triangle. An ASCII
/// STL has no count.
std::optional<std::string> find_stl_mismatch(const FileStart& start) {
  constexpr std::size_t kHeader = 84;       // 80 bytes of text and the count
  constexpr std::uintmax_t kTriangle = 50;  // 12 floats and 2 bytes of attributes
  const bool is_text =
      start.text.starts_with("solid") && start.text.find("facet") != std::string::npos;
  if (is_text || start.text.size() < kHeader) return std::nullopt;
  const std::uintmax_t declared = read_uint32(start.text, 80);
  const std::uintmax_t room = (start.size - kHeader) / kTriangle;
  if (declared <= room) return std::nullopt;
  return "its header declares " + std::to_string(declared) +
         " triangles, and the file has room for " + std::to_string(room);
}

/// 12 bytes of header, then chunks: 8 bytes of header and the declared length [glTF 2.0, 4.4].
std::optional<std::string> find_glb_mismatch(const FileStart& start) {
  if (start.text.size() < 20) return "it is too short for a header";
  const std::uintmax_t declared = read_uint32(start.text, 8);
  const std::uintmax_t chunk = read_uint32(start.text, 12);
  if (declared > start.size) {
    return "its header declares " + std::to_string(declared) + " bytes, and the file has " +
           std::to_string(start.size);
  }
  if (chunk > start.size - 20) return "its first chunk is longer than the file";
  return std::nullopt;
}

/// Whether JSON brackets nest deeper than any exporter's: assimp's recursive parser would overflow
/// the stack. Brackets in strings do not count; the binary chunk of a .glb is not scanned.
bool is_nested_too_deeply(const fs::path& file, std::uintmax_t begin, std::uintmax_t end) {
  constexpr int kMaxDepth = 200;  // a recursive reader stays within its stack
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(begin));
  int depth = 0;
  bool is_string = false;
  bool is_escaped = false;
  std::string chunk(kMaxHeader, '\0');
  for (std::uintmax_t left = end - begin; left > 0 && stream;) {
    stream.read(chunk.data(),
                static_cast<std::streamsize>(std::min<std::uintmax_t>(left, kMaxHeader)));
    const auto count = static_cast<std::size_t>(stream.gcount());
    left -= count;
    for (std::size_t i = 0; i < count; ++i) {
      const char c = chunk[i];
      if (is_string) {
        is_string = is_escaped || c != '"';
        is_escaped = !is_escaped && c == '\\';
      } else if (c == '"') {
        is_string = true;
      } else if (c == '[' || c == '{') {
        if (++depth > kMaxDepth) return true;
      } else if (c == ']' || c == '}') {
        --depth;
      }
    }
  }
  return false;
}

/// The same for the elements of an XML document. A '>' within a value counts as the end of a tag,
/// which does no harm; comments count as nothing where they hold no tags.
bool has_deep_elements(const fs::path& file) {
  constexpr int kMaxDepth = 200;
  std::ifstream stream(file, std::ios::binary);
  int depth = 0;
  char before = '\0';
  bool opens = false;  // the tag that the stream is in
  for (std::istreambuf_iterator<char> at(stream), end; at != end; ++at) {
    const char c = *at;
    if (before == '<') {
      opens = c != '/' && c != '!' && c != '?';
      if (opens && ++depth > kMaxDepth) return true;
      if (c == '/') --depth;
    } else if (c == '>' && opens) {
      if (before == '/') --depth;
      opens = false;
    }
    before = c;
  }
  return false;
}

}  // namespace

std::optional<std::string> find_size_mismatch(const fs::path& file, const std::string& extension) {
  if (extension == ".ply") return find_ply_mismatch(read_file_start(file));
  if (extension == ".stl") return find_stl_mismatch(read_file_start(file));
  if (extension == ".dae" && has_deep_elements(file)) return "it is nested too deeply";
  if (extension != ".glb" && extension != ".gltf") return std::nullopt;
  const FileStart start = read_file_start(file);
  const bool is_binary = start.text.starts_with("glTF");
  if (is_binary || extension == ".glb") {
    if (auto reason = find_glb_mismatch(start)) return reason;
  }
  const std::uintmax_t begin = is_binary ? 20 : 0;
  const std::uintmax_t end = is_binary ? begin + read_uint32(start.text, 12) : start.size;
  if (is_nested_too_deeply(file, begin, end)) return "it is nested too deeply";
  return std::nullopt;
}

}  // namespace pcavr::model
