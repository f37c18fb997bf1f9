// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"

#include "scene/scene_builder.hpp"
#include "support/source_folder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

TEST(GltfValidator, FindsNoErrorInAScene) {
  if (!run("node --version > /dev/null 2>&1") || !run("npm --version > /dev/null 2>&1")) {
    GTEST_SKIP() << "needs node and npm";
  }
  const TemporaryFolder folder;
  const std::string tools = (folder.path() / "tools").string();
  if (!run("mkdir '" + tools +
           "' && npm install --no-audit --no-fund --no-package-lock --prefix '" + tools +
           "' gltf-validator@2.0.0-dev.3.10 > /dev/null 2>&1")) {
    GTEST_SKIP() << "needs npm's gltf-validator, which could not be installed";
  }
  Scene scene = a_box_on_a_table();
  // A name with characters that JSON must escape, and a zero normal.
  scene.objects.push_back(an_object("a \"box\" of \xC3\xA9t\xC3\xA9", {0.2, 0.2, 0.04}));
  scene.levels_of_detail_base[0].normals[0] = Eigen::Vector3f::Zero();
  const std::string bundle = (folder.path() / "bundle").string();
  ASSERT_TRUE(write_scene(scene, bundle, {1}));
  const std::string report = (folder.path() / "report.txt").string();
  const bool is_valid =
      run("node '" + (source_folder() / "tests/scene/validate_gltf.mjs").string() + "' '" + tools +
          "' '" + bundle + "/scene.glb' '" + bundle + "/lod/static_mesh_1.glb' '" + bundle +
          "/objects/box.glb' > '" + report + "' 2>&1");
  EXPECT_TRUE(is_valid) << *read_file(report);
}

}  // namespace
}  // namespace pcavr
