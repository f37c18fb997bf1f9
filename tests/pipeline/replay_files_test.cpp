// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "pipeline/build/scene_bodies.hpp"
#include "pipeline/small_replay.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// Files by their paths inside the folder.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[fs::relative(entry.path(), folder).string()] = *read_file(entry.path());
  }
  return files;
}

/// The small recording, in which a tool pushes the box for two seconds.
class ReplayFiles : public testing::Test {
 protected:
  void SetUp() override {
    write_small_replay(folder_.path());
    recording_ = *read_recording(folder_.path() / "recording");
    scene_ = *read_scene_manifest(folder_.path() / "scene");
    for (int i = 0; i <= 1000; ++i) {
      const double t = 0.002 * i;
      const double x = 0.40 + 0.04 * t;  // the box's face is at 0.45, less the tip's radius
      const Stamp stamp = Stamp::from_seconds(t);
      recording_.tool.append(stamp, Pose::from_translation({x, 0.1, 0.04}));
      const double pressed = std::max(x + 0.01 - 0.45, 0.0);
      recording_.wrench.push_back({stamp, {std::min(2000.0 * pressed, 8.0), 0.0, 0.0}, {0, 0, 0}});
    }
  }

  std::map<std::string, std::string> replayed(const std::string& name, ReplayOptions options,
                                              bool streams) {
    const fs::path run = folder_.path() / name;
    fs::create_directories(run);
    if (streams) options.run_folder = run;
    const Expected<Replay> replay = replay_recording(recording_, scene_, options);
    EXPECT_TRUE(replay) << replay.error().message;
    EXPECT_TRUE(write_run(*replay, recording_, scene_, run));
    return files_of(run);
  }

  TemporaryFolder folder_;
  Recording recording_;
  SceneManifest scene_;
};

TEST_F(ReplayFiles, AreTheSameStreamedAndWrittenAtTheEnd) {
  for (const bool from_folder : {true, false}) {
    ReplayOptions options;
    if (from_folder) options.tracked = folder_.path() / "tracked";
    if (!from_folder) recording_.frames.clear();
    const std::string name = from_folder ? "tracked" : "untracked";
    const auto kept = replayed("kept_" + name, options, false);
    const auto streamed = replayed("streamed_" + name, options, true);
    ASSERT_GT(kept.at("objects/box/predicted.txt").size(), 100'000U);
    EXPECT_GT(kept.at("force.csv").size(), 100U);
    EXPECT_EQ(kept, streamed);
  }
}

TEST_F(ReplayFiles, KeepOnlyThePosesAroundFramesWhereTheyAreStreamed) {
  ReplayOptions options;
  options.tracked = folder_.path() / "tracked";
  const Replay kept = *replay_recording(recording_, scene_, options);
  fs::create_directories(folder_.path() / "run");
  options.run_folder = folder_.path() / "run";
  const Replay streamed = *replay_recording(recording_, scene_, options);
  const std::vector<ShownPose>& all = kept.teleop->shown[0];
  const std::vector<ShownPose>& some = streamed.teleop->shown[0];
  // A frame at exactly the stamp of a pose keeps that one and both neighbours.
  EXPECT_LE(some.size(), 3U * kSmallFrames + 2U);
  EXPECT_EQ(some.front().t, all.front().t);
  EXPECT_EQ(some.back().t, all.back().t);
  for (const FrameFiles& frame : recording_.frames) {
    const double t = frame.color_stamp.seconds();
    const auto is_next = [t](const ShownPose& shown) { return shown.t >= t; };
    const auto among_all = std::find_if(all.begin(), all.end(), is_next);
    const auto among_some = std::find_if(some.begin(), some.end(), is_next);
    EXPECT_EQ(among_some->t, among_all->t);
    if (among_all != all.begin()) {
      EXPECT_EQ(std::prev(among_some)->t, std::prev(among_all)->t);
    }
  }
}

/// Counts how often a file is opened, by inotify.
class OpenCounter {
 public:
  explicit OpenCounter(const fs::path& file) : watch_(::inotify_init1(IN_NONBLOCK)) {
    EXPECT_GE(::inotify_add_watch(watch_, file.c_str(), IN_OPEN), 0);
  }
  ~OpenCounter() { ::close(watch_); }
  OpenCounter(const OpenCounter&) = delete;
  OpenCounter& operator=(const OpenCounter&) = delete;

  int count() {
    alignas(inotify_event) std::array<char, 4096> buffer{};
    for (;;) {
      const ssize_t size = ::read(watch_, buffer.data(), buffer.size());
      if (size <= 0) return count_;
      // Events of a directly watched file have no name.
      count_ += static_cast<int>(size / static_cast<ssize_t>(sizeof(inotify_event)));
    }
  }

 private:
  int watch_;
  int count_ = 0;
};

TEST_F(ReplayFiles, ReadTheCadBodyOnce) {
  const fs::path body = folder_.path() / "scene/objects/box.glb";
  ReplayOptions options;
  options.trust_poses = true;
  int once = 0;
  {
    OpenCounter opens(body);
    ASSERT_TRUE(read_object_model(scene_, scene_.objects[0]));
    once = opens.count();
  }
  ASSERT_GT(once, 0);
  OpenCounter opens(body);
  // The recording has images, so that objects are tracked; these show no tag, so that tracking may
  // fail.
  static_cast<void>(replay_recording(recording_, scene_, options));
  EXPECT_EQ(opens.count(), once * static_cast<int>(scene_.objects.size()));
}

TEST_F(ReplayFiles, ASessionInTheSceneBeginsWhereItsRecordingSays) {
  scene_.quality.frames_used = 1;  // scanned
  const SceneObjectEntry& box = scene_.objects.front();
  const Pose stated(Eigen::Quaterniond::Identity(),
                    box.T_base_object_start.translation() + Eigen::Vector3d(0.1, 0.0, 0.0));
  recording_.manifest.objects = {{.name = box.name, .mesh = box.mesh, .T_base_object = stated}};
  const auto start_x = [&] {
    return read_movable_bodies(recording_, scene_)->front().entry.T_base_object->translation().x();
  };
  // The body is found where it was if there are images.
  ASSERT_FALSE(recording_.frames.empty());
  EXPECT_EQ(start_x(), box.T_base_object_start.translation().x());
  recording_.frames.clear();
  EXPECT_EQ(start_x(), stated.translation().x());
}

}  // namespace
}  // namespace pcavr
