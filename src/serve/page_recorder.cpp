// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/page_recorder.hpp"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/serve/session_recorder.hpp"

namespace pcavr {
namespace fs = std::filesystem;

struct PageRecorder::Content {
  Content(const SceneManifest& recorded, std::vector<std::string> bodies, double radius,
          fs::path parent, Switch switch_world)
      : scene(recorded),
        names(std::move(bodies)),
        tool_radius(radius),
        folder(std::move(parent)),
        switch_to(std::move(switch_world)),
        thread([this] { run(); }) {}

  /// Follows what is wanted until the end, at which nothing is.
  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return is_ending || is_wanted != (recorder != nullptr); });
      if (is_ending) is_wanted = false;
      if (is_wanted != (recorder != nullptr)) {
        const bool begins = is_wanted;
        lock.unlock();
        const Expected<std::string> done = begins ? begin() : end();
        lock.lock();
        if (!done && begins) is_wanted = false;
        messages.push_back({!done, done ? *done : "not recorded: " + done.error().to_string()});
      } else if (is_ending) {
        return;
      }
    }
  }

  /// The name of the next recording that is not there yet.
  [[nodiscard]] fs::path next_folder() const {
    fs::path next;
    std::error_code ignored;
    for (int number = 1; next.empty() || fs::exists(next, ignored); ++number) {
      next = folder / fmt::format("recording_{:03}", number);
    }
    return next;
  }

  Expected<std::string> begin() {
    current = next_folder();
    Expected<OutputFolder> output = OutputFolder::create(current, {.kind = OutputKind::recording});
    if (!output) return output.error();
    auto next = std::make_unique<SessionRecorder>(scene, names, tool_radius);
    const Expected<void> prepared = next->prepare(output->path());
    if (!prepared) return prepared.error();
    const Expected<void> committed = output->commit();
    if (!committed) return committed.error();
    next->start(current);
    recorder = std::move(next);
    switch_to(recorder.get());
    is_recording = true;
    return "recording to " + current.string();
  }

  Expected<std::string> end() {
    is_recording = false;
    switch_to(nullptr);
    const std::unique_ptr<SessionRecorder> ended = std::move(recorder);
    const Expected<SessionRecorder::Summary> summary = ended->finish();
    if (!summary) return summary.error();
    std::string text = fmt::format("recorded {:.1f} s to {}", summary->duration, current.string());
    if (summary->dropped > 0) text += fmt::format(", {} samples lost", summary->dropped);
    return text;
  }

  SceneManifest scene;
  std::vector<std::string> names;
  double tool_radius;
  fs::path folder;
  Switch switch_to;
  std::atomic<bool> is_recording{false};
  // Of the thread.
  std::unique_ptr<SessionRecorder> recorder;
  fs::path current;
  // The following are guarded by the mutex.
  std::mutex mutex;
  std::condition_variable changed;
  bool is_wanted = false;
  bool is_ending = false;
  std::deque<RecordingMessage> messages;
  std::thread thread;  ///< last: it uses all of the above
};

PageRecorder::PageRecorder(const SceneManifest& scene, std::vector<std::string> names,
                           double tool_radius, fs::path folder, Switch switch_to)
    : content_(std::make_unique<Content>(scene, std::move(names), tool_radius, std::move(folder),
                                         std::move(switch_to))) {}

PageRecorder::~PageRecorder() { finish(); }

void PageRecorder::finish() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending = true;
  }
  content_->changed.notify_one();
  if (content_->thread.joinable()) content_->thread.join();
}

void PageRecorder::start() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_wanted = true;
  }
  content_->changed.notify_one();
}

void PageRecorder::stop() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_wanted = false;
  }
  content_->changed.notify_one();
}

bool PageRecorder::is_recording() const noexcept { return content_->is_recording; }

std::optional<RecordingMessage> PageRecorder::take_message() {
  const std::lock_guard lock(content_->mutex);
  if (content_->messages.empty()) return std::nullopt;
  RecordingMessage message = std::move(content_->messages.front());
  content_->messages.pop_front();
  return message;
}

}  // namespace pcavr
