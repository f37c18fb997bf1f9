// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/scene_bundle.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "scene/scene_builder.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {
namespace fs = std::filesystem;

std::map<std::string, std::string> contents_of(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    contents[entry.path().lexically_relative(folder).string()] = *read_file(entry.path());
  }
  return contents;
}

/// A scene on disk that a test may corrupt.
class SceneBundle : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    original_ = std::make_unique<TemporaryFolder>();
    ASSERT_TRUE(write_scene(a_box_on_a_table(), original_->path(), {1}));
  }
  static void TearDownTestSuite() { original_.reset(); }
  void SetUp() override {
    fs::copy(original_->path(), folder_.path(),
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }

  void replace(const std::string& file, const std::string& old_text, const std::string& new_text) {
    std::string text = *read_file(folder_.path() / file);
    const std::size_t at = text.find(old_text);
    ASSERT_NE(at, std::string::npos) << old_text;
    text.replace(at, old_text.size(), new_text);
    ASSERT_TRUE(write_file(folder_.path() / file, text));
  }

  void truncate(const std::string& file) {
    const std::string text = *read_file(folder_.path() / file);
    ASSERT_TRUE(write_file(folder_.path() / file, text.substr(0, text.size() - 5)));
  }

  /// The files that inspect_scene reports as invalid.
  [[nodiscard]] std::vector<std::string> invalid_files() const {
    const auto checks = inspect_scene(folder_.path());
    if (!checks) return {checks.error().to_string()};
    std::vector<std::string> names;
    for (const SceneCheck& check : *checks) {
      if (!check.is_sound) names.push_back(check.what);
    }
    return names;
  }

  const Scene scene_ = a_box_on_a_table();
  const TemporaryFolder folder_;

 private:
  static inline std::unique_ptr<TemporaryFolder> original_;
};

TEST_F(SceneBundle, HasEveryFileOfTheFormat) {
  std::vector<std::string> names;
  for (const auto& [name, content] : contents_of(folder_.path())) names.push_back(name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"camera_trajectory.txt", "cloud.pcd", "cloud.ply",
                                      "lod/static_mesh_1.glb", "mesh.ply", "objects/box.glb",
                                      "occupancy.bt", "preview.png", "scene.glb", "scene.yaml"}));
}

TEST_F(SceneBundle, HasTheSameBytesForAnyNumberOfThreads) {
  const auto once = contents_of(folder_.path());
  for (const int threads : {1, 2, 4}) {
    const TemporaryFolder again;
    ASSERT_TRUE(write_scene(a_box_on_a_table(), again.path(), {threads}));
    EXPECT_TRUE(contents_of(again.path()) == once) << threads;
  }
}

TEST_F(SceneBundle, StoresNoTimes) {
  Scene slower = a_box_on_a_table();
  slower.quality.times = {{"fusion", 100.0, 200.0}};
  const TemporaryFolder again;
  ASSERT_TRUE(write_scene(slower, again.path(), {1}));
  EXPECT_TRUE(contents_of(again.path()) == contents_of(folder_.path()));
}

TEST_F(SceneBundle, ReadsItsManifestBack) {
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_EQ(manifest->folder, folder_.path());
  EXPECT_EQ(manifest->recording, scene_.recording);
  EXPECT_EQ(manifest->voxel_size, scene_.voxel_size);
  EXPECT_FALSE(manifest->is_fixed_camera);
  EXPECT_EQ(manifest->levels_of_detail,
            (std::vector<fs::path>{"scene.glb", "lod/static_mesh_1.glb"}));
  ASSERT_EQ(manifest->objects.size(), 1U);
  const SceneObjectEntry& object = manifest->objects[0];
  const SceneObject& written = scene_.objects[0];
  EXPECT_EQ(object.name, "box");
  EXPECT_EQ(object.mesh, "objects/box.glb");
  EXPECT_EQ(object.evidence, written.evidence);
  EXPECT_EQ(object.mass, written.mass);
  EXPECT_TRUE(object.is_movable);
  EXPECT_EQ(object.position_std, written.position_std);
  EXPECT_EQ(object.rotation_std, written.rotation_std);
  EXPECT_EQ(object.refinement_translation, written.refinement_translation);
  EXPECT_EQ(object.refinement_rotation, written.refinement_rotation);
  // Ten digits are kept.
  EXPECT_LT(translation_distance(object.T_base_object, written.T_base_object), 1e-9);
  EXPECT_LT(rotation_distance(object.T_base_object, written.T_base_object), 1e-8);
  EXPECT_LT(translation_distance(object.T_base_object_start, written.T_base_object_start), 1e-9);
}

TEST_F(SceneBundle, ReadsItsPlanesAndQualityBack) {
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  ASSERT_EQ(manifest->support_planes.size(), 1U);
  EXPECT_EQ(manifest->support_planes[0].outline_base, scene_.support_planes[0].outline_base);
  EXPECT_EQ(manifest->support_planes[0].objects, scene_.support_planes[0].objects);
  EXPECT_EQ(manifest->support_planes[0].plane_base.normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(manifest->quality.frames_dropped, scene_.quality.frames_dropped);
  EXPECT_EQ(manifest->quality.tags_seen, scene_.quality.tags_seen);
  EXPECT_EQ(manifest->quality.frames_used, 5U);
  EXPECT_EQ(manifest->quality.tag_reprojection_rms, 0.21);
}

TEST_F(SceneBundle, StatesItsTexture) {
  EXPECT_FALSE(read_scene_manifest(folder_.path())->texture);
  Scene scene = a_box_on_a_table();
  scene.levels_of_detail_base = {scene.mesh_base};
  const ColorImage image(16, 8);
  SceneTexture& texture = scene.texture.emplace();
  texture.jpeg = encode_color(image).value();
  texture.coordinates = {
      std::vector<Eigen::Vector2f>(scene.mesh_base.vertices.size(), Eigen::Vector2f(0.5F, 0.5F))};
  texture.width = image.width();
  texture.height = image.height();
  texture.texel = 0.0012;
  texture.views = 5;
  texture.seen_fraction = 0.97;
  texture.color_camera = a_small_camera();
  texture.T_color_depth = Pose::from_translation({0.025, 0.001, 0.0});
  texture.vignetting = 0.21;
  const TemporaryFolder written;
  ASSERT_TRUE(write_scene(scene, written.path(), {1}));
  const auto manifest = read_scene_manifest(written.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  ASSERT_TRUE(manifest->texture);
  const SceneTextureEntry& read = *manifest->texture;
  EXPECT_EQ(read.width, 16);
  EXPECT_EQ(read.height, 8);
  EXPECT_EQ(read.texel, texture.texel);
  EXPECT_EQ(read.views, texture.views);
  EXPECT_EQ(read.seen_fraction, texture.seen_fraction);
  EXPECT_EQ(read.color_camera.width, 160);
  EXPECT_EQ(read.color_camera.fx, texture.color_camera.fx);
  EXPECT_EQ(read.color_camera.cy, texture.color_camera.cy);
  EXPECT_EQ(translation_distance(read.T_color_depth, texture.T_color_depth), 0.0);
  EXPECT_EQ(read.vignetting, texture.vignetting);
}

TEST_F(SceneBundle, HasTheTexturesOfItsObjectsInTheDisplayFile) {
  EXPECT_FALSE(read_scene_manifest(folder_.path())->objects.at(0).texture);
  Scene scene = a_box_on_a_table();
  const TriangleMesh box = with_sharp_edges(scene.objects[0].model.mesh_object);
  scene.objects[0].texture =
      BodyTexture{.jpeg = encode_color(ColorImage(16, 8)).value(),
                  .mesh_object = box,
                  .coordinates = std::vector<Eigen::Vector2f>(box.vertices.size(), {0.5F, 0.5F}),
                  .width = 16,
                  .height = 8,
                  .texel = 0.0012,
                  .views = 5,
                  .seen_fraction = 0.61};
  const TemporaryFolder written;
  ASSERT_TRUE(write_scene(scene, written.path(), {1}));
  const auto manifest = read_scene_manifest(written.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  ASSERT_TRUE(manifest->objects.at(0).texture);
  const BodyTextureEntry& read = *manifest->objects[0].texture;
  EXPECT_EQ(read.width, 16);
  EXPECT_EQ(read.height, 8);
  EXPECT_EQ(read.texel, 0.0012);
  EXPECT_EQ(read.views, 5U);
  EXPECT_EQ(read.seen_fraction, 0.61);
  const auto node = read_node_glb(written.path() / "scene.glb", "box", "box.jpg");
  ASSERT_TRUE(node) << node.error().to_string();
  EXPECT_EQ(node->texture, scene.objects[0].texture->jpeg);
  // The CAD file is as without a texture: whoever computes with it gets the same vertices.
  EXPECT_EQ(read_file(written.path() / "objects/box.glb").value(),
            read_file(folder_.path() / "objects/box.glb").value());
}

TEST_F(SceneBundle, StatesWhichWayIsUpWhereTheWorldFrameIsArbitrary) {
  // The world is that of the first camera: the floor is at y = 1, and up is -y.
  Scene scene;
  scene.recording = "a room";
  scene.voxel_size = 0.02;
  const Pose tilted(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitX())),
                    Eigen::Vector3d(0.0, 1.0, 2.0));
  scene.mesh_base = transformed(tilted, a_level_square({0.0, 0.0, 0.0}, 2.0, 20));
  scene.levels_of_detail_base = {scene.mesh_base};
  scene.camera_trajectory = Trajectory({{{0}, Pose()}});
  const auto up_of = [](const Scene& written) {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_scene(written, folder.path(), {1}));
    return read_scene_manifest(folder.path()).value().up_base;
  };
  EXPECT_LT((up_of(scene) + Eigen::Vector3d::UnitY()).norm(), 1e-6);
  // A tag of base makes base a robot's.
  scene.tags = a_box_on_a_table().tags;
  scene.tags.resize(1);
  EXPECT_EQ(up_of(scene), Eigen::Vector3d::UnitZ());
}

TEST_F(SceneBundle, RejectsAnUpThatIsNoDirection) {
  replace("scene.yaml", "voxel_size: 0.02", "voxel_size: 0.02\nup: [0, 0, 2]");
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_FALSE(manifest);
  EXPECT_NE(manifest.error().to_string().find("is not a unit vector"), std::string::npos);
}

TEST_F(SceneBundle, ReadsItsTagsBack) {
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  ASSERT_EQ(manifest->tags.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(manifest->tags[i].id, scene_.tags[i].id);
    EXPECT_EQ(manifest->tags[i].size, scene_.tags[i].size);
    EXPECT_EQ(manifest->tags[i].role, scene_.tags[i].role);
    EXPECT_EQ(manifest->tags[i].object, scene_.tags[i].object);
    EXPECT_LT(
        translation_distance(manifest->tags[i].T_parent_marker, scene_.tags[i].T_parent_marker),
        1e-9);
  }
}

TEST_F(SceneBundle, ReadsAManifestOfAVersionWithoutTags) {
  const std::string text = *read_file(folder_.path() / "scene.yaml");
  const std::size_t at = text.find("tags:\n");
  const std::size_t end = text.find("support_planes:");
  ASSERT_TRUE(write_file(folder_.path() / "scene.yaml", text.substr(0, at) + text.substr(end)));
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_TRUE(manifest->tags.empty());
}

TEST_F(SceneBundle, FindsATagOnAnUnknownObject) {
  replace("scene.yaml", "object: box", "object: fox");
  EXPECT_EQ(invalid_files(), std::vector<std::string>{"scene.yaml"});
}

TEST_F(SceneBundle, UsesThePropertiesOfTheOriginalMeshOfASimplifiedBody) {
  replace("scene.yaml", "movable: true",
          "movable: true\n    simplified_error: 2e-05\n    full_triangles: 5000000\n"
          "    volume: 0.0017\n    centre_of_mass: [0.001, 0, 0]");
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  const Expected<CadModel> box = read_object_model(*manifest, manifest->objects[0]);
  ASSERT_TRUE(box) << box.error().to_string();
  ASSERT_TRUE(box->simplification);
  EXPECT_EQ(box->simplification->max_error, 2e-5);
  EXPECT_EQ(box->simplification->full_triangles, 5'000'000U);
  EXPECT_EQ(box->volume, 0.0017);
  EXPECT_EQ(box->centre_of_mass_object.x(), 0.001);
  EXPECT_TRUE(invalid_files().empty());
}

TEST_F(SceneBundle, RequiresAllKeysOfASimplifiedBody) {
  replace("scene.yaml", "movable: true", "movable: true\n    simplified_error: 2e-05");
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_FALSE(manifest);
  EXPECT_NE(manifest.error().to_string().find("full_triangles"), std::string::npos);
}

TEST_F(SceneBundle, RejectsAnUnknownKeyWithItsLine) {
  replace("scene.yaml", "voxel_size: 0.02", "voxel_size: 0.02\nvoxels: 3");
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_FALSE(manifest);
  EXPECT_NE(manifest.error().to_string().find("scene.yaml:8"), std::string::npos)
      << manifest.error().to_string();
  EXPECT_NE(manifest.error().to_string().find("voxels"), std::string::npos);
}

TEST_F(SceneBundle, RejectsATrajectoryThatIsTruncatedInsideANumber) {
  const fs::path file = folder_.path() / "camera_trajectory.txt";
  const std::string text = *read_file(file);
  // The last row still has eight columns, but another pose.
  ASSERT_TRUE(write_file(file, text.substr(0, text.size() - 3)));
  const SceneManifest manifest = read_scene_manifest(folder_.path()).value();
  const Expected<Trajectory> truncated = read_camera_trajectory(manifest);
  ASSERT_FALSE(truncated.has_value());
  EXPECT_EQ(truncated.error().file, file.string());
  EXPECT_NE(truncated.error().message.find("was truncated"), std::string::npos)
      << truncated.error().to_string();
  // One line missing, the others complete.
  ASSERT_TRUE(write_file(file, text.substr(0, text.rfind('\n', text.size() - 2) + 1)));
  EXPECT_FALSE(read_camera_trajectory(manifest).has_value());
  ASSERT_TRUE(write_file(file, text));
  EXPECT_TRUE(read_camera_trajectory(manifest).has_value());
}

TEST_F(SceneBundle, ReadsASceneOfAVersionWithoutLineCounts) {
  const std::string text = *read_file(folder_.path() / "scene.yaml");
  const std::size_t lines = text.find("lines:");
  ASSERT_NE(lines, text.npos);
  const std::size_t quality = text.find("quality:");
  ASSERT_TRUE(
      write_file(folder_.path() / "scene.yaml", text.substr(0, lines) + text.substr(quality)));
  const SceneManifest manifest = read_scene_manifest(folder_.path()).value();
  EXPECT_FALSE(manifest.lines.has_value());
  EXPECT_TRUE(read_camera_trajectory(manifest).has_value());
  EXPECT_TRUE(invalid_files().empty());
  // Every version writes a final newline.
  const std::string poses = *read_file(folder_.path() / "camera_trajectory.txt");
  ASSERT_TRUE(
      write_file(folder_.path() / "camera_trajectory.txt", poses.substr(0, poses.size() - 3)));
  EXPECT_FALSE(read_camera_trajectory(manifest).has_value());
}

TEST_F(SceneBundle, RejectsAManifestThatIsTruncatedInsideItsLastNumber) {
  const std::string text = *read_file(folder_.path() / "scene.yaml");
  for (std::size_t size = text.size() / 2; size < text.size(); ++size) {
    ASSERT_TRUE(write_file(folder_.path() / "scene.yaml", text.substr(0, size)));
    EXPECT_FALSE(read_scene_manifest(folder_.path()).has_value()) << text.substr(0, size);
  }
}

TEST_F(SceneBundle, StoresTheRowsLeftOutOfTheRecording) {
  Scene scene = a_box_on_a_table();
  scene.quality.left_out = {{"tool.csv", "not a finite number", 300}};
  const TemporaryFolder folder;
  ASSERT_TRUE(write_scene(scene, folder.path(), {1}));
  const SceneManifest manifest = read_scene_manifest(folder.path()).value();
  ASSERT_EQ(manifest.quality.left_out.size(), 1U);
  EXPECT_EQ(manifest.quality.left_out[0].file, "tool.csv");
  EXPECT_EQ(manifest.quality.left_out[0].reason, "not a finite number");
  EXPECT_EQ(manifest.quality.left_out[0].count, 300U);
}

TEST_F(SceneBundle, RejectsAPlaneWithoutArea) {
  const std::string text = *read_file(folder_.path() / "scene.yaml");
  const std::size_t outline = text.find("outline:");
  ASSERT_NE(outline, text.npos);
  const std::size_t end = text.find("\n", text.find("- [", outline));
  // Keep one corner of the outline only.
  std::size_t rest = end + 1;
  while (text.compare(text.find_first_not_of(' ', rest), 3, "- [") == 0) {
    rest = text.find('\n', rest) + 1;
  }
  ASSERT_TRUE(
      write_file(folder_.path() / "scene.yaml", text.substr(0, end + 1) + text.substr(rest)));
  const Expected<SceneManifest> manifest = read_scene_manifest(folder_.path());
  ASSERT_FALSE(manifest.has_value());
  EXPECT_NE(manifest.error().to_string().find("encloses no area"), std::string::npos)
      << manifest.error().to_string();
}

TEST_F(SceneBundle, RejectsAMeshOutsideOfItsFolder) {
  replace("scene.yaml", "mesh: objects/box.glb", "mesh: ../../box.glb");
  EXPECT_FALSE(read_scene_manifest(folder_.path()));
}

TEST_F(SceneBundle, RejectsAnObjectNameWithAPath) {
  replace("scene.yaml", "name: box", "name: ../../box");
  const auto manifest = read_scene_manifest(folder_.path());
  ASSERT_FALSE(manifest);
  EXPECT_NE(manifest.error().to_string().find("../../box"), std::string::npos)
      << manifest.error().to_string();
}

TEST_F(SceneBundle, RejectsANonUnitQuaternion) {
  replace("scene.yaml", "q: [0, 0, 0, 1]", "q: [0, 0, 0, 7]");
  EXPECT_FALSE(read_scene_manifest(folder_.path()));
}

TEST_F(SceneBundle, IsValidAsWritten) {
  EXPECT_EQ(invalid_files(), std::vector<std::string>());
  const auto checks = inspect_scene(folder_.path());
  EXPECT_EQ(checks->size(), 10U);
}

TEST_F(SceneBundle, IsValidWithoutObjectsMeshOrFrames) {
  const TemporaryFolder empty;
  Scene nothing;
  nothing.voxel_size = 0.01;
  ASSERT_TRUE(write_scene(nothing, empty.path(), {1}));
  const auto checks = inspect_scene(empty.path());
  ASSERT_TRUE(checks) << checks.error().to_string();
  for (const SceneCheck& check : *checks) EXPECT_TRUE(check.is_sound) << check.what << check.figure;
}

TEST_F(SceneBundle, NamesAnObjectThatWasNotFoundApartAndDoesNotDrawIt) {
  Scene scene = a_box_on_a_table();
  scene.objects.push_back(an_object("ghost", {0.2, 0.0, 0.04}));
  scene.objects.back().evidence = kNotSeen;
  scene.objects.back().reason = "its tag tag36h11:7 is in no frame";
  scene.tags.push_back({{"tag36h11", 7}, 0.1, MarkerRole::object, "ghost", Pose()});
  const TemporaryFolder other;
  ASSERT_TRUE(write_scene(scene, other.path(), {1}));
  const auto manifest = read_scene_manifest(other.path());
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_EQ(manifest->objects.size(), 1U);
  ASSERT_EQ(manifest->not_found.size(), 1U);
  EXPECT_EQ(manifest->not_found[0].to_string(),
            "ghost is not in the scene: its tag tag36h11:7 is in no frame");
  EXPECT_FALSE(std::filesystem::exists(other.path() / "objects/ghost.glb"));
  EXPECT_EQ(*read_file(other.path() / "scene.glb"), *read_file(folder_.path() / "scene.glb"));
  EXPECT_EQ(*read_file(other.path() / "preview.png"), *read_file(folder_.path() / "preview.png"));
  const auto checks = inspect_scene(other.path());
  ASSERT_TRUE(checks) << checks.error().to_string();
  for (const SceneCheck& check : *checks) EXPECT_TRUE(check.is_sound) << check.what;
  const auto is_of_ghost = [](const SceneCheck& check) { return check.what == "objects: ghost"; };
  EXPECT_EQ(std::count_if(checks->begin(), checks->end(), is_of_ghost), 1);
}

TEST_F(SceneBundle, ReadsAnOlderScenesUnseenObjectAsNotFound) {
  std::string text = *read_file(folder_.path() / "scene.yaml");
  const std::size_t evidence = text.find("evidence: ");
  ASSERT_NE(evidence, std::string::npos);
  text.replace(evidence, text.find('\n', evidence) - evidence, "evidence: not_seen");
  const auto manifest = parse_scene_manifest(text, "scene.yaml");
  ASSERT_TRUE(manifest) << manifest.error().to_string();
  EXPECT_TRUE(manifest->objects.empty());
  ASSERT_EQ(manifest->not_found.size(), 1U);
  EXPECT_EQ(manifest->not_found[0].name, "box");
}

TEST_F(SceneBundle, FindsEachTruncatedFile) {
  for (const char* file : {"scene.glb", "lod/static_mesh_1.glb", "mesh.ply", "cloud.ply",
                           "occupancy.bt", "camera_trajectory.txt", "objects/box.glb"}) {
    const std::string original = *read_file(folder_.path() / file);
    truncate(file);
    EXPECT_EQ(invalid_files(), std::vector<std::string>{file});
    ASSERT_TRUE(write_file(folder_.path() / file, original));
  }
}

TEST_F(SceneBundle, FindsEachMissingFile) {
  for (const auto& [file, content] : contents_of(folder_.path())) {
    if (file == "scene.yaml") continue;
    fs::remove(folder_.path() / file);
    const std::vector<std::string> found = invalid_files();
    EXPECT_NE(std::find(found.begin(), found.end(), file), found.end()) << file;
    ASSERT_TRUE(write_file(folder_.path() / file, content));
  }
}

TEST_F(SceneBundle, FindsAnObjectWithAnotherPoseThanItsNode) {
  replace("scene.yaml", "t: [0.6, 0.05, 0.04]", "t: [0.6, 0.06, 0.04]");
  EXPECT_EQ(invalid_files(), std::vector<std::string>{"scene.glb"});
}

TEST_F(SceneBundle, FindsATrajectoryOfAnotherLength) {
  replace("scene.yaml", "frames_used: 5", "frames_used: 6");
  EXPECT_EQ(invalid_files(), std::vector<std::string>{"camera_trajectory.txt"});
}

TEST_F(SceneBundle, FindsAMapOfAnotherScene) {
  Scene other = a_box_on_a_table();
  other.occupancy = OccupancyMap();
  other.occupancy.integrate(DepthImage(160, 120, 1.0F), {}, a_small_camera(),
                            Pose::from_translation({30.0, 0.0, 0.0}));
  ASSERT_TRUE(other.occupancy.write(folder_.path() / "occupancy.bt"));
  EXPECT_EQ(invalid_files(), std::vector<std::string>{"occupancy.bt"});
}

TEST_F(SceneBundle, HasMeshesThatOtherReadersAccept) {
  const auto mesh = read_mesh(folder_.path() / "mesh.ply");
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  EXPECT_EQ(mesh->triangles.size(), scene_.mesh_base.triangles.size());
  const auto box = read_cad_model(folder_.path() / "objects/box.glb", "box");
  ASSERT_TRUE(box) << box.error().to_string();
  EXPECT_NEAR(box->volume, 0.1 * 0.2 * 0.08, 1e-8);
  EXPECT_LT(box->centre_of_mass_object.norm(), 1e-7);
}

TEST(PlyFile, HasTheHeaderThatReadersExpect) {
  const std::string text = format_ply(a_box_on_a_table().mesh_base);
  EXPECT_EQ(text.substr(0, text.find("end_header")),
            "ply\nformat binary_little_endian 1.0\ncomment coordinates in metres\n"
            "element vertex 2601\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face 5000\nproperty list uchar int vertex_indices\n");
}

TEST(PlyFile, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  for (const TriangleMesh& mesh :
       {a_box_on_a_table().mesh_base, a_box({1, 2, 3}), TriangleMesh()}) {
    ASSERT_TRUE(write_file(folder.path() / "a.ply", format_ply(mesh)));
    const auto again = read_ply(folder.path() / "a.ply");
    ASSERT_TRUE(again) << again.error().to_string();
    EXPECT_EQ(again->vertices, mesh.vertices);
    EXPECT_EQ(again->normals, mesh.normals);
    EXPECT_EQ(again->colors, mesh.colors);
    EXPECT_EQ(again->triangles, mesh.triangles);
  }
}

TEST(PlyFile, RejectsAFaceWithAnIndexOutOfRange) {
  const TemporaryFolder folder;
  TriangleMesh mesh = a_box({1, 1, 1});
  mesh.triangles[3][1] = 8;
  ASSERT_TRUE(write_file(folder.path() / "a.ply", format_ply(mesh)));
  EXPECT_FALSE(read_ply(folder.path() / "a.ply"));
}

TEST(WriteScene, ReportsWhereItCantWrite) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "no folder";
  const auto written = write_scene(a_box_on_a_table(), folder.path() / "file", {1});
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().to_string().find("file"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
