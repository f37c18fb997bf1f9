// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Limits of what a page gets of a scene and a replay.
struct ContentOptions {
  ContentOptions();
  int max_points;          ///< of the cloud; of more, every n-th is kept
  int max_cells;           ///< occupied; more are an Error
  double min_point_step;   ///< [m] quantization of the cloud
  double packing_timeout;  ///< [s] of gltfpack, for one mesh
  int max_cached_frames;   ///< augmented images in memory
  /// Folder with the scan as 3D Tiles, which a page gets in place of the levels of detail; empty:
  /// it gets these.
  std::filesystem::path tiles;
};
[[nodiscard]] OptionSection section_of(ContentOptions& options);

struct Content {
  std::string media_type;  ///< "model/gltf-binary", "application/json", ...
  std::string body;
  bool is_gzipped = false;  ///< the body is gzip: send Content-Encoding, or decompress it
};

/// Resources that a page can request by path, such as "/scene/scene.glb". Thread-safe.
class ContentSource {
 public:
  virtual ~ContentSource() = default;
  /// Null if there is no such path; an Error if the resource exists but can't be read.
  [[nodiscard]] virtual Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const = 0;
};

}  // namespace pcavr
