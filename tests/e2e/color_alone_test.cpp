// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Recordings whose poses come from colour alone, or from elsewhere, with the real command.
#include <gtest/gtest.h>

#include "pcavr/recording/recording.hpp"

#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A push of a tagged box in front of a fixed camera, simulated once; each test changes a copy.
class ColourAlone : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "push", "--duration", "4", "--objects", "1", "--frames-per-second", "10",
              "--seed", "12", "--threads", "2", "-o", path_of("simulated")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  void SetUp() override {
    fs::remove_all(path_of("recording"));
    fs::copy(path_of("simulated"), path_of("recording"), fs::copy_options::recursive);
    remove({"depth.txt", "depth", "written.yaml"});
  }

  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  static void remove(const std::vector<std::string>& names) {
    for (const std::string& name : names) fs::remove_all(fs::path(path_of("recording")) / name);
  }
  static json build() {
    return run_json({"build", path_of("recording"), "-o", path_of("scene"), "--force"});
  }
  /// The errors of the tracked poses.
  static json replay() {
    run_json({"replay", path_of("recording"), "--scene", path_of("scene"), "-o", path_of("run"),
              "--force"});
    return run_json({"evaluate", path_of("run"), "--truth", path_of("recording/truth"), "-o",
                     path_of("report"), "--force"});
  }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(ColourAlone, TagsPlaceCameraAndObjects) {
  const json scene = build();
  EXPECT_TRUE(scene["is_fixed_camera"]);
  ASSERT_EQ(scene["objects"].size(), 1U);
  EXPECT_EQ(scene["objects"][0]["evidence"], "tags");
  // There is no surface that frames could lie beside.
  EXPECT_TRUE(scene["surface_distance_median_m"].is_null());
  EXPECT_EQ(scene["mesh_triangles"], 0);
  const json errors = replay();
  expect_within(errors, "object.box_1.tracked.absolute.translation.median_m", 0.001);
  expect_within(errors, "object.box_1.tracked.moving.translation.median_m", 0.0015);
  expect_within(errors, "object.box_1.tracked.absolute.rotation.median_rad", 0.005);
}

TEST_F(ColourAlone, PlacesObjectsByGivenCameraPoses) {
  fs::copy_file(path_of("recording/truth/camera.txt"), path_of("recording/groundtruth.txt"));
  build();
  expect_within(replay(), "object.box_1.tracked.absolute.translation.median_m", 0.002);
}

TEST_F(ColourAlone, InspectSaysSo) {
  const CommandOutcome outcome = run_pcavr({"inspect", path_of("recording")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_NE(outcome.standard_output.find("no depth.txt"), std::string::npos)
      << outcome.standard_output;
  EXPECT_EQ(outcome.standard_output.find("readings"), std::string::npos);
}

/// As TUM RGB-D has it: images, poses, and no manifest.
class ImportedDepth : public ColourAlone {
 protected:
  void SetUp() override {
    ColourAlone::SetUp();
    for (const char* name : {"depth.txt", "depth"}) {
      fs::copy(fs::path(path_of("simulated")) / name, fs::path(path_of("recording")) / name,
               fs::copy_options::recursive);
    }
    // Poses and forces would be taken for the CSV files of a run.
    remove({"recording.yaml", "tool.csv", "wrench.csv"});
  }
  static CommandOutcome import_with(const std::string& depth_scale) {
    const std::string camera = path_of("camera.yaml");
    EXPECT_TRUE(write_file(camera,
                           "name: test\n"
                           "camera: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: "
                           "239.5}\n" +
                               depth_scale));
    return run_pcavr(
        {"import", path_of("recording"), "--camera", camera, "-o", path_of("imported"), "--force"});
  }
  static double imported_scale() {
    return read_recording(path_of("imported")).value().manifest.depth_scale;
  }
};

TEST_F(ImportedDepth, HasTheCameraFilesScale) {
  const CommandOutcome outcome = import_with("depth_scale: 500\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(imported_scale(), 500.0);
  EXPECT_NE(outcome.standard_error.find("--depth-scale 5000"), std::string::npos)
      << outcome.standard_error;
}

TEST_F(ImportedDepth, HasTheUsualScaleWhereTheCameraFileHasNone) {
  const CommandOutcome outcome = import_with("");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(imported_scale(), 5000.0);
  EXPECT_EQ(outcome.standard_error.find("depth_scale"), std::string::npos);
}

TEST_F(ImportedDepth, InspectStatesItsRange) {
  ASSERT_EQ(import_with("").exit_code, 0);
  const CommandOutcome outcome = run_pcavr({"inspect", path_of("imported")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  for (const char* text : {"nearest ", "median ", "farthest "}) {
    EXPECT_NE(outcome.standard_output.find(text), std::string::npos) << outcome.standard_output;
  }
}

}  // namespace
}  // namespace pcavr
