// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/gltf_document.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "base/model/gltf_uri.hpp"
#include "base/model/mesh_fault.hpp"

namespace pcavr::model {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// glTF 2.0, sections 3.6.2.2 and 4.4.
constexpr int kByte = 5120;
constexpr int kUnsignedByte = 5121;
constexpr int kShort = 5122;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

constexpr std::size_t kGlbHeader = 20;  // bytes: of the file, and of its first chunk
// Parsed, JSON takes up to ten times its size; geometry is in buffers, and few kB of JSON name it.
constexpr std::size_t kMaxJson = 100'000'000;  // bytes
constexpr int kMaxDepth = 200;                 // of nested values

std::size_t size_of_component(int type) {
  if (type == kByte || type == kUnsignedByte) return 1;
  if (type == kShort || type == kUnsignedShort) return 2;
  if (type == kUnsignedInt || type == kFloat) return 4;
  throw MeshFault("it has an accessor of the unknown component type " + std::to_string(type));
}

double load_component(const char* bytes, int type) {
  switch (type) {
    case kByte:
      return static_cast<double>(load_value<std::int8_t>(bytes, 0));
    case kUnsignedByte:
      return static_cast<double>(load_value<std::uint8_t>(bytes, 0));
    case kShort:
      return static_cast<double>(load_value<std::int16_t>(bytes, 0));
    case kUnsignedShort:
      return static_cast<double>(load_value<std::uint16_t>(bytes, 0));
    case kUnsignedInt:
      return static_cast<double>(load_value<std::uint32_t>(bytes, 0));
    default:
      return static_cast<double>(load_value<float>(bytes, 0));
  }
}

/// The largest number of an integer type, which stands for 1 where it is normalised.
double largest_of(int type) {
  switch (type) {
    case kByte:
      return 127.0;
    case kUnsignedByte:
      return 255.0;
    case kShort:
      return 32767.0;
    case kUnsignedShort:
      return 65535.0;
    default:
      throw MeshFault("it has a normalised accessor of the component type " + std::to_string(type));
  }
}

/// Whether the geometry can be read without knowing the extension: it is about what surfaces look
/// like, or it is implemented.
bool is_readable_extension(std::string_view name) {
  constexpr std::array<std::string_view, 5> kPrefixes{
      "KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"};
  return std::any_of(kPrefixes.begin(), kPrefixes.end(),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

}  // namespace

std::size_t whole_number(const json& number) {
  constexpr double kMax = 9007199254740992.0;  // up to here, doubles are exact
  const double value = number.get<double>();
  if (!(number.is_number() && value >= 0.0 && value < kMax && value == std::floor(value))) {
    throw MeshFault("it has an index or a size that is no whole number");
  }
  return static_cast<std::size_t>(value);
}

GltfDocument::GltfDocument(const fs::path& file) : file_(file) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) throw MeshFault(bytes.error().message);
  if (bytes->starts_with("glTF") || file.extension() == ".glb") {
    read_binary(*bytes);
  } else {
    parse(*bytes);
  }
  const std::string version = root_.at("asset").at("version").get<std::string>();
  if (!version.starts_with("2.")) {
    throw MeshFault("it is glTF " + version.substr(0, 30), 0, "export it as glTF 2.0");
  }
  check_extensions();
}

void GltfDocument::read_binary(const std::string& bytes) {
  if (bytes.size() < kGlbHeader) throw MeshFault("it is too short for a header");
  const auto word = [&](std::size_t at) {
    return std::size_t{load_value<std::uint32_t>(bytes.data(), at)};
  };
  if (!bytes.starts_with("glTF")) throw MeshFault("its header is not that of a .glb");
  if (word(4) != 2)
    throw MeshFault("it is binary glTF " + std::to_string(word(4)), 0, "export it as glTF 2.0");
  if (word(8) > bytes.size()) {
    throw MeshFault("its header declares " + std::to_string(word(8)) + " bytes, and the file has " +
                    std::to_string(bytes.size()));
  }
  const std::size_t text = word(12);
  if (text > bytes.size() - kGlbHeader) throw MeshFault("its first chunk is longer than the file");
  const std::size_t next = kGlbHeader + text;
  if (bytes.size() - next >= 8 && word(next + 4) == kBinaryChunk) {
    if (word(next) > bytes.size() - next - 8) {
      throw MeshFault("its binary chunk is longer than the file");
    }
    binary_chunk_ = bytes.substr(next + 8, word(next));
    has_binary_chunk_ = true;
  }
  parse(std::string_view(bytes).substr(kGlbHeader, text));
}

void GltfDocument::parse(std::string_view text) {
  if (text.size() > kMaxJson) {
    throw MeshFault("its JSON has " + std::to_string(text.size()) + " bytes; at most " +
                        std::to_string(kMaxJson) + " are read",
                    0, "export it as .glb");
  }
  root_ = json::parse(text, [](int depth, json::parse_event_t /*event*/, json& /*value*/) {
    if (depth > kMaxDepth) throw MeshFault("it is nested too deeply");
    return true;
  });
}

void GltfDocument::check_extensions() const {
  for (const json& required : root_.value("extensionsRequired", json::array())) {
    const auto& name = required.get_ref<const std::string&>();
    if (is_readable_extension(name)) continue;
    throw MeshFault("it requires the glTF extension " + name.substr(0, 60) + ", which is not read",
                    0, "export it without this extension (without compression)");
  }
}

const json& GltfDocument::at(const char* list, const json& index) const {
  const json& all = root_.at(list);
  const std::size_t i = whole_number(index);
  if (!all.is_array() || i >= all.size()) {
    throw MeshFault("it refers to number " + std::to_string(i) + " of its " + list +
                    ", of which it has " + std::to_string(all.size()));
  }
  return all[i];
}

std::string_view GltfDocument::buffer(const json& index) {
  const json& description = at("buffers", index);
  const std::size_t i = whole_number(index);
  if (!description.contains("uri")) {
    if (i == 0 && has_binary_chunk_) return binary_chunk_;
    throw MeshFault("its buffer " + std::to_string(i) + " has no data");
  }
  const auto found = buffers_.find(i);
  if (found != buffers_.end()) return found->second;
  return buffers_[i] = read_gltf_uri(description.at("uri").get_ref<const std::string&>(), file_);
}

GltfDocument::Elements GltfDocument::elements(const json& part, int type, std::size_t components,
                                              std::size_t count) {
  const json& view = at("bufferViews", part.at("bufferView"));
  const std::string_view bytes = buffer(view.at("buffer"));
  const std::size_t begin = whole_number(view.value("byteOffset", json(0)));
  const std::size_t length = whole_number(view.at("byteLength"));
  const std::size_t offset = whole_number(part.value("byteOffset", json(0)));
  const std::size_t size = components * size_of_component(type);
  const std::size_t stride =
      view.contains("byteStride") ? whole_number(view.at("byteStride")) : size;
  if (begin > bytes.size() || length > bytes.size() - begin) {
    throw MeshFault("it has a buffer view of " + std::to_string(length) + " bytes at " +
                    std::to_string(begin) + " in a buffer of " + std::to_string(bytes.size()));
  }
  // Divided, because products of declared sizes may be out of range.
  const bool fits = count == 0 || (offset <= length && size <= length - offset && stride > 0 &&
                                   count - 1 <= (length - offset - size) / stride);
  if (!fits) {
    throw MeshFault("it has an accessor of " + std::to_string(count) +
                    " elements that exceeds its buffer view of " + std::to_string(length) +
                    " bytes");
  }
  return {count == 0 ? nullptr : bytes.data() + begin + offset, stride, type, count};
}

std::size_t GltfDocument::count(const json& index) const {
  return whole_number(at("accessors", index).at("count"));
}

std::size_t GltfDocument::components(const json& index) const {
  const auto& type = at("accessors", index).at("type").get_ref<const std::string&>();
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  throw MeshFault("it has an accessor of the type " + type.substr(0, 30) +
                  " where vectors are expected");
}

/// take(position, number) for each number of an accessor, the sparse ones last.
template <typename Take>
void GltfDocument::for_each_number(const json& accessor, std::size_t components, const Take& take) {
  const auto type = static_cast<int>(whole_number(accessor.at("componentType")) % 100'000);
  const std::size_t count = whole_number(accessor.at("count"));
  const std::size_t size = size_of_component(type);
  const Elements dense = elements(accessor, type, components, count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < components; ++k) {
      take(i * components + k, load_component(dense.first + i * dense.stride + k * size, type));
    }
  }
  if (!accessor.contains("sparse")) return;
  const json& sparse = accessor.at("sparse");
  const json& places = sparse.at("indices");
  const std::size_t changed = whole_number(sparse.at("count"));
  const auto place_type = static_cast<int>(whole_number(places.at("componentType")) % 100'000);
  const Elements place = elements(places, place_type, 1, changed);
  const Elements value = elements(sparse.at("values"), type, components, changed);
  for (std::size_t i = 0; i < changed; ++i) {
    const double at = load_component(place.first + i * place.stride, place_type);
    if (!(at >= 0.0 && at < static_cast<double>(count))) {
      throw MeshFault("it has a sparse accessor whose index is out of range");
    }
    for (std::size_t k = 0; k < components; ++k) {
      take(static_cast<std::size_t>(at) * components + k,
           load_component(value.first + i * value.stride + k * size, type));
    }
  }
}

std::vector<float> GltfDocument::floats(const json& index, std::size_t components) {
  const json& accessor = at("accessors", index);
  if (this->components(index) < components)
    throw MeshFault("it has an accessor with too few components");
  const auto type = static_cast<int>(whole_number(accessor.at("componentType")) % 100'000);
  const bool is_normalised = accessor.value("normalized", false) && type != kFloat;
  const double scale = is_normalised ? 1.0 / largest_of(type) : 1.0;
  std::vector<float> numbers;
  // Checked before memory is taken.
  (void)elements(accessor, type, components, count(index));
  numbers.resize(count(index) * components);
  for_each_number(accessor, components, [&](std::size_t at, double number) {
    // The smallest signed integer stands for -1, too [glTF 2.0, 3.6.2.2].
    numbers[at] = static_cast<float>(is_normalised ? std::max(number * scale, -1.0) : number);
  });
  return numbers;
}

std::vector<std::uint32_t> GltfDocument::indices(const json& index) {
  const json& accessor = at("accessors", index);
  const auto type = static_cast<int>(whole_number(accessor.at("componentType")) % 100'000);
  if (components(index) != 1 ||
      (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)) {
    throw MeshFault("it has indices that are not unsigned whole numbers");
  }
  (void)elements(accessor, type, 1, count(index));
  std::vector<std::uint32_t> numbers(count(index));
  for_each_number(accessor, 1, [&](std::size_t at, double number) {
    numbers[at] = static_cast<std::uint32_t>(number);
  });
  return numbers;
}

}  // namespace pcavr::model
