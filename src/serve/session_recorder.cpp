// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/session_recorder.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "pcavr/core/check.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/geometry/trajectory.hpp"
#include "pcavr/recording/recording_writer.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr double kToolInterval = 0.002;         // [s] as of recorded plants: phases need it
constexpr double kBodyInterval = 1.0 / 30.0;    // [s] as a camera
constexpr std::size_t kSlots = 4096;            // of the queue: 8 s
constexpr std::chrono::milliseconds kWait{50};  // between two looks at the queue
// The tool's z points down: a half turn about x.
const Eigen::Quaterniond kDownwards(0.0, 1.0, 0.0, 0.0);

struct Slot {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< [N] of the tip on what it touches
  bool has_bodies = false;
};

/// On a body its model's force; on the scan what the hand feels.
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
        tracked(bodies) {}

  /// Takes over what is in the queue.
  void drain() {
    const std::size_t end = written.load(std::memory_order_acquire);
    for (std::size_t i = taken.load(std::memory_order_relaxed); i != end; ++i) {
      const Slot& slot = slots[i % kSlots];
      const Stamp stamp = Stamp::from_seconds(slot.t);
      tool.append(stamp, Pose(kDownwards, slot.p_base_tip));
      wrench.push_back({stamp, slot.force_base, Eigen::Vector3d::Zero()});
      for (std::size_t body = 0; slot.has_bodies && body < tracked.size(); ++body) {
        tracked[body].append(stamp, poses[(i % kSlots) * tracked.size() + body]);
      }
      taken.store(i + 1, std::memory_order_release);
    }
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
                                   .T_base_object = tracked[body].empty()
                                                        ? object.T_base_object
                                                        : tracked[body].poses().front().pose});
    }
    return described;
  }

  [[nodiscard]] const SceneObjectEntry& entry(std::size_t body) const {
    const auto found = std::ranges::find(scene.objects, names[body], &SceneObjectEntry::name);
    PCAVR_REQUIRE(found != scene.objects.end(), names[body]);
    return *found;
  }

  [[nodiscard]] Expected<void> write_body(const fs::path& folder, std::size_t body) const {
    const SceneObjectEntry& object = entry(body);
    Expected<void> done = copy_mesh(scene.folder / object.mesh, folder / object.mesh);
    if (!done || !object.is_movable) return done;
    const fs::path file = folder / "tracked/objects" / object.name / "tracked.txt";
    done = make_parent(file);
    return done ? write_file(file, format_trajectory(tracked[body])) : done;
  }

  SceneManifest scene;
  std::vector<std::string> names = {};
  double radius;
  // Of the queue: slots[taken, written), modulo their number.
  std::vector<Slot> slots;
  std::vector<Pose> poses;  ///< of all bodies, slot by slot
  std::atomic<std::size_t> written{0};
  std::atomic<std::size_t> taken{0};
  std::atomic<std::size_t> dropped{0};
  double next_tool = 0.0;  ///< [s] of add()'s thread
  double next_body = 0.0;
  // Of the draining thread.
  Trajectory tool;
  std::vector<WrenchSample> wrench;
  std::vector<Trajectory> tracked;
  std::atomic<bool> is_ending{false};
  std::thread thread;
};

SessionRecorder::SessionRecorder(const SceneManifest& scene, const std::vector<std::string>& names,
                                 double tool_radius)
    : content_(std::make_unique<Content>(scene, names.size(), tool_radius)) {
  content_->names = names;
  content_->thread = std::thread([content = content_.get()] {
    while (!content->is_ending.load(std::memory_order_relaxed)) {
      content->drain();
      std::this_thread::sleep_for(kWait);
    }
  });
}

SessionRecorder::~SessionRecorder() {
  content_->is_ending = true;
  if (content_->thread.joinable()) content_->thread.join();
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

Expected<SessionRecorder::Summary> SessionRecorder::finish(const fs::path& folder) {
  Content& c = *content_;
  c.is_ending = true;
  if (c.thread.joinable()) c.thread.join();
  c.drain();
  RecordingWriter writer(folder, c.manifest());
  Expected<void> done = writer.write_tool(c.tool);
  if (done) done = writer.write_wrench(c.wrench);
  for (std::size_t body = 0; done && body < c.names.size(); ++body) {
    done = c.write_body(folder, body);
  }
  if (done) done = writer.finish();
  if (!done) return done.error();
  Summary summary{.dropped = c.dropped.load()};
  if (!c.wrench.empty()) {
    summary.duration = to_seconds(c.wrench.back().stamp - c.wrench.front().stamp);
  }
  return summary;
}

}  // namespace pcavr
