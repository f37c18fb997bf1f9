// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What others' tools say of 3D Tiles. They are 220 MB from npm: nightly.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"

#include "results/export/streamed_tiles.hpp"
#include "support/meshes.hpp"
#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr char kInstallJudges[] =
    "npm install --no-audit --no-fund --no-package-lock 3d-tiles-tools@0.5.4 "
    "gltf-validator@2.0.0-dev.3.10 --prefix '";

TEST(StreamedTilesByOthers, AreReadWithoutErrors) {
  const TemporaryFolder tools;
  const auto run = [](const std::string& command) { return std::system(command.c_str()) == 0; };
  if (!run(kInstallJudges + tools.path().string() + "' > /dev/null 2>&1")) {
    GTEST_SKIP() << "needs npm's 3d-tiles-tools and gltf-validator, which could not be installed";
  }
  const TemporaryFolder folder;
  TriangleMesh scan = test::height_field(
      400, [](float x, float y) { return 0.05F * std::sin(20.0F * x) * std::cos(15.0F * y); });
  compute_vertex_normals(scan);
  scan.colors.assign(scan.vertices.size(), {200, 90, 10});
  const TriangleMesh body = test::box_mesh({0.1F, 0.2F, 0.3F});
  ASSERT_TRUE(detail::write_streamed_tiles(scan, body, 0.0025, folder.path()));
  const std::string report = (tools.path() / "report.json").string();
  const bool is_done =
      run("node '" + (source_folder() / "tests/export/judge_tiles.mjs").string() + "' '" +
          tools.path().string() + "' '" + folder.path().string() + "' > '" + report + "' 2>&1");
  ASSERT_TRUE(is_done) << read_file(report).value();
  const auto judged = nlohmann::json::parse(read_file(report).value());
  EXPECT_EQ(judged["version"], "1.1");
  EXPECT_EQ(judged["children"], 2);
  EXPECT_EQ(judged["tiles"], judged["unpacked"]);
  EXPECT_GT(judged["tiles"], 4);
  EXPECT_TRUE(judged["errors"].empty()) << judged["errors"];
  EXPECT_TRUE(judged["warnings"].empty()) << judged["warnings"];
}

}  // namespace
}  // namespace pcavr
