// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/content.hpp"

namespace pcavr {

/// A scan as the 3D Tiles of `export --to 3dtiles`: kTilesetPath, and beside it the tiles that it
/// names, each read when it is requested. No other file of the folder is served. Const and
/// thread-safe.
class TilesContent : public ContentSource {
 public:
  static constexpr char kTilesetPath[] = "/scene/tiles/tileset.json";

  /// Reads the tileset and leaves out the bodies, which a page draws where the world has them. An
  /// Error if the folder has no such tileset, or lacks a tile that it names.
  [[nodiscard]] static Expected<TilesContent> create(const std::filesystem::path& folder);

  /// An Error for a tile that can't be read any more.
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

  [[nodiscard]] std::size_t tiles() const { return names_.size(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }  ///< of all tiles

 private:
  std::filesystem::path folder_;
  std::shared_ptr<const Content> tileset_;
  std::set<std::string, std::less<>> names_;  ///< relative to the folder
  std::size_t bytes_ = 0;
};

}  // namespace pcavr
