// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/session_recorder.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"

#include "serve/growing_file.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr double kToolInterval = 0.002;         // [s] as of recorded plants: phases need it
constexpr double kBodyInterval = 1.0 / 30.0;    // [s] as a camera
constexpr std::size_t kSlots = 4096;            // of the queue: 8 s
constexpr std::chrono::milliseconds kWait{50};  // between two looks at the queue
// The tool's z points down: a half turn about x.
const Eigen::Quaterniond kDownwards(0.0, 1.0, 0.0, 0.0);

constexpr char kToolFile[] = "tool.csv";
constexpr char kWrenchFile[] = "wrench.csv";
constexpr char kRecordingManifest[] = "recording.yaml";
constexpr std::size_t kTool = 0, kWrench = 1;  // of the growing files

fs::path tracked_file(const std::string& object) {
  return fs::path("tracked/objects") / object / "tracked.txt";
}

struct Slot {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< [N] of the tip on what it touches
  bool has_bodies = false;
};

/// Force of the touched body's model; on the scan the force that the hand feels.
Eigen::Vector3d force_of_tip(const HapticWorldState& state) {
  if (!state.touched_body) return -state.force_base;
  return state.bodies[*state.touched_body].tool_force_base;
}

Expected<void> make_parent(const fs::path& file) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  if (!code) return {};
  return Error{.message = "can't be created: " + code.message(),
               .file = file.parent_path().string()};
}

Expected<void> copy_mesh(const fs::path& from, const fs::path& to) {
  const Expected<void> made = make_parent(to);
  if (!made) return made;
  const Expected<std::string> mesh = read_file(from);
  if (!mesh) return mesh.error();
  return write_file(to, *mesh);
}

}  // namespace

struct SessionRecorder::Content {
  Content(const SceneManifest& recorded, std::size_t bodies, double tool_radius)
      : scene(recorded),
        radius(tool_radius),
        slots(kSlots),
        poses(kSlots * bodies),
        first(bodies),
        tracked(bodies) {}

  /// Takes over what is in the queue.
  void drain() {
    const std::size_t end = written.load(std::memory_order_acquire);
    for (std::size_t i = taken.load(std::memory_order_relaxed); i != end; ++i) {
      append(slots[i % kSlots],
             std::span(poses).subspan((i % kSlots) * first.size(), first.size()));
      taken.store(i + 1, std::memory_order_release);
    }
    for (GrowingFile& file : files) file.write();
  }

  void append(const Slot& slot, std::span<const Pose> T_base_bodies) {
    const Stamp stamp = Stamp::from_seconds(slot.t);
    begin = begin.value_or(stamp);
    newest = stamp;
    append_tool_row(files[kTool].rows(), stamp, Pose(kDownwards, slot.p_base_tip));
    append_wrench_row(files[kWrench].rows(), {stamp, slot.force_base, Eigen::Vector3d::Zero()});
    if (!slot.has_bodies) return;
    if (!first.empty() && !first.front()) {
      first.assign(T_base_bodies.begin(), T_base_bodies.end());
      write_fault(write_file(folder / kRecordingManifest, format_manifest(manifest())));
    }
    for (std::size_t body = 0; body < first.size(); ++body) {
      if (!tracked[body]) continue;
      append_trajectory_row(files[*tracked[body]].rows(), stamp, T_base_bodies[body]);
    }
  }

  void write_fault(const Expected<void>& done) {
    if (!done && !fault) fault = done.error();
  }

  [[nodiscard]] Manifest manifest() const {
    Manifest described;
    described.tool_radius = radius;
    for (std::size_t body = 0; body < names.size(); ++body) {
      const SceneObjectEntry& object = entry(body);
      described.objects.push_back({.name = object.name,
                                   .mesh = object.mesh,
                                   .mass = object.mass,
                                   .is_movable = object.is_movable,
                                   .T_base_object = first[body].value_or(object.T_base_object)});
    }
    return described;
  }

  [[nodiscard]] const SceneObjectEntry& entry(std::size_t body) const {
    const auto found = std::ranges::find(scene.objects, names[body], &SceneObjectEntry::name);
    PCAVR_REQUIRE(found != scene.objects.end(), names[body]);
    return *found;
  }

  /// The body's mesh, and its poses without rows.
  [[nodiscard]] Expected<void> prepare_body(const fs::path& to, std::size_t body) const {
    const SceneObjectEntry& object = entry(body);
    Expected<void> done = copy_mesh(scene.folder / object.mesh, to / object.mesh);
    if (!done || !object.is_movable) return done;
    const fs::path file = to / tracked_file(object.name);
    done = make_parent(file);
    return done ? write_file(file, trajectory_header()) : done;
  }

  SceneManifest scene;
  std::vector<std::string> names = {};
  double radius;
  // The queue: slots[taken, written), modulo their number.
  std::vector<Slot> slots;
  std::vector<Pose> poses;  ///< of all bodies, slot by slot
  std::atomic<std::size_t> written{0};
  std::atomic<std::size_t> taken{0};
  std::atomic<std::size_t> dropped{0};
  double next_tool = 0.0;  ///< [s] of add()'s thread
  double next_body = 0.0;
  // The following belong to the draining thread.
  fs::path folder;
  std::vector<GrowingFile> files;                   ///< kTool, kWrench, and those of tracked
  std::vector<std::optional<Pose>> first;           ///< of each body
  std::vector<std::optional<std::size_t>> tracked;  ///< index of each body's file, if it moves
  std::optional<Stamp> begin, newest;
  std::optional<Error> fault;
  std::atomic<bool> is_ending{false};
  std::thread thread;
};

SessionRecorder::SessionRecorder(const SceneManifest& scene, const std::vector<std::string>& names,
                                 double tool_radius)
    : content_(std::make_unique<Content>(scene, names.size(), tool_radius)) {
  content_->names = names;
}

Expected<void> SessionRecorder::prepare(const fs::path& folder) const {
  const Content& c = *content_;
  Expected<void> done = write_file(folder / kToolFile, tool_header());
  if (done) done = write_file(folder / kWrenchFile, wrench_header());
  for (std::size_t body = 0; done && body < c.names.size(); ++body) {
    done = c.prepare_body(folder, body);
  }
  return done ? write_file(folder / kRecordingManifest, format_manifest(c.manifest())) : done;
}

void SessionRecorder::start(const fs::path& folder) {
  Content& c = *content_;
  c.folder = folder;
  c.files.emplace_back(folder / kToolFile);
  c.files.emplace_back(folder / kWrenchFile);
  for (std::size_t body = 0; body < c.names.size(); ++body) {
    if (!c.entry(body).is_movable) continue;
    c.tracked[body] = c.files.size();
    c.files.emplace_back(folder / tracked_file(c.names[body]));
  }
  c.thread = std::thread([content = content_.get()] {
    while (!content->is_ending.load(std::memory_order_relaxed)) {
      content->drain();
      std::this_thread::sleep_for(kWait);
    }
  });
}

SessionRecorder::~SessionRecorder() {
  content_->is_ending = true;
  if (content_->thread.joinable()) content_->thread.join();
  if (!content_->files.empty()) content_->drain();
}

void SessionRecorder::add(double t, const HapticWorldState& state) noexcept {
  Content& c = *content_;
  if (t < c.next_tool) return;
  const std::size_t next = c.written.load(std::memory_order_relaxed);
  if (next - c.taken.load(std::memory_order_acquire) == kSlots) {
    c.dropped.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  c.next_tool = t + 0.75 * kToolInterval;  // the cycle that is next to the interval's end
  Slot& slot = c.slots[next % kSlots];
  slot = {t, state.p_base_hip, force_of_tip(state), t >= c.next_body};
  if (slot.has_bodies) {
    c.next_body = t + kBodyInterval;
    for (std::size_t body = 0; body < state.bodies.size(); ++body) {
      c.poses[(next % kSlots) * state.bodies.size() + body] = state.bodies[body].T_base_object;
    }
  }
  c.written.store(next + 1, std::memory_order_release);
}

Expected<SessionRecorder::Summary> SessionRecorder::finish() {
  Content& c = *content_;
  PCAVR_REQUIRE(!c.files.empty());
  c.is_ending = true;
  if (c.thread.joinable()) c.thread.join();
  c.drain();
  for (GrowingFile& file : c.files) c.write_fault(file.finish());
  if (!c.fault) c.write_fault(write_line_counts(c.folder));
  if (c.fault) return *c.fault;
  Summary summary{.dropped = c.dropped.load()};
  if (c.begin) summary.duration = to_seconds(*c.newest - *c.begin);
  return summary;
}

}  // namespace pcavr
