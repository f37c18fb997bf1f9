// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/replay_content.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "pcavr/base/core/bytes.hpp"

#include "pipeline/small_replay.hpp"
#include "serve/decoded_content.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kStart = 100.0;  // [s]
constexpr double kPhaseChange = 102.0013;
constexpr double kJerk = 103.4567;  // where the error is largest

/// A pose at rest, then along x at 0.1 m/s with rotation, then at rest again.
Pose true_pose(double t) {
  const double duration = std::clamp(t - 102.0, 0.0, 3.0);
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * duration, Eigen::Vector3d::UnitZ())),
              {0.5 + 0.1 * duration, 0.0, 0.04});
}

Replay a_replay(double seconds) {
  Replay replay;
  replay.objects.push_back({"a \"box\"", {}, {}});
  for (int i = 0; i < static_cast<int>(seconds * 30.0); ++i) {
    const double t = kStart + i / 30.0;
    replay.objects[0].tracked.push_back({t, true_pose(t), 0.001, 0.01});
  }
  TeleopRun run;
  run.shown.resize(1);
  const auto cycles = static_cast<int>(seconds * 1000.0);
  for (int i = 0; i < cycles; ++i) {
    const double t = kStart + 0.001 * i;
    const double error = std::abs(t - kJerk) < 0.02 ? 0.02 : 0.001;
    run.shown[0].push_back({t, Pose::from_translation({0.0, error, 0.0}) * true_pose(t)});
    // Two contacts, with one outlier.
    if ((t > 101.0 && t < 103.0) || t > 104.0) {
      run.forces.push_back({t, 0, i == 2345 ? 42.0 : 5.0, 4.0});
    }
  }
  run.phases = {{kStart, 0, MotionPhase::free, MotionPhase::free},
                {kPhaseChange, 0, MotionPhase::sliding, MotionPhase::static_contact}};
  run.corrections = {{101.5, 0, CorrectionCase::phases_differ, "position", 31, true}};
  replay.teleop = run;
  replay.parameters_file = "parameters.yaml";
  return replay;
}

Recording a_recording(double seconds) {
  Recording recording;
  for (int i = 0; i < static_cast<int>(seconds * 1000.0); ++i) {
    const Stamp stamp = Stamp::from_seconds(kStart + 0.001 * i);
    recording.tool.append(stamp, Pose::from_translation({0.3, 0.0, 0.05}));
    recording.wrench.push_back({stamp, {1.0, 2.0, 3.0}, {0, 0, 0}});
  }
  return recording;
}

using Rows = std::vector<std::vector<float>>;

/// A table of replay.bin, by its entry in replay.json.
Rows rows_of(const std::string& bytes, const nlohmann::json& table, std::size_t columns) {
  ByteReader reader(bytes_of(bytes).subspan(table["at"].get<std::size_t>()));
  Rows rows(table["rows"].get<std::size_t>(), std::vector<float>(columns));
  for (std::vector<float>& row : rows) {
    for (float& number : row) number = reader.f32();
  }
  EXPECT_TRUE(reader.is_valid());
  return rows;
}

class ReplayContentTest : public testing::Test {
 protected:
  static ReplayContent content_of(double seconds) {
    return *ReplayContent::create(a_recording(seconds), SceneManifest(), a_replay(seconds));
  }
  const ReplayContent content_ = content_of(6.0);
  const nlohmann::json json_ = json_of(content_, "/api/replay.json");
  const std::string bytes_ = body_of(content_, "/api/replay.bin");
  const nlohmann::json& box_ = json_["objects"][0];
};

TEST_F(ReplayContentTest, HasAllFieldsThatThePageReads) {
  EXPECT_EQ(json_["start"], kStart);
  EXPECT_NEAR(json_["duration"].get<double>(), 6.0, 0.01);
  EXPECT_EQ(json_["delays"], nlohmann::json({{"forward", 0.2}, {"backward", 0.2}}));
  EXPECT_EQ(json_["parameters"], "parameters.yaml");
  EXPECT_EQ(box_["name"], "a \"box\"");
  ASSERT_EQ(box_["phases"].size(), 2U);
  EXPECT_EQ(box_["phases"][1]["measured"], "sliding");
  EXPECT_EQ(box_["phases"][1]["predicted"], "static");
  ASSERT_EQ(json_["corrections"].size(), 1U);
  EXPECT_EQ(json_["corrections"][0]["case"], "2");
  EXPECT_EQ(json_["corrections"][0]["what"], "position+lost");
  EXPECT_EQ(json_["corrections"][0]["bytes"], 31);
  EXPECT_EQ(json_["frames"]["t"], nlohmann::json::array());
}

TEST_F(ReplayContentTest, DecimatesThePredictionWithoutChangingIt) {
  const Rows rows = rows_of(bytes_, box_["predicted"], 8);
  ASSERT_GT(rows.size(), 100U);
  EXPECT_LT(rows.size(), 700U);  // 3 s of motion at 200 Hz, and few at rest
  EXPECT_EQ(rows.front()[0], 0.0F);
  EXPECT_NEAR(rows.back()[0], 5.999F, 1e-4F);
  // Interpolates between rows: the motion is linear, except at the jerk's two ends.
  std::size_t next = 1;
  const Replay whole = a_replay(6.0);
  for (const ShownPose& shown : whole.teleop->shown[0]) {
    const double t = shown.t - kStart;
    while (next + 1 < rows.size() && rows[next][0] < t) ++next;
    const std::vector<float>& a = rows[next - 1];
    const std::vector<float>& b = rows[next];
    const double fraction = std::clamp((t - a[0]) / (b[0] - a[0]), 0.0, 1.0);
    const double x = a[1] + fraction * (b[1] - a[1]);
    EXPECT_NEAR(x, shown.T_base_object.translation().x(), 2e-5) << t;  // same to 10 um
  }
}

TEST_F(ReplayContentTest, KeepsTheRowsAroundAPhaseChangeAndTheLargestError) {
  std::set<int> milliseconds;
  for (const auto& row : rows_of(bytes_, box_["predicted"], 8)) {
    milliseconds.insert(static_cast<int>(std::lround(1000.0F * row[0])));
  }
  EXPECT_TRUE(milliseconds.contains(2001));
  EXPECT_TRUE(milliseconds.contains(2002));
  const Rows errors = rows_of(bytes_, box_["error"], 3);
  const auto largest =
      std::max_element(errors.begin(), errors.end(), [](auto& a, auto& b) { return a[1] < b[1]; });
  EXPECT_NEAR((*largest)[1], 0.02F, 1e-4F);
  const double t = 1000.0 * (*largest)[0];
  EXPECT_TRUE(milliseconds.contains(static_cast<int>(std::floor(t))) ||
              milliseconds.contains(static_cast<int>(std::ceil(t))));
}

TEST_F(ReplayContentTest, ComparesPredictedWithTrackedAtEachFrame) {
  const Rows tracked = rows_of(bytes_, box_["tracked"], 8);
  const Rows errors = rows_of(bytes_, box_["error"], 3);
  EXPECT_EQ(tracked.size(), 180U);
  ASSERT_GE(errors.size(), 179U);  // the last frame may lie beyond the last prediction
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_NEAR(errors[i][0], tracked[i][0], 1e-5F);  // single precision
    EXPECT_GE(errors[i][1], 0.0009F);
    EXPECT_LT(errors[i][2], 1e-4F);
  }
}

TEST_F(ReplayContentTest, KeepsForcePeaksAndMarksGapsInContact) {
  const Rows force = rows_of(bytes_, box_["force"], 3);
  EXPECT_LT(force.size(), 1200U);  // of 4 000
  float highest = 0.0F;
  int ends = 0;
  for (const auto& row : force) {
    if (std::isnan(row[1])) ++ends;
    if (row[1] > highest) highest = row[1];
  }
  EXPECT_EQ(highest, 42.0F);
  EXPECT_EQ(ends, 1);
  for (std::size_t i = 1; i < force.size(); ++i) EXPECT_GE(force[i][0], force[i - 1][0]);
}

TEST_F(ReplayContentTest, HasTheToolWithItsForce) {
  const Rows tool = rows_of(bytes_, json_["tool"], 7);
  EXPECT_EQ(tool.size(), 1200U);  // 200 Hz
  EXPECT_EQ(tool[7], (std::vector<float>{tool[7][0], 0.3F, 0.0F, 0.05F, 1.0F, 2.0F, 3.0F}));
}

TEST_F(ReplayContentTest, IsSmall) {
  const ReplayContent minute = content_of(60.0);
  std::size_t bytes = 0;
  for (const char* path : {"/api/replay.json", "/api/replay.bin"}) {
    bytes += (*minute.find(path))->body.size();
  }
  EXPECT_LT(bytes, 1'000'000U);
}

TEST_F(ReplayContentTest, HasNoRowsWithoutAPrediction) {
  Replay replay = a_replay(1.0);
  replay.teleop.reset();
  const auto content = ReplayContent::create(Recording(), SceneManifest(), replay);
  ASSERT_TRUE(content);
  const nlohmann::json json = json_of(*content, "/api/replay.json");
  EXPECT_EQ(json["objects"][0]["predicted"]["rows"], 0);
  EXPECT_EQ(json["objects"][0]["error"]["rows"], 0);
  EXPECT_EQ(json["objects"][0]["tracked"]["rows"], 30);
  EXPECT_EQ(json["tool"]["rows"], 0);
}

TEST(FrameContentTest, RendersAFrameOnDemandAndHasNoOthers) {
  const TemporaryFolder folder;
  write_small_replay(folder.path());
  const Recording recording = *read_recording(folder.path() / "recording");
  const SceneManifest scene = *read_scene_manifest(folder.path() / "scene");
  ReplayOptions options;
  options.tracked = folder.path() / "tracked";
  const Replay replay = *replay_recording(recording, scene, options);
  const auto content = ReplayContent::create(recording, scene, replay);
  ASSERT_TRUE(content) << content.error().to_string();
  EXPECT_EQ(json_of(*content, "/api/replay.json")["frames"]["t"].size(), 5U);
  const std::string picture = body_of(*content, "/api/frames/4.jpg");
  EXPECT_TRUE(picture.starts_with("\xFF\xD8\xFF"));
  EXPECT_EQ(body_of(*content, "/api/frames/4.jpg"), picture);
  for (const char* path : {"/api/frames/5.jpg", "/api/frames/-1.jpg", "/api/frames/.jpg",
                           "/api/frames/04.jpg", "/api/frames/4.png", "/api/frames/4.jpg.jpg",
                           "/api/frames/99999999999999999999999.jpg", "/api/frames/4 .jpg"}) {
    EXPECT_FALSE(has_path(*content, path)) << path;
  }
}

}  // namespace
}  // namespace pcavr
