// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/tiles_content.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"

#include "content_text.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kFolderPath = "/scene/tiles/";
constexpr char kTilesetFile[] = "tileset.json";
constexpr char kBodiesTile[] = "tiles/bodies.glb";
constexpr char kHint[] = "write it by pcavr export SCENE --to 3dtiles -o TILES";
constexpr int kMaxDepth = 64;  ///< each level halves the tiles: none is as deep

/// The file of a tile's content; empty: it has none.
std::string tile_name(const Json& tile) {
  if (!tile.contains("content")) return {};
  const Json& content = tile["content"];
  return content.is_object() ? content.value("uri", std::string()) : std::string();
}

/// A name inside the folder: no absolute path, no parent folder, no hidden file, no query.
bool is_plain(const std::string& name) {
  const bool has_odd = std::any_of(name.begin(), name.end(), [](char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return !is_letter && !(c >= '0' && c <= '9') &&
           std::string_view("._-/").find(c) == std::string_view::npos;
  });
  return !has_odd && name.ends_with(".glb") && name[0] != '/' && name[0] != '.' &&
         name.find("/.") == std::string::npos;
}

/// Adds the files of a tile and of those below it.
Expected<void> collect_names(const Json& tile, int depth,
                             std::set<std::string, std::less<>>& names) {
  if (!tile.is_object() || depth > kMaxDepth) {
    return Error{.message = "is not a tree of tiles", .place = "root", .hint = kHint};
  }
  if (const std::string name = tile_name(tile); !name.empty()) {
    if (!is_plain(name)) {
      return Error{.message = "'" + name + "' is not a tile (.glb) of this folder",
                   .place = "content.uri",
                   .hint = kHint};
    }
    names.insert(name);
  }
  if (!tile.contains("children")) return {};
  for (const Json& child : tile["children"]) {
    if (auto done = collect_names(child, depth + 1, names); !done) return done;
  }
  return {};
}

/// Removes the bodies' tile, which is a child of the root.
void remove_bodies(Json& root) {
  if (!root.contains("children") || !root["children"].is_array()) return;
  Json kept = Json::array();
  for (Json& child : root["children"]) {
    if (!child.is_object() || tile_name(child) != kBodiesTile) kept.push_back(std::move(child));
  }
  root["children"] = std::move(kept);
}

Expected<Json> read_tileset(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) {
    Error error = text.error();
    error.hint = kHint;
    return error;
  }
  Json tileset = Json::parse(*text, nullptr, false);
  if (!tileset.is_object() || !tileset.contains("asset") || !tileset.contains("root")) {
    return Error{.message = "is not a tileset of 3D Tiles", .file = file.string(), .hint = kHint};
  }
  return tileset;
}

}  // namespace

Expected<TilesContent> TilesContent::create(const fs::path& folder) try {
  const fs::path file = folder / kTilesetFile;
  Expected<Json> tileset = read_tileset(file);
  if (!tileset) return tileset.error();
  Json& root = tileset.value()["root"];
  remove_bodies(root);
  TilesContent content;
  if (auto done = collect_names(root, 0, content.names_); !done) {
    Error error = done.error();
    error.file = file.string();
    return error;
  }
  if (content.names_.empty()) {
    return Error{.message = "has no tiles of a scan",
                 .file = file.string(),
                 .hint = "serve the scene without --tiles"};
  }
  for (const std::string& name : content.names_) {
    std::error_code fault;
    content.bytes_ += fs::file_size(folder / name, fault);
    if (fault) {
      return Error{.message = fault.message(), .file = (folder / name).string(), .hint = kHint};
    }
  }
  content.folder_ = folder;
  content.tileset_ = std::make_shared<const Content>(make_content(kJsonMedia, json_text(*tileset)));
  return content;
} catch (const Json::exception& error) {
  return Error{.message = std::string("is not a tileset of 3D Tiles: ") + error.what(),
               .file = (folder / kTilesetFile).string(),
               .hint = kHint};
}

Expected<std::shared_ptr<const Content>> TilesContent::find(std::string_view path) const {
  if (path == kTilesetPath) return tileset_;
  if (!path.starts_with(kFolderPath)) return std::shared_ptr<const Content>();
  const auto name = names_.find(path.substr(kFolderPath.size()));
  if (name == names_.end()) return std::shared_ptr<const Content>();
  Expected<std::string> bytes = read_file(folder_ / *name);
  if (!bytes) return bytes.error();
  return std::make_shared<const Content>(Content{kGlbMedia, std::move(*bytes), false});
}

}  // namespace pcavr
