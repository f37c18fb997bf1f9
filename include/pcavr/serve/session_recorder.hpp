// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

/// Records what is done in a live world, as a recording without images: the tool and its force
/// every 2 ms, the poses of the movable bodies thirty times a second as tracked, times in simulated
/// seconds from the start. Its files grow as it is done (some 80 kB a second), so that it remains
/// however the process ends.
class SessionRecorder {
 public:
  /// Records the bodies `names`, objects of the scene, in the world's order. `tool_radius` [m]: the
  /// scene's.
  SessionRecorder(const SceneManifest& scene, const std::vector<std::string>& names,
                  double tool_radius);
  /// Stops: what has been done so far remains.
  ~SessionRecorder();
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// The state after a cycle, at simulated time `t` [s], ascending. One thread; never allocates,
  /// locks or waits: what the queue has no space for is dropped and counted.
  void add(double t, const HapticWorldState& state) noexcept;

  /// Writes into an existing folder what does not grow: a recording of no time.
  [[nodiscard]] Expected<void> prepare(const std::filesystem::path& folder) const;
  /// Makes a prepared folder grow from now on. Call it once.
  void start(const std::filesystem::path& folder);

  struct Summary {
    double duration = 0.0;    ///< [s], simulated
    std::size_t dropped = 0;  ///< samples
  };
  /// Writes the rest. After start() and the last add(); once. With an Error, as of a full disk, the
  /// folder has what was written before.
  [[nodiscard]] Expected<Summary> finish();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
