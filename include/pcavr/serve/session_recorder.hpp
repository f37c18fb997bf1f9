// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/scene/scene_bundle.hpp"

namespace pcavr {

/// Records what is done in a live world, as a recording without images: the tool and its force
/// every 2 ms, the poses of the movable bodies thirty times a second as tracked, times in simulated
/// seconds from the start. In memory (some 80 kB a second) until finish().
class SessionRecorder {
 public:
  /// Of the bodies `names`, objects of the scene, in the world's order; the scene's tool radius
  /// [m].
  SessionRecorder(const SceneManifest& scene, const std::vector<std::string>& names,
                  double tool_radius);
  /// Stops without writing.
  ~SessionRecorder();
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// The state after a cycle, at simulated time `t` [s], ascending. One thread; never allocates,
  /// locks or waits: what the queue has no space for is dropped and counted.
  void add(double t, const HapticWorldState& state) noexcept;

  struct Summary {
    double duration = 0.0;    ///< [s], simulated
    std::size_t dropped = 0;  ///< samples
  };
  /// Writes the recording into an existing folder. After the last add(); once.
  [[nodiscard]] Expected<Summary> finish(const std::filesystem::path& folder);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
