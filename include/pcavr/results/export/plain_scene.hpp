// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"

namespace pcavr {

/// Formats of geometry alone, without masses and friction.
enum class PlainFormat { gltf, ply, obj, stl, pcd, tiles };

/// By their names in `pcavr export --to`.
inline constexpr std::array<std::pair<std::string_view, PlainFormat>, 6> kPlainFormats{
    {{"gltf", PlainFormat::gltf},
     {"ply", PlainFormat::ply},
     {"obj", PlainFormat::obj},
     {"stl", PlainFormat::stl},
     {"pcd", PlainFormat::pcd},
     {"3dtiles", PlainFormat::tiles}}};
/// Empty: no plain format has that name.
[[nodiscard]] std::optional<PlainFormat> plain_format_of(std::string_view name);

/// What was written: the file's name and how many triangles, or for pcd points, are in it.
struct PlainScene {
  std::string file;
  std::size_t count = 0;
};

/// Writes the scan and the bodies at their recorded poses, in base [m], not reduced: scene.glb
/// (with the scan's texture; y up), scene.ply (one mesh with colours), scene.obj (an object each,
/// with colours), scene.stl; scene.pcd has the scan's points alone. `tiles` are 3D Tiles, which
/// viewers load by parts: tileset.json and tiles/. Errors: a file of the scene that can't be read,
/// a scene without geometry, a file that can't be written. Thread-safe for different folders.
[[nodiscard]] Expected<PlainScene> write_plain_scene(const SceneManifest& scene, PlainFormat format,
                                                     const std::filesystem::path& folder);

}  // namespace pcavr
