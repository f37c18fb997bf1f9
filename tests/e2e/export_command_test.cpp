// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A simulated scene as a world for engines, with the real command.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/object/parameters_file.hpp"

#include "support/json_command.hpp"
#include "support/parquet_reader.hpp"
#include "support/temporary_folder.hpp"
#include "support/two_joint_arm.hpp"

namespace pcavr {
namespace {

/// A CSV file whose first column is the time.
struct TimedTable {
  std::vector<std::vector<double>> rows;

  explicit TimedTable(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream words(line);
      rows.emplace_back(std::istream_iterator<double>(words), std::istream_iterator<double>());
    }
  }
  /// Between the rows next to a time.
  [[nodiscard]] std::vector<double> at(double t) const {
    std::size_t i = 1;
    while (i + 1 < rows.size() && rows[i][0] < t) ++i;
    const double share = (t - rows[i - 1][0]) / (rows[i][0] - rows[i - 1][0]);
    std::vector<double> row = rows[i];
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = std::lerp(rows[i - 1][k], row[k], share);
    return row;
  }
  /// Of the rows in [begin, end).
  [[nodiscard]] std::vector<double> mean(double begin, double end) const {
    std::vector<double> sum(rows.front().size());
    double count = 0.0;
    for (const std::vector<double>& row : rows) {
      if (row[0] < begin || row[0] >= end) continue;
      for (std::size_t k = 0; k < row.size(); ++k) sum[k] += row[k];
      ++count;
    }
    for (double& value : sum) value /= count;
    return sum;
  }
};

/// Whether an object slides, by a recording's truth.
struct SlidingTruth {
  std::vector<std::array<std::string, 3>> rows;  ///< time, object, phase

  explicit SlidingTruth(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream words(line);
      auto& [t, object, phase] = rows.emplace_back();
      words >> t >> object >> phase;
    }
  }
  [[nodiscard]] bool at(double t) const {
    std::map<std::string, std::string> phases;
    for (const auto& [begin, object, phase] : rows) {
      if (std::stod(begin) <= t) phases[object] = phase;
    }
    return std::ranges::any_of(phases, [](const auto& each) { return each.second == "sliding"; });
  }
};

class ExportCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "push", "--no-images", "--seed", "12", "-o", path_of("recording")});
    run_json({"build", path_of("recording"), "-o", path_of("scene")});
    run_json({"identify", "friction", path_of("recording"), "--scene", path_of("scene"), "-o",
              path_of("parameters.yaml")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  static std::vector<std::string> command(const std::string& format, const std::string& output,
                                          const std::vector<std::string>& more) {
    std::vector<std::string> words{"export", path_of("scene"), "--to", format,
                                   "-o",     path_of(output)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::vector<std::string> identified() {
    return {"--parameters", path_of("parameters.yaml")};
  }
  static nlohmann::json manifest(const std::string& output) {
    return nlohmann::json::parse(read_file(path_of(output + "/export.json")).value());
  }
  /// Expects one line with `why`, exit code 1, and no output.
  static void expect_refused(const std::vector<std::string>& words, const std::string& why) {
    const CommandOutcome outcome = run_pcavr(words);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(why), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(std::filesystem::exists(path_of("refused")));
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ExportCommand::folder_ = nullptr;

TEST_F(ExportCommand, WritesEachFormatWithTheSameBytesEachTime) {
  for (const auto& [format, file] :
       std::vector<std::pair<std::string, std::string>>{{"mjcf", "scene.xml"},
                                                        {"urdf", "scene.urdf"},
                                                        {"sdf", "scene.sdf"},
                                                        {"usd", "scene.usda"},
                                                        {"moveit", "planning_scene.json"}}) {
    const nlohmann::json report = run_json(command(format, format, identified()));
    EXPECT_EQ(report["format"], format);
    // A planning scene has those of cells that were cleared alone; here is no map.
    EXPECT_EQ(report["residuals"].empty(), format == "moveit");
    run_json(command(format, format + "_again", identified()));
    const auto files = contents(path_of(format));
    EXPECT_TRUE(files.contains(file));
    EXPECT_EQ(files, contents(path_of(format + "_again"))) << format;
  }
}

TEST_F(ExportCommand, StatesMeanStdAndOriginOfEachNumber) {
  run_json(command("mjcf", "stated", identified()));
  const nlohmann::json stated = manifest("stated");
  std::set<std::string> measured, given;
  for (const nlohmann::json& number : stated["numbers"]) {
    const auto origin = number["origin"].get<std::string>();
    EXPECT_TRUE(origin == "measured" || origin == "given" || origin == "assumed") << number;
    EXPECT_TRUE(number["value"].is_number());
    if (origin == "measured" && number.contains("std")) measured.insert(number["key"]);
    if (origin == "given") given.insert(number["key"]);
  }
  EXPECT_TRUE(given.contains("mass")) << stated["numbers"].dump(1);  // weighed
  EXPECT_TRUE(measured.contains("sliding_friction_coefficient")) << stated["numbers"].dump(1);
  for (const nlohmann::json& residual : stated["residuals"]) {
    EXPECT_FALSE(residual["what"].get<std::string>().empty());
    if (residual["what"] == "turning torque") {
      EXPECT_LT(std::abs(residual["relative"].get<double>()), 0.01) << residual;
    }
  }
}

TEST_F(ExportCommand, WritesGeometryAloneWithoutParameters) {
  for (const char* format : {"gltf", "ply", "obj", "stl"}) {
    const nlohmann::json report = run_json(command(format, std::string("plain_") + format, {}));
    EXPECT_GT(report["triangles"].get<int>(), 0);
    EXPECT_TRUE(contents(path_of(std::string("plain_") + format)).contains(report["file"]));
  }
  run_json(command("moveit", "planning", {}));
  expect_refused(command("pcd", "refused", {}), "no images");
  EXPECT_EQ(run_pcavr(command("obj", "refused", identified())).exit_code, 2);
}

TEST_F(ExportCommand, WritesAnIdentifiedArmWithAndWithoutAScene) {
  ASSERT_TRUE(write_file(path_of("arm.urdf"), two_joint_urdf()));
  ASSERT_TRUE(write_file(path_of("arm.json"), two_joint_report()));
  const std::vector<std::string> arm{"--robot", path_of("arm.urdf"), "--identified",
                                     path_of("arm.json")};
  std::vector<std::string> alone{"export", "--to", "urdf", "-o", path_of("arm_alone")};
  alone.insert(alone.end(), arm.begin(), arm.end());
  run_json(alone);
  std::vector<std::string> words = identified();
  words.insert(words.end(), arm.begin(), arm.end());
  run_json(command("mjcf", "with_arm", words));
  const auto files = contents(path_of("arm_alone"));
  for (const char* file : {"robot.urdf", "robot.xml"}) {
    ASSERT_TRUE(files.contains(file));
    EXPECT_EQ(files.at(file), contents(path_of("with_arm")).at(file));
  }
  EXPECT_NE(files.at("robot.urdf").find("friction=\"0.456789\""), std::string::npos);
  bool is_stated = false;
  const nlohmann::json stated = manifest("with_arm");
  for (const nlohmann::json& number : stated["numbers"]) {
    if (number["object"] == "j2" && number["key"] == "damping") {
      EXPECT_EQ(number["unit"], "N s/m");  // it slides
    }
  }
  for (const nlohmann::json& number : stated["numbers"]) {
    is_stated |= number["object"] == "j1" && number["key"] == "damping" && number["std"] == 0.1;
  }
  EXPECT_TRUE(is_stated) << stated["numbers"].dump(1);
  std::vector<std::string> with_sample = alone;
  with_sample.insert(with_sample.end(), {"--sample", "5"});
  EXPECT_EQ(run_pcavr(with_sample).exit_code, 2);
  alone[2] = "sdf";
  EXPECT_EQ(run_pcavr(alone).exit_code, 2);
  EXPECT_EQ(run_pcavr({"export", "--to", "urdf", "-o", path_of("refused")}).exit_code, 2);
  ASSERT_TRUE(write_file(path_of("other.json"), "{}"));
  expect_refused({"export", "--robot", path_of("arm.urdf"), "--identified", path_of("other.json"),
                  "--to", "urdf", "-o", path_of("refused")},
                 "no identification report");
}

TEST_F(ExportCommand, AsksForIdentifiedFrictionAndStatesWhatItAssumes) {
  expect_refused(command("mjcf", "refused", {}), "--assume");
  run_json(command("mjcf", "assumed", {"--assume"}));
  const nlohmann::json numbers = manifest("assumed")["numbers"];
  bool is_assumed = false;
  for (const nlohmann::json& number : numbers) {
    is_assumed |= number["key"] == "sliding_friction_coefficient" && number["origin"] == "assumed";
  }
  EXPECT_TRUE(is_assumed) << numbers.dump(1);
}

TEST_F(ExportCommand, WritesTheRecordedMotionWithItsRunner) {
  std::vector<std::string> words = identified();
  words.insert(words.end(), {"--motion", path_of("recording")});
  run_json(command("mjcf", "moving", words));
  const auto files = contents(path_of("moving"));
  for (const char* file : {"motion.csv", "run.mjs", "run.py"}) EXPECT_TRUE(files.contains(file));
  EXPECT_TRUE(files.at("motion.csv").starts_with("t,x,y,z,qw,qx,qy,qz,vx,vy,vz\n0,"));
}

TEST_F(ExportCommand, DrawsWorldsFromTheParametersDistribution) {
  std::vector<std::string> words = identified();
  words.insert(words.end(), {"--sample", "12", "--seed", "5"});
  EXPECT_EQ(run_json(command("mjcf", "drawn", words))["samples"], 12);
  const auto files = contents(path_of("drawn"));
  std::set<std::string> worlds;
  for (const auto& [file, text] : files) {
    if (file.starts_with("samples/") && file.ends_with("/scene.xml")) worlds.insert(text);
  }
  EXPECT_EQ(worlds.size(), 12U);  // each is another world
  EXPECT_TRUE(files.contains("samples/07/export.json"));
  EXPECT_NE(files.at("samples.csv").find("12,box_1,sliding_friction_coefficient,"),
            std::string::npos);
  run_json(command("mjcf", "mean", identified()));
  EXPECT_EQ(files.at("scene.xml"), contents(path_of("mean")).at("scene.xml"));
  run_json(command("mjcf", "drawn_again", words));
  EXPECT_EQ(files, contents(path_of("drawn_again")));
}

TEST_F(ExportCommand, RefusesBadInput) {
  ASSERT_TRUE(write_file(path_of("other.yaml"),
                         "format: pcavr-parameters/2\nanother_object:\n  mass: 2.0\n"));
  expect_refused(command("mjcf", "refused", {"--parameters", path_of("other.yaml")}),
                 "another_object");
  expect_refused(command("mjcf", "refused", {"--parameters", path_of("absent.yaml")}),
                 "absent.yaml");
  expect_refused({"export", path_of("absent"), "--to", "sdf", "-o", path_of("refused")}, "absent");
  std::filesystem::create_directories(path_of("taken"));
  ASSERT_TRUE(write_file(path_of("taken/notes.txt"), "mine"));
  expect_refused(command("urdf", "taken", identified()), "taken");
  EXPECT_EQ(contents(path_of("taken")).size(), 1U);
  EXPECT_EQ(run_pcavr(command("step", "refused", identified())).exit_code, 2);
}

// Two recordings, at 100 Hz: read by another implementation of Parquet.
TEST_F(ExportCommand, WritesRecordingsAsADataSetForLerobot) {
  const std::vector<std::string> words{
      "export", path_of("recording"), path_of("recording"), "--to", "lerobot", "--fps", "100",
      "-o",     path_of("dataset")};
  const nlohmann::json report = run_json(words);
  EXPECT_EQ(report["episodes"], 2);
  const std::filesystem::path folder = path_of("dataset");
  const nlohmann::json data = read_parquet(folder / "data/chunk-000/file-000.parquet");
  if (data.is_null()) GTEST_SKIP() << kNoParquetReader;
  const nlohmann::json info = nlohmann::json::parse(read_file(folder / "meta/info.json").value());
  EXPECT_EQ(info["codebase_version"], "v3.0");
  EXPECT_EQ(info["fps"], 100);
  EXPECT_EQ(info["total_frames"], report["frames"]);
  ASSERT_EQ(data["rows"].size(), report["frames"].get<std::size_t>());
  EXPECT_EQ(data["row_groups"], 2);
  std::set<std::string> columns, features;
  for (const std::string column : data["columns"]) columns.insert(column);
  for (const auto& [name, feature] : info["features"].items()) features.insert(name);
  EXPECT_EQ(columns, features);
  const std::size_t length = data["rows"].size() / 2;
  const TimedTable tool(path_of("recording/tool.csv"));
  const TimedTable wrench(path_of("recording/wrench.csv"));
  const double start = std::max(tool.rows.front()[0], wrench.rows.front()[0]);
  std::set<std::string> phases;
  for (std::size_t i = 0; i < data["rows"].size(); ++i) {
    const nlohmann::json& row = data["rows"][i];
    const std::size_t frame = i % length;
    ASSERT_EQ(row["index"], std::to_string(i));
    ASSERT_EQ(row["frame_index"], std::to_string(frame));
    ASSERT_EQ(row["episode_index"], std::to_string(i / length));
    ASSERT_EQ(row["task_index"], "0");
    ASSERT_NEAR(row["timestamp"].get<double>(), 0.01 * static_cast<double>(frame), 1e-5);
    const double t = start + 0.01 * static_cast<double>(frame);
    ASSERT_NEAR(row["observation.state"][0].get<double>(), tool.at(t)[1], 1e-6) << t;
    if (frame + 1 < length) {
      ASSERT_EQ(row["action"], data["rows"][i + 1]["observation.state"]);
    }
    const std::vector<double> mean = wrench.mean(t - 0.005, t + 0.005);
    for (std::size_t axis = 0; axis < 6; ++axis)
      ASSERT_NEAR(row["wrench"][axis].get<double>(), mean[axis + 1], 1e-4) << t;
    phases.insert(row["phase"].get<std::string>());
    ASSERT_EQ(row["contact"].get<bool>(), row["phase"] != "0");
  }
  EXPECT_GE(phases.size(), 3U);  // free, static and sliding at least
}

TEST_F(ExportCommand, StatesAFrictionThatIsGivenAndWhenTheBodySlides) {
  std::vector<std::string> words{"export", path_of("recording"), "--to", "lerobot",
                                 "--task", "push it there",      "-o",   path_of("stated_set")};
  const std::vector<std::string> known = identified();
  words.insert(words.end(), known.begin(), known.end());
  run_json(words);
  const std::filesystem::path folder = path_of("stated_set");
  const nlohmann::json data = read_parquet(folder / "data/chunk-000/file-000.parquet");
  if (data.is_null()) GTEST_SKIP() << kNoParquetReader;
  const auto parameters = read_parameters(path_of("parameters.yaml"));
  std::set<std::pair<float, float>> known_mu, mu;
  for (const auto& [name, object] : *parameters) {
    const auto& value = object.sliding_friction_coefficient;
    if (value) known_mu.emplace(static_cast<float>(value->value), static_cast<float>(*value->std));
  }
  const SlidingTruth truth(path_of("recording/truth/phase.csv"));
  const nlohmann::json& rows = data["rows"];
  double agreeing = 0.0;
  for (const nlohmann::json& row : rows) {
    mu.emplace(row["mu"].get<float>(), row["mu_std"].get<float>());
    const bool slides = truth.at(row["timestamp"].get<double>());
    agreeing += (row["phase"] == "3") == slides ? 1.0 : 0.0;
  }
  EXPECT_EQ(mu, known_mu);  // of each of the two boxes
  EXPECT_GT(agreeing / static_cast<double>(rows.size()), 0.95);
  const nlohmann::json tasks = read_parquet(folder / "meta/tasks.parquet");
  EXPECT_EQ(tasks["rows"],
            nlohmann::json::parse(R"([{"task_index": "0", "task": "push it there"}])"));
  EXPECT_EQ(nlohmann::json::parse(tasks["notes"]["pandas"].get<std::string>())["index_columns"],
            nlohmann::json({"task"}));
  const nlohmann::json episodes =
      read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet")["rows"];
  ASSERT_EQ(episodes.size(), 1U);
  EXPECT_EQ(episodes[0]["tasks"], nlohmann::json({"push it there"}));
  EXPECT_EQ(episodes[0]["dataset_to_index"], std::to_string(rows.size()));
  const nlohmann::json stats = nlohmann::json::parse(read_file(folder / "meta/stats.json").value());
  double sum = 0.0, most = -1e9;
  for (const nlohmann::json& row : rows) {
    sum += row["wrench"][0].get<double>();
    most = std::max(most, row["wrench"][0].get<double>());
  }
  EXPECT_NEAR(stats["wrench"]["mean"][0], sum / static_cast<double>(rows.size()), 1e-6);
  EXPECT_NEAR(stats["wrench"]["max"][0], most, 1e-6);
  EXPECT_EQ(episodes[0]["stats/wrench/mean"], stats["wrench"]["mean"]);
}

TEST_F(ExportCommand, RefusesADataSetOfWhatIsNoRecording) {
  const auto dataset = [](const std::string& recording, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"export", path_of(recording), "--to", "lerobot",
                                   "-o",     path_of("refused")};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refused(dataset("scene"), "recording.yaml");
  expect_refused(dataset("absent"), "absent");
  ASSERT_TRUE(write_file(path_of("others.yaml"),
                         "format: pcavr-parameters/2\nanother_object:\n  mass: 2.0\n"));
  expect_refused(dataset("recording", {"--parameters", path_of("others.yaml")}), "another_object");
  EXPECT_EQ(run_pcavr(dataset("recording", {"--fps", "0"})).exit_code, 2);
  EXPECT_EQ(run_pcavr(dataset("recording", {"--assume"})).exit_code, 2);
  EXPECT_EQ(run_pcavr(command("obj", "refused", {"--fps", "30"})).exit_code, 2);
}

TEST_F(ExportCommand, RefusesABodyWhoseMeshCannotBeRead) {
  std::filesystem::copy(path_of("scene"), path_of("open"),
                        std::filesystem::copy_options::recursive);
  for (const auto& entry : std::filesystem::directory_iterator(path_of("open/objects"))) {
    if (entry.path().extension() == ".glb") {
      ASSERT_TRUE(write_file(entry.path(), "no mesh"));
    }
  }
  std::vector<std::string> words = command("mjcf", "refused", identified());
  words[1] = path_of("open");
  expect_refused(words, "objects");
}

}  // namespace
}  // namespace pcavr
