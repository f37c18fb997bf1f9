// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/build_scene.hpp"

#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

void write_stl(const fs::path& file, const TriangleMesh& mesh) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](const void* bytes, std::size_t size) {
    out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  };
  const std::string title(80, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  const Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  const std::uint16_t attribute = 0;
  put(title.data(), title.size());
  put(&count, sizeof count);
  for (const auto& corners : mesh.triangles) {
    put(normal.data(), 12);
    for (const std::uint32_t v : corners) put(mesh.vertices[v].data(), 12);
    put(&attribute, sizeof attribute);
  }
}

/// A recording without images, of a sphere whose CAD mesh has 300 000 triangles.
class FineCad : public testing::Test {
 protected:
  void SetUp() override {
    full_ = test::sphere_mesh(0.08F, 275);
    write_stl(folder_.path() / "recording/objects/sphere.stl", full_);
    recording_.folder = folder_.path() / "recording";
    recording_.manifest.objects = {{.name = "sphere",
                                    .mesh = "objects/sphere.stl",
                                    .mass = 1.0,
                                    .is_movable = true,
                                    .T_base_object = Pose::from_translation({0.5, 0.0, 0.08})}};
    fs::create_directories(folder_.path() / "scene");
  }

  TemporaryFolder folder_;
  TriangleMesh full_;
  Recording recording_;
};

TEST_F(FineCad, IsSimplifiedForHeadsets) {
  std::string warnings;
  Observer observer;
  observer.warn = [&](std::string_view line) { warnings.append(line).append("\n"); };
  const Expected<Scene> scene = build_scene(recording_, {}, observer);
  ASSERT_TRUE(scene) << scene.error().message;
  const CadModel& sphere = scene->objects[0].model;
  ASSERT_TRUE(sphere.simplification);
  EXPECT_LE(sphere.mesh_object.triangles.size(), 20'000U);
  // The chordal error of 20 000 triangles on this sphere is 0.02 mm.
  EXPECT_LT(sphere.simplification->max_error, 1e-4);
  EXPECT_NE(warnings.find("triangles simplified to"), warnings.npos) << warnings;
  EXPECT_NEAR(sphere.volume, signed_volume(full_), 1e-6 * sphere.volume);
}

TEST_F(FineCad, KeepsItsErrorAndItsFullMassInTheScene) {
  const Scene built = *build_scene(recording_, {});
  ASSERT_TRUE(write_scene(built, folder_.path() / "scene", {1}));
  const CadModel& sphere = built.objects[0].model;
  const Expected<SceneManifest> manifest = read_scene_manifest(folder_.path() / "scene");
  ASSERT_TRUE(manifest) << manifest.error().message;
  const Expected<CadModel> read = read_object_model(*manifest, manifest->objects[0]);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->mesh_object.triangles.size(), sphere.mesh_object.triangles.size());
  ASSERT_TRUE(read->simplification);
  EXPECT_EQ(read->simplification->full_triangles, full_.triangles.size());
  // scene.yaml writes ten digits.
  EXPECT_NEAR(read->simplification->max_error, sphere.simplification->max_error, 1e-12);
  EXPECT_NEAR(read->volume, sphere.volume, 1e-9 * sphere.volume);
  EXPECT_LT((read->centre_of_mass_object - sphere.centre_of_mass_object).norm(), 1e-9);
  const auto checks = *inspect_scene(folder_.path() / "scene");
  bool is_stated = false;
  for (const SceneCheck& check : checks) {
    EXPECT_TRUE(check.is_sound) << check.what << ": " << check.figure;
    is_stated |= check.figure.find("simplified from") != std::string::npos;
  }
  EXPECT_TRUE(is_stated);
}

TEST_F(FineCad, IsNotMentionedWhereTheMeshIsSmall) {
  write_stl(folder_.path() / "recording/objects/sphere.stl", test::sphere_mesh(0.08F, 20));
  const Scene built = *build_scene(recording_, {});
  EXPECT_FALSE(built.objects[0].model.simplification);
  ASSERT_TRUE(write_scene(built, folder_.path() / "scene", {1}));
  std::ifstream file(folder_.path() / "scene/scene.yaml");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(text.find("simplified"), text.npos);
}

}  // namespace
}  // namespace pcavr
