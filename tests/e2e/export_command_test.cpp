// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A simulated scene as a world for engines, with the real command.
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"
#include "support/two_joint_arm.hpp"

namespace pcavr {
namespace {

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
