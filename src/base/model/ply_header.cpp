// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "base/model/mesh_fault.hpp"

namespace pcavr::model {
namespace {

// No exporter comes near: bounds for the memory of a header and of a row.
constexpr int kMaxHeaderLines = 10'000;
constexpr std::size_t kMaxProperties = 1000;

std::string in_quotes(std::string_view word) { return "'" + std::string(word.substr(0, 30)) + "'"; }

std::optional<PlyNumber> number_type(std::string_view name) {
  using Entry = std::pair<std::string_view, PlyNumber>;
  constexpr std::array<Entry, 16> kTypes{
      Entry{"char", PlyNumber::kInt8},     Entry{"int8", PlyNumber::kInt8},
      Entry{"uchar", PlyNumber::kUint8},   Entry{"uint8", PlyNumber::kUint8},
      Entry{"short", PlyNumber::kInt16},   Entry{"int16", PlyNumber::kInt16},
      Entry{"ushort", PlyNumber::kUint16}, Entry{"uint16", PlyNumber::kUint16},
      Entry{"int", PlyNumber::kInt32},     Entry{"int32", PlyNumber::kInt32},
      Entry{"uint", PlyNumber::kUint32},   Entry{"uint32", PlyNumber::kUint32},
      Entry{"float", PlyNumber::kFloat},   Entry{"float32", PlyNumber::kFloat},
      Entry{"double", PlyNumber::kDouble}, Entry{"float64", PlyNumber::kDouble}};
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const Entry& entry) { return entry.first == name; });
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

/// The lines of one header.
class PlyHeaderReader {
 public:
  explicit PlyHeaderReader(ByteReader& bytes) : bytes_(bytes) {}

  PlyHeader read() {
    const auto first = bytes_.line();
    if (!first || *first != "ply") throw MeshFault("its header is not that of a PLY file");
    while (const auto line = bytes_.line()) {
      split_words(*line, words_);
      if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
      if (words_[0] == "end_header") {
        if (!has_format_) fail("its header has no format");
        check_counts();
        return std::move(header_);
      }
      if (bytes_.line_number() > kMaxHeaderLines) break;
      read_line();
    }
    throw MeshFault("its header has no end");
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw MeshFault(reason, bytes_.line_number());
  }

  void read_line() {
    if (words_[0] == "format") return read_format();
    if (words_[0] == "element") return read_element();
    if (words_[0] == "property") return read_property();
    fail(in_quotes(words_[0]) +
         " is not a keyword of a PLY header: its header has no end, or is damaged");
  }

  void read_format() {
    const std::string_view format = words_.size() == 3 && words_[2] == "1.0" ? words_[1] : "";
    has_format_ = true;
    if (format == "ascii") {
      header_.format = PlyFormat::kText;
    } else if (format == "binary_little_endian") {
      header_.format = PlyFormat::kLittleEndian;
    } else if (format == "binary_big_endian") {
      header_.format = PlyFormat::kBigEndian;
    } else {
      fail("its format is not ascii, binary_little_endian or binary_big_endian 1.0");
    }
  }

  void read_element() {
    if (words_.size() != 3) fail("an element has not one name and one number");
    PlyElement element{.name = std::string(words_[1])};
    const auto [end, code] =
        std::from_chars(words_[2].data(), words_[2].data() + words_[2].size(), element.count);
    if (code != std::errc{} || end != words_[2].data() + words_[2].size()) {
      fail("its header declares " + in_quotes(words_[2]) + " of " + element.name);
    }
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) fail("it has two elements " + in_quotes(element.name));
    }
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property belongs to no element");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    const bool is_list = words_.size() == 5 && words_[1] == "list";
    if (!is_list && words_.size() != 3) fail("a property has not one type and one name");
    PlyProperty property{.name = std::string(words_.back())};
    property.type = type_of(words_[words_.size() - 2]);
    if (is_list) {
      property.count_type = type_of(words_[2]);
      if (*property.count_type >= PlyNumber::kFloat)
        fail("the length of a list is no whole number");
    }
    if (properties.size() == kMaxProperties) fail("an element has more than 1000 properties");
    properties.push_back(std::move(property));
  }

  [[nodiscard]] PlyNumber type_of(std::string_view name) const {
    const std::optional<PlyNumber> type = number_type(name);
    if (!type) fail(in_quotes(name) + " is not a type of numbers");
    return *type;
  }

  void check_counts() const {
    std::uintmax_t left = bytes_.remaining();
    for (const PlyElement& element : header_.elements) {
      std::uintmax_t row = 0;
      for (const PlyProperty& property : element.properties) {
        // A list has at least its length. In text a number takes a digit and a blank, except the
        // last of a file.
        row += header_.format == PlyFormat::kText
                   ? 1
                   : size_of(property.count_type.value_or(property.type));
      }
      const std::uintmax_t room = left / std::max<std::uintmax_t>(row, 1);
      if (element.count > room) {
        throw MeshFault("its header declares " + std::to_string(element.count) + " of " +
                        element.name + ", and the file has room for " + std::to_string(room));
      }
      left -= element.count * row;
    }
  }

  ByteReader& bytes_;
  std::vector<std::string_view> words_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

std::size_t size_of(PlyNumber type) {
  switch (type) {
    case PlyNumber::kInt8:
    case PlyNumber::kUint8:
      return 1;
    case PlyNumber::kInt16:
    case PlyNumber::kUint16:
      return 2;
    case PlyNumber::kDouble:
      return 8;
    default:
      return 4;
  }
}

PlyHeader read_ply_header(ByteReader& bytes) { return PlyHeaderReader(bytes).read(); }

}  // namespace pcavr::model
