// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/perception/scene/scene_bundle.hpp"

namespace pcavr {

class SessionRecorder;

/// What a page is shown of its recordings.
struct RecordingMessage {
  bool is_error = false;
  std::string text;
};

/// Records a live world while a page asks for it, each time into the next free folder
/// `recording_001`, `recording_002`, ... (see SessionRecorder). Files are created, written and
/// closed on a thread of its own; all functions but finish() return at once, for
/// any thread.
class PageRecorder {
 public:
  /// Makes the world add its cycles to a recorder from now on; null: to none, and returns when the
  /// one before is not used any more.
  using Switch = std::function<void(SessionRecorder*)>;

  /// `names`: the world's bodies, as of SessionRecorder. `folder` holds the recordings; it is
  /// created with the first one. What `switch_to` refers to must outlive it.
  PageRecorder(const SceneManifest& scene, std::vector<std::string> names, double tool_radius,
               std::filesystem::path folder, Switch switch_to);
  ~PageRecorder();  ///< as finish()
  PageRecorder(const PageRecorder&) = delete;
  PageRecorder& operator=(const PageRecorder&) = delete;

  void start();
  void stop();
  /// Ends a recording in progress, and returns when it is written; then none can begin.
  void finish();
  /// From the first recorded cycle until the request to stop.
  [[nodiscard]] bool is_recording() const noexcept;
  /// The oldest that was not taken yet: where a recording goes, how long one was, or why there is
  /// none.
  [[nodiscard]] std::optional<RecordingMessage> take_message();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
