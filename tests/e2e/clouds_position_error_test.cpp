// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A recording written out as point clouds and imported again gives the scene that its images give.
#include <gtest/gtest.h>

#include "cloud/recorded_clouds.hpp"
#include "support/json_command.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

using nlohmann::json;

/// The scene's errors against the ground truth; writes SCENE and SCENE-report.
json errors_of(const std::string& recording, const std::string& scene) {
  (void)run_json({"build", recording, "-o", scene});
  return run_json({"evaluate", scene, "--truth", shared_data("tabletop/truth").string(), "-o",
                   scene + "-report"});
}

TEST(CloudsPositionError, TabletopAsOrganisedAndUnorganisedClouds) {
  PCAVR_NEEDS_SHARED_DATA("tabletop/truth/camera.txt");
  const TemporaryFolder folder;
  const std::string root = folder.path().string();
  const std::string source = shared_data("tabletop").string();
  const json images = errors_of(source, root + "/images");
  const Expected<Recording> recording = read_recording(source);
  ASSERT_TRUE(recording);
  for (const bool is_organised : {true, false}) {
    const std::string name = root + (is_organised ? "/organised" : "/unorganised");
    std::filesystem::create_directories(name);
    ASSERT_TRUE(write_clouds(*recording, name, is_organised));
    (void)run_json({"import", name, "--poses", root + "/images/camera_trajectory.txt", "--manifest",
                    source + "/recording.yaml", "-o", name + "-recording"});
    std::filesystem::remove_all(name);
    const json clouds = errors_of(name + "-recording", name + "-scene");
    const double accuracy = images["mesh.accuracy.mean_m"].get<double>();
    expect_within(clouds, "mesh.accuracy.mean_m", 1.1 * accuracy);
    EXPECT_GE(clouds["mesh.completeness_5mm"].get<double>(),
              0.9 * images["mesh.completeness_5mm"].get<double>());
    EXPECT_EQ(clouds["mesh.share_left_behind"].get<double>(), 0.0);
  }
}

}  // namespace
}  // namespace pcavr
