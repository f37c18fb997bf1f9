// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace pcavr::model {

/// The JSON of a glTF 2.0 file and the numbers of its accessors. Functions throw MeshFault or
/// nlohmann::json::exception for what is missing, of another type, or out of range.
class GltfDocument {
 public:
  /// A .glb, or a .gltf with its buffers: in the JSON, or in files of its folder. Throws MeshFault,
  /// also for a required extension without which the geometry can't be read.
  explicit GltfDocument(const std::filesystem::path& file);

  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  /// The object at `index` of a list of the file; throws if there is none.
  [[nodiscard]] const nlohmann::json& at(const char* list, const nlohmann::json& index) const;

  /// The numbers of an accessor, those of an element one after the other; normalised integers as
  /// what they stand for. `components`: numbers of an element that the caller wants, of at least as
  /// many.
  [[nodiscard]] std::vector<float> floats(const nlohmann::json& index, std::size_t components);
  [[nodiscard]] std::vector<std::uint32_t> indices(const nlohmann::json& index);
  /// Elements of an accessor.
  [[nodiscard]] std::size_t count(const nlohmann::json& index) const;
  /// Numbers of an element of an accessor.
  [[nodiscard]] std::size_t components(const nlohmann::json& index) const;

 private:
  /// Elements in a buffer: `type` of the components, at a constant distance.
  struct Elements {
    const char* first = nullptr;
    std::size_t stride = 0;  ///< [byte]
    int type = 0;
    std::size_t count = 0;
  };
  [[nodiscard]] Elements elements(const nlohmann::json& part, int type, std::size_t components,
                                  std::size_t count);
  template <typename Take>
  void for_each_number(const nlohmann::json& accessor, std::size_t components, const Take& take);
  void read_binary(const std::string& bytes);
  void parse(std::string_view text);
  void check_extensions() const;
  [[nodiscard]] std::string_view buffer(const nlohmann::json& index);

  std::filesystem::path file_;
  nlohmann::json root_;
  std::string binary_chunk_;
  bool has_binary_chunk_ = false;
  std::map<std::size_t, std::string> buffers_;
};

/// A whole number that is not negative.
[[nodiscard]] std::size_t whole_number(const nlohmann::json& number);

}  // namespace pcavr::model
