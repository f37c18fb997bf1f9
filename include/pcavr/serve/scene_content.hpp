// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/tiles_content.hpp"

namespace pcavr {

/// The scene's name on pages: that of its folder.
[[nodiscard]] std::string scene_name(const SceneManifest& scene);

/// A scene as a page loads it (docs/live-protocol.md): /api/scene.json, the static mesh's levels of
/// detail, the CAD bodies, the cloud and the occupied cells, all compressed once and kept in
/// memory, or the scan as 3D Tiles, read as they are requested. Only these paths exist: no other
/// file of the disk is served. Const and thread-safe.
class SceneContent : public ContentSource {
 public:
  /// Reads and compresses the whole scene; an Error if a file is missing or invalid. If gltfpack is
  /// missing or fails, meshes are served uncompressed and the observer is warned. `parameters` are
  /// shown with the objects. Deterministic.
  [[nodiscard]] static Expected<SceneContent> create(
      const SceneManifest& scene, const std::optional<ParameterTable>& parameters = {},
      const Observer& observer = {}, Parallelism parallelism = Parallelism::max(),
      const ContentOptions& options = {});

  /// `path` as in the request line, percent-encoded or not, without its query.
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  std::map<std::string, std::shared_ptr<const Content>, std::less<>> contents_;
  std::optional<TilesContent> tiles_;
};

}  // namespace pcavr
