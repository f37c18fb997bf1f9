// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Replaces each number of each file of a small recording by invalid or extreme ones: the reader
// returns an Error or a result, and no precondition fails (an "internal error" of the command).
#include <array>
#include <cmath>
#include <cstdio>
#include <regex>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "scene/scene_builder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr std::array kOddValues{"nan", "inf", "-1", "0", "1e-300", "1e300", "-0.002", "1e12"};

constexpr int kRows = 60;           // of tool and wrench
constexpr double kInterval = 0.01;  // [s]

/// A tip that contacts a box and pushes it: 0.6 s, with force from contact on.
struct Push {
  Trajectory tool;
  std::vector<WrenchSample> wrench;
  Trajectory tracked;

  Push() {
    for (int i = 0; i < kRows; ++i) {
      const Stamp stamp = Stamp::from_seconds(kInterval * i);
      const double displacement = 0.05 * kInterval * i;
      tool.append(stamp, Pose::from_translation({0.42 + displacement, 0.1, 0.04}));
      const double pressed = std::max(0.0, displacement - 0.02);
      wrench.push_back({stamp, {std::min(6.0, 2000.0 * pressed), 0.0, 0.0}, {0.0, 0.0, 0.0}});
      if (i % 4 == 0) {
        tracked.append(stamp,
                       Pose::from_translation({0.5 + std::max(0.0, pressed - 0.003), 0.1, 0.04}));
      }
    }
  }
};

/// The files that a user or another program may have written, on disk.
class Sweep : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const Push push;
    const Manifest manifest{
        .objects = {{.name = "box",
                     .mesh = "objects/box.obj",
                     .mass = 1.5,
                     .is_movable = true,
                     .T_base_object = Pose::from_translation({0.5, 0.1, 0.04})}},
        .tool_radius = 0.01};
    RecordingWriter writer(folder(), manifest);
    ASSERT_TRUE(writer.write_object_mesh("objects/box.obj", a_box({0.1F, 0.2F, 0.08F})));
    ASSERT_TRUE(writer.write_tool(push.tool));
    ASSERT_TRUE(writer.write_wrench(push.wrench));
    ASSERT_TRUE(writer.finish());
    fs::remove(folder() / "written.yaml");
    fs::create_directories(folder() / "tracked/objects/box");
    write("tracked/objects/box/tracked.txt", format_trajectory(push.tracked));
    std::string stds = "t,position_std,rotation_std\n";
    for (const TimedPose& pose : push.tracked.poses()) {
      stds += format_stamp(pose.stamp) + ",0.0002,0.001\n";
    }
    write("tracked/objects/box/tracking.csv", stds);
    ObjectParameters known;
    known.mass = ParameterValue{1.5, 0.1};
    known.limiting_static_friction = ParameterValue{4.5, 0.2};
    known.sliding_friction_coefficient = ParameterValue{0.28, 0.01};
    known.viscous_friction = ParameterValue{5.0, 1.0};
    known.friction_radius = ParameterValue{0.06, 0.01};
    known.tool_friction_coefficient = ParameterValue{0.3, 0.1};
    known.loading_rate = ParameterValue{15.0, 1.0};
    known.contact_stiffness = ParameterValue{2000.0, 100.0};
    known.contact_damping = ParameterValue{50.0, 10.0};
    known.contact_exponent = ParameterValue{1.0, 0.1};
    write("parameters.yaml", format_parameters({{"box", known}}));
    fs::create_directories(folder() / "scene");
    ASSERT_TRUE(write_scene(a_box_on_a_table(), folder() / "scene", {1}));
  }

  [[nodiscard]] const fs::path& folder() const { return folder_.path(); }

  void write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file(folder() / name, text));
  }

  /// Runs all commands' functions on the files, as far as they succeed.
  void use_all() const {
    const Expected<Recording> recording = read_recording(folder(), {});
    if (!recording) return;
    const Expected<Scene> built = build_scene(*recording, BuildOptions(0.005, {1}));
    (void)built.has_value();
    const Expected<SceneManifest> scene = read_scene_manifest(folder() / "scene");
    const Expected<ParameterTable> known = read_parameters(folder() / "parameters.yaml");
    if (!scene || !known) return;
    ReplayOptions options;
    options.parallelism = {1};
    options.tracked = folder() / "tracked";
    options.parameters = *known;
    const Expected<Replay> replay = replay_recording(*recording, *scene, options);
    if (replay) {
      const TemporaryFolder run;
      EXPECT_TRUE(write_run(*replay, *recording, *scene, run.path()).has_value());
    }
    Expected<IdentificationInput> input =
        identification_input(*recording, {.tracked = folder() / "tracked", .parallelism = {1}});
    if (!input) return;
    input->known = *known;
    for (const auto goal : {IdentificationGoal::contact, IdentificationGoal::friction}) {
      const Expected<Identification> found = identify(*input, goal);
      (void)found.has_value();
    }
  }

  /// Runs them with another text in one of the files, and restores the file.
  void use_with(const std::string& name, const std::string& text, const std::string& what) const {
    const std::string before = read_file(folder() / name).value();
    write(name, text);
    try {
      use_all();
    } catch (const std::exception& failure) {
      ADD_FAILURE() << name << ", " << what << ": " << failure.what();
    }
    write(name, before);
  }

 private:
  TemporaryFolder folder_;
};

/// Positions and lengths of the numbers in a text.
std::vector<std::pair<std::size_t, std::size_t>> numbers_of(const std::string& text) {
  static const std::regex number(R"((^|[\s,\[:])(-?\d+\.?\d*(e[+-]?\d+)?)(?=$|[\s,\]}]))");
  std::vector<std::pair<std::size_t, std::size_t>> positions;
  for (std::sregex_iterator found(text.begin(), text.end(), number), end; found != end; ++found) {
    positions.emplace_back(found->position(2), found->length(2));
  }
  return positions;
}

/// All numbers of a manifest; of a table only those of its first row and of one in contact.
std::vector<std::pair<std::size_t, std::size_t>> positions_in(const std::string& text,
                                                              bool is_table) {
  auto positions = numbers_of(text);
  if (!is_table) return positions;
  const std::size_t first = text.find('\n') + 1;
  std::size_t in_contact = first;
  for (int row = 0; row < 13; ++row) in_contact = text.find('\n', in_contact) + 1;
  std::erase_if(positions, [&](const auto& position) {
    const bool is_in_first = position.first >= first && position.first < text.find('\n', first);
    const bool is_in_other =
        position.first >= in_contact && position.first < text.find('\n', in_contact);
    return !is_in_first && !is_in_other;
  });
  return positions;
}

TEST_P(Sweep, GivesAnErrorOrAResult) {
  const std::string name = GetParam();
  const std::string text = read_file(folder() / name).value();
  const bool is_table = !name.ends_with(".yaml");
  const auto positions = positions_in(text, is_table);
  ASSERT_GE(positions.size(), is_table ? 6U : 8U) << text;
  for (const auto& [at, length] : positions) {
    for (const char* value : kOddValues) {
      std::string changed = text;
      changed.replace(at, length, value);
      use_with(name, changed,
               "'" + text.substr(at, length) + "' at byte " + std::to_string(at) + " as " + value);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfEach, Sweep,
                         testing::Values("tool.csv", "wrench.csv", "recording.yaml",
                                         "parameters.yaml", "scene/scene.yaml",
                                         "tracked/objects/box/tracked.txt",
                                         "tracked/objects/box/tracking.csv"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

class StampSweep : public Sweep {};

/// A table with the stamps `stamp_of(row)`.
template <typename StampOf>
std::string restamped(const std::string& text, char separator, StampOf stamp_of) {
  std::string changed = text.substr(0, text.find('\n') + 1);
  int row = 0;
  for (std::size_t at = changed.size(); at < text.size(); ++row) {
    const std::size_t end = text.find('\n', at) + 1;
    char stamp[40];
    std::snprintf(stamp, sizeof stamp, "%.6f", stamp_of(row));
    changed += stamp + text.substr(text.find(separator, at), end - text.find(separator, at));
    at = end;
  }
  return changed;
}

TEST_P(StampSweep, GivesAnErrorOrAResult) {
  const std::string name = GetParam();
  const std::string text = read_file(folder() / name).value();
  const char separator = name.ends_with(".csv") ? ',' : ' ';
  for (const double from : {-0.002, -0.0000005, -1000.0, -4.5e9, 4.5e9, 1305031102.0, 0.3, 1e4}) {
    for (const double step : {1e-6, 0.01, 0.1, 1000.0}) {
      const std::string changed =
          restamped(text, separator, [&](int row) { return from + step * row; });
      use_with(name, changed,
               "stamps from " + std::to_string(from) + " by " + std::to_string(step));
    }
  }
  // One row, two rows, and one after a long gap.
  for (const std::size_t rows : {1U, 2U, 3U, 12U}) {
    std::size_t end = 0;
    for (std::size_t i = 0; i <= rows; ++i) end = text.find('\n', end) + 1;
    use_with(name, text.substr(0, end), std::to_string(rows) + " rows");
  }
  const std::string gap =
      restamped(text, separator, [](int row) { return kInterval * row + (row < 20 ? 0.0 : 30.0); });
  use_with(name, gap, "a gap of 30 s");
}

INSTANTIATE_TEST_SUITE_P(OfEach, StampSweep,
                         testing::Values("tool.csv", "wrench.csv",
                                         "tracked/objects/box/tracked.txt"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

}  // namespace
}  // namespace pcavr
