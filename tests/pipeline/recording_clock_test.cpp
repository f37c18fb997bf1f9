// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "pipeline/recorded_case.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr Stamp kSince1970{1'700'000'000'123'000'000};
constexpr double kSlowPushes = 16.0;  // [s] of a probe
constexpr double kOnePush = 5.0;      // [s] of the operator's pushes

/// A recording, the scene from its manifest, and the warnings.
struct Chain {
  Chain(ToolTask task, double duration, Stamp start)
      : recording(recorded_case(folder.path() / "recording", task, 2, duration, start)) {
    observer.warn = [this](std::string_view line) { warnings.emplace_back(line); };
  }

  SceneManifest scene() {
    const Expected<Scene> built = build_scene(recording, {}, observer);
    EXPECT_TRUE(built.has_value());
    std::filesystem::create_directories(folder.path() / "scene");
    EXPECT_TRUE(write_scene(*built, folder.path() / "scene", {1}).has_value());
    return read_scene_manifest(folder.path() / "scene").value();
  }

  [[nodiscard]] std::filesystem::path tracked() const { return recording.folder / "tracked"; }
  [[nodiscard]] bool has_warned(const std::string& text) const {
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& line) {
      return line.find(text) != std::string::npos;
    });
  }

  TemporaryFolder folder;
  Recording recording;
  Observer observer;
  std::vector<std::string> warnings;
};

void expect_same(double value, double reference, const std::string& what) {
  EXPECT_NEAR(value, reference, 1e-9 * std::max(1.0, std::abs(reference))) << what;
}

TEST(RecordingClock, StampsSince1970GiveTheSameParametersAndNotes) {
  std::vector<Identification> found;
  std::vector<std::string> json;
  for (const Stamp start : {Stamp{}, kSince1970}) {
    Chain chain(ToolTask::probe, kSlowPushes, start);
    // A jump, so that a note contains a time.
    std::vector<TimedPose> poses = chain.recording.tool.poses();
    for (std::size_t i = poses.size() / 2; i < poses.size(); ++i) {
      poses[i].pose = Pose::from_translation({0.004, 0.0, 0.0}) * poses[i].pose;
    }
    chain.recording.tool = Trajectory(poses);
    const auto input = identification_input(chain.recording, {.tracked = chain.tracked()});
    ASSERT_TRUE(input.has_value()) << input.error().to_string();
    auto identified = identify(*input, IdentificationGoal::friction);
    ASSERT_TRUE(identified.has_value()) << identified.error().to_string();
    const auto written = write_identification_report(*identified, "push", chain.folder.path());
    ASSERT_TRUE(written.has_value());
    json.push_back(read_file(chain.folder.path() / "report.json").value());
    found.push_back(std::move(*identified));
  }
  EXPECT_FALSE(found[0].notes.empty());
  EXPECT_EQ(found[1].notes, found[0].notes);
  EXPECT_EQ(json[1], json[0]);
  for (std::size_t i = 0; i < found[0].objects.size(); ++i) {
    EXPECT_EQ(found[1].objects[i].notes, found[0].objects[i].notes);
    const auto at_zero = list_parameters(found[0].objects[i].parameters);
    const auto since_1970 = list_parameters(found[1].objects[i].parameters);
    ASSERT_EQ(since_1970.size(), at_zero.size());
    for (std::size_t k = 0; k < at_zero.size(); ++k) {
      expect_same(since_1970[k].second.value, at_zero[k].second.value, at_zero[k].first);
    }
  }
}

TEST(RecordingClock, StampsSince1970ReplayTheSamePrediction) {
  std::vector<Replay> runs;
  for (const Stamp start : {Stamp{}, kSince1970}) {
    Chain chain(ToolTask::push, kOnePush, start);
    const SceneManifest scene = chain.scene();
    ReplayOptions options;
    options.tracked = chain.tracked();
    auto run = replay_recording(chain.recording, scene, options, chain.observer);
    ASSERT_TRUE(run.has_value()) << run.error().to_string();
    runs.push_back(std::move(*run));
  }
  const TeleopRun& at_zero = *runs[0].teleop;
  const TeleopRun& since_1970 = *runs[1].teleop;
  EXPECT_EQ(since_1970.notes, at_zero.notes);
  EXPECT_EQ(since_1970.correction_bytes, at_zero.correction_bytes);
  ASSERT_EQ(since_1970.shown[0].size(), at_zero.shown[0].size());
  double moved = 0.0;
  for (std::size_t i = 0; i < at_zero.shown[0].size(); ++i) {
    const ShownPose& a = at_zero.shown[0][i];
    const ShownPose& b = since_1970.shown[0][i];
    EXPECT_NEAR(b.t - kSince1970.seconds(), a.t, 1e-6);  // what a double since 1970 can hold
    EXPECT_LT(translation_distance(a.T_base_object, b.T_base_object), 1e-9);
    moved = std::max(moved,
                     translation_distance(a.T_base_object, at_zero.shown[0].front().T_base_object));
  }
  EXPECT_GT(moved, 0.01);
}

TEST(RecordingClock, InMillisecondsIsNoClockOfContacts) {
  Chain chain(ToolTask::push, kOnePush, Stamp{});
  for (WrenchSample& sample : chain.recording.wrench) {
    sample.stamp = Stamp::from_seconds(1e3 * sample.stamp.seconds());
  }
  std::vector<TimedPose> poses = chain.recording.tool.poses();
  for (TimedPose& timed : poses) timed.stamp = Stamp::from_seconds(1e3 * timed.stamp.seconds());
  chain.recording.tool = Trajectory(std::move(poses));
  const auto input = identification_input(chain.recording, {.tracked = chain.tracked()});
  ASSERT_FALSE(input.has_value());
  EXPECT_NE(input.error().to_string().find("tool.csv: one row in 2 s: too few to show a contact"),
            std::string::npos)
      << input.error().to_string();
  EXPECT_NE(input.error().hint.find("milliseconds"), std::string::npos);
}

TEST(RecordingClock, ThatDiffersIsReportedByEachCommand) {
  Chain chain(ToolTask::push, kOnePush, Stamp{});
  const SceneManifest scene = chain.scene();
  EXPECT_TRUE(chain.warnings.size() == 1) << "only the warning of no images";
  for (WrenchSample& sample : chain.recording.wrench) {
    sample.stamp = shifted(sample.stamp, {1'000'000'000'000});
  }
  const std::string text = "wrench.csv covers 1000.0 to 100";
  const std::string end = "they do not overlap; put both on one clock";
  const auto input = identification_input(chain.recording, {.tracked = chain.tracked()});
  ASSERT_FALSE(input.has_value());
  EXPECT_NE(input.error().to_string().find(text), std::string::npos);
  EXPECT_TRUE(input.error().to_string().ends_with(end)) << input.error().to_string();
  ReplayOptions options;
  options.tracked = chain.tracked();
  const auto run = replay_recording(chain.recording, scene, options, chain.observer);
  ASSERT_FALSE(run.has_value());
  EXPECT_NE(run.error().to_string().find(text), std::string::npos) << run.error().to_string();
  ASSERT_TRUE(build_scene(chain.recording, {}, chain.observer).has_value());
  EXPECT_TRUE(chain.has_warned(text));
}

TEST(RecordingClock, SomeSecondsApartIsReportedWithTheShift) {
  Chain chain(ToolTask::probe, kSlowPushes, Stamp{});
  const SceneManifest scene = chain.scene();
  for (WrenchSample& sample : chain.recording.wrench) {
    sample.stamp = shifted(sample.stamp, {5'000'000'000});
  }
  ReplayOptions options;
  options.tracked = chain.tracked();
  const auto run = replay_recording(chain.recording, scene, options, chain.observer);
  ASSERT_FALSE(run.has_value());
  EXPECT_NE(run.error().to_string().find("5.0 s later than the tool's motion"), std::string::npos)
      << run.error().to_string();
}

TEST(ReplayWithoutToolMotion, ReportsThatNothingIsPredicted) {
  Chain chain(ToolTask::push, kOnePush, Stamp{});
  const SceneManifest scene = chain.scene();
  chain.recording.tool = Trajectory();
  ReplayOptions options;
  options.tracked = chain.tracked();
  const auto run = replay_recording(chain.recording, scene, options, chain.observer);
  ASSERT_TRUE(run.has_value()) << run.error().to_string();
  EXPECT_FALSE(run->teleop.has_value());
  EXPECT_TRUE(chain.has_warned("nothing is predicted"));
  const std::filesystem::path folder = chain.folder.path() / "run";
  std::filesystem::create_directories(folder);
  ASSERT_TRUE(write_run(*run, chain.recording, scene, folder).has_value());
  EXPECT_NE(read_file(folder / "run.yaml")->find("nothing is predicted"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
