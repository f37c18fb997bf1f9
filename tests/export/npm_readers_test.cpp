// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What npm's readers of URDF and USD make of exported worlds. They are 30 MB: nightly.
#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/results/export/write_export.hpp"

#include "export/exported_box.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

constexpr char kInstallReaders[] =
    "npm install --no-audit --no-fund --no-package-lock urdf-loader@0.13.1 three@0.187.0 "
    "linkedom@0.18.12 tinyusdz@0.9.0-rc10 --prefix '";

class NpmReaders : public testing::Test {
 protected:
  void SetUp() override {
    const auto run = [](const std::string& command) { return std::system(command.c_str()) == 0; };
    if (!run(kInstallReaders + tools_.path().string() + "' > /dev/null 2>&1")) {
      GTEST_SKIP() << "needs npm's urdf-loader and tinyusdz, which could not be installed";
    }
    auto world = box_.world({{kName, identified_box()}});
    ASSERT_TRUE(world) << world.error().to_string();
    world_ = *std::move(world);
    ASSERT_TRUE(write_urdf(world_, box_.target()));
    ASSERT_TRUE(write_usd(world_, box_.target()));
    const std::string report = (tools_.path() / "report.json").string();
    ASSERT_TRUE(run("node '" + (source_folder() / "tests/export/judge_readers.mjs").string() +
                    "' '" + tools_.path().string() + "' '" + box_.target().string() + "' > '" +
                    report + "' 2>&1"))
        << *read_file(report);
    read_ = nlohmann::json::parse(*read_file(report));
  }
  /// The entry of a list whose member has this value.
  static nlohmann::json entry(const nlohmann::json& list, const char* key,
                              const std::string& value) {
    const auto found = std::find_if(list.begin(), list.end(),
                                    [&](const auto& each) { return each[key] == value; });
    return found == list.end() ? nlohmann::json() : *found;
  }

  const std::string kName = "a box \xC3\xA9t\xC3\xA9";  // linkedom leaves &amp; as it is
  TemporaryFolder tools_;
  ExportedBox box_{kName};
  ExportedWorld world_;
  nlohmann::json read_;
};

TEST_F(NpmReaders, GiveMassesFramesAndMeshesBack) {
  const ExportedBody& body = world_.bodies.front();
  const Eigen::Vector3d& position = body.T_base_object.translation();
  const nlohmann::json link = entry(read_["urdf"]["links"], "name", kName);
  ASSERT_FALSE(link.is_null()) << read_["urdf"].dump(1);
  EXPECT_NEAR(link["mass"], kBoxMass, 1e-6 * kBoxMass);
  EXPECT_NEAR(link["inertia"]["izz"], body.inertia.inertia_object(2, 2), 1e-9);
  const nlohmann::json joint = entry(read_["urdf"]["joints"], "name", "base_to_" + kName);
  ASSERT_FALSE(joint.is_null()) << read_["urdf"].dump(1);
  EXPECT_EQ(joint["type"], "floating");
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(joint["position"][static_cast<std::size_t>(i)], position[i], 1e-6);
  }
  EXPECT_EQ(read_["urdf"]["meshes"].size(), 2U);  // scan and box

  ASSERT_FALSE(read_["usd"].contains("error")) << read_["usd"];
  const nlohmann::json prim = entry(read_["usd"]["prims"], "path", "/World/object_0");
  ASSERT_FALSE(prim.is_null()) << read_["usd"]["prims"].dump(1);
  EXPECT_EQ(prim["name"], kName);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(prim["matrix"][static_cast<std::size_t>(12 + i)], position[i], 1e-6);
  }
  const nlohmann::json mesh = entry(read_["usd"]["meshes"], "path", "/World/object_0/mesh");
  ASSERT_FALSE(mesh.is_null()) << read_["usd"]["meshes"].dump(1);
  EXPECT_EQ(mesh["points"], body.mesh_object.vertices.size());
  EXPECT_EQ(mesh["indices"], 3 * body.mesh_object.triangles.size());
  EXPECT_FALSE(entry(read_["usd"]["meshes"], "path", "/World/scan").is_null());
}

}  // namespace
}  // namespace pcavr
