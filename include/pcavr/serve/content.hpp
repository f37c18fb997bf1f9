// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

struct Content {
  std::string media_type;  ///< "model/gltf-binary", "application/json", ...
  std::string body;
  bool is_gzipped = false;  ///< the body is compressed: say so, or take it apart
};

/// What a page may ask for by path, such as "/scene/scene.glb". All calls are thread-safe.
class ContentSource {
 public:
  virtual ~ContentSource() = default;
  /// The pointer is empty where there is no such path; an Error where there should be, but it can't
  /// be read.
  [[nodiscard]] virtual Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const = 0;
};

}  // namespace pcavr
