// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_content.hpp"

#include <cstdlib>
#include <memory>
#include <set>

#include <gtest/gtest.h>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/base/geometry/sharp_edges.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "scene/scene_builder.hpp"
#include "serve/content_text.hpp"
#include "serve/decoded_content.hpp"
#include "serve/packed_mesh.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {
namespace fs = std::filesystem;

constexpr char kOddName[] = "a 'box' #1 50%?";

/// A table, a box, and a box whose name has characters that URLs escape.
Scene a_scene() {
  Scene scene = a_box_on_a_table();
  scene.objects.push_back(an_object(kOddName, {0.2, 0.2, 0.04}));
  return scene;
}

ParameterTable some_parameters() {
  ObjectParameters known;
  known.mass = ParameterValue{2.5, 0.1};
  known.contact_stiffness = ParameterValue{20000.0};
  return {{"box", known}};
}

class SceneContentTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    whole_ = std::make_unique<TemporaryFolder>();
    ASSERT_TRUE(write_scene(a_scene(), whole_->path(), {1}));
    content_ = std::make_unique<SceneContent>(*create(whole_->path()));
  }
  static void TearDownTestSuite() {
    content_.reset();
    whole_.reset();
  }

  static Expected<SceneContent> create(const fs::path& folder, int threads = 2,
                                       const Observer& observer = {}) {
    const auto scene = read_scene_manifest(folder);
    if (!scene) return scene.error();
    return SceneContent::create(*scene, some_parameters(), observer, {threads});
  }

  static inline std::unique_ptr<TemporaryFolder> whole_;
  static inline std::unique_ptr<SceneContent> content_;
};

TEST_F(SceneContentTest, HasAllFieldsThatThePageReads) {
  const nlohmann::json json = json_of(*content_, "/api/scene.json");
  EXPECT_EQ(json["name"], whole_->path().filename().string());
  EXPECT_EQ(json["protocol"], 1);
  EXPECT_EQ(json["up"], nlohmann::json({0, 0, 1}));
  ASSERT_EQ(json["mesh"].size(), 2U);
  EXPECT_EQ(json["mesh"][0]["triangles"], 5000);
  EXPECT_EQ(json["mesh"][1]["triangles"], 50);
  const nlohmann::json& box = json["objects"][0];
  EXPECT_EQ(box["name"], "box");
  EXPECT_EQ(box["path"], "/scene/objects/box.glb");
  EXPECT_NEAR(box["position"][0].get<double>(), 0.6, 1e-9);
  EXPECT_NEAR(box["quaternion"][2].get<double>(), std::sin(0.15), 1e-9);
  EXPECT_EQ(box["mass"], 1.5);
  EXPECT_EQ(box["movable"], true);
  EXPECT_EQ(box["evidence"], "tags_and_shape");
  EXPECT_EQ(box["parameters"],
            nlohmann::json({{"mass", 2.5}, {"mass_std", 0.1}, {"contact_stiffness", 20000.0}}));
  ASSERT_EQ(json["tags"].size(), 2U);
  EXPECT_TRUE(json["tags"][0]["object"].is_null());
  EXPECT_EQ(json["tags"][1]["object"], "box");
  EXPECT_EQ(json["tags"][1]["size"], 0.05);
  EXPECT_EQ(json["support_planes"][0]["outline"].size(), 4U);
  EXPECT_EQ(json["cameras"].size(), 5U);
}

TEST_F(SceneContentTest, HasTheTexturesOfObjects) {
  EXPECT_TRUE(json_of(*content_, "/api/scene.json")["objects"][0]["texture"].is_null());
  Scene scene = a_scene();
  for (SceneObject& object : scene.objects) {
    const TriangleMesh box = with_sharp_edges(object.model.mesh_object);
    object.texture = BodyTexture{
        .jpeg = encode_color(ColorImage(16, object.model.name == "box" ? 16 : 8)).value(),
        .mesh_object = box,
        .coordinates = std::vector<Eigen::Vector2f>(box.vertices.size(), {0.5F, 0.5F}),
        .width = 16,
        .height = 8};
  }
  const TemporaryFolder folder;
  ASSERT_TRUE(write_scene(scene, folder.path(), {1}));
  const Expected<SceneContent> content = create(folder.path());
  ASSERT_TRUE(content) << content.error().to_string();
  const nlohmann::json json = json_of(*content, "/api/scene.json");
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto path = json["objects"][i]["texture"].get<std::string>();
    EXPECT_TRUE(path.starts_with("/scene/objects/") && path.ends_with(".jpg")) << path;
    EXPECT_EQ(body_of(*content, path), scene.objects[i].texture->jpeg);
    const std::string glb = body_of(*content, json["objects"][i]["path"].get<std::string>());
    EXPECT_NE(glb.find("TEXCOORD_0"), std::string::npos);
    EXPECT_EQ(json["objects"][i]["bytes"], glb.size());
  }
}

TEST_F(SceneContentTest, CountsBytesAsThePageReceivesThem) {
  const nlohmann::json json = json_of(*content_, "/api/scene.json");
  std::vector<nlohmann::json> files{json["cloud"], json["occupancy"]};
  for (const char* list : {"mesh", "objects"}) {
    for (const nlohmann::json& file : json[list]) files.push_back(file);
  }
  for (const nlohmann::json& file : files) {
    EXPECT_EQ(body_of(*content_, file["path"].get<std::string>()).size(), file["bytes"]) << file;
  }
}

TEST_F(SceneContentTest, QuantizesTheCloudToWithinHalfAStep) {
  const auto cloud = read_ply(whole_->path() / "cloud.ply");
  ASSERT_TRUE(cloud);
  const std::string body = body_of(*content_, "/scene/cloud.bin");
  ByteReader bytes(bytes_of(body));
  Eigen::Vector3f origin;
  for (float& coordinate : origin) coordinate = bytes.f32();
  const auto step = bytes.f32();
  const auto count = bytes.integer<std::uint32_t>();
  ASSERT_EQ(count, cloud->vertices.size());
  EXPECT_LE(step, 0.001F);
  std::vector<Eigen::Vector3f> points(count);
  for (Eigen::Vector3f& point : points) {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = origin[axis] + step * static_cast<float>(bytes.integer<std::uint16_t>());
    }
  }
  for (const Eigen::Vector3f& point : points) {
    const Rgb8 color{bytes.integer<std::uint8_t>(), bytes.integer<std::uint8_t>(),
                     bytes.integer<std::uint8_t>()};
    // Points are 2 cm apart: the nearest is the corresponding one.
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < cloud->vertices.size(); ++i) {
      const auto distance = [&](std::size_t k) { return (cloud->vertices[k] - point).norm(); };
      if (distance(i) < distance(nearest)) nearest = i;
    }
    const float error = (cloud->vertices[nearest] - point).cwiseAbs().maxCoeff();
    ASSERT_LE(error, 0.5F * step + 1e-6F);  // plus single-precision rounding
    ASSERT_EQ(color, cloud->colors[nearest]);
  }
  EXPECT_TRUE(bytes.is_valid() && bytes.is_at_end());
}

TEST_F(SceneContentTest, HasExactlyTheOccupiedCells) {
  const Scene scene = a_scene();
  const std::string body = body_of(*content_, "/scene/occupancy.bin");
  ByteReader bytes(bytes_of(body));
  Eigen::Vector3f origin;
  for (float& coordinate : origin) coordinate = bytes.f32();
  const auto edge = bytes.f32();
  EXPECT_FLOAT_EQ(edge, static_cast<float>(scene.occupancy.options().resolution));
  const auto count = bytes.integer<std::uint32_t>();
  EXPECT_EQ(count, scene.occupancy.counts().occupied);
  EXPECT_GT(count, 0U);
  std::set<std::array<std::uint16_t, 3>> cells;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::uint16_t, 3> cell{};
    Eigen::Vector3d middle = origin.cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      cell[static_cast<std::size_t>(axis)] = bytes.integer<std::uint16_t>();
      middle[axis] += edge * (cell[static_cast<std::size_t>(axis)] + 0.5);
    }
    EXPECT_EQ(scene.occupancy.at(middle), OccupancyMap::Cell::occupied);
    EXPECT_TRUE(cells.insert(cell).second);
  }
  EXPECT_TRUE(bytes.is_valid() && bytes.is_at_end());
}

TEST_F(SceneContentTest, EscapesNamesInUrls) {
  const nlohmann::json json = json_of(*content_, "/api/scene.json");
  const auto path = json["objects"][1]["path"].get<std::string>();
  EXPECT_EQ(path, "/scene/objects/a%20%27box%27%20%231%2050%25%3F.glb");
  EXPECT_TRUE(has_path(*content_, path));
  EXPECT_TRUE(has_path(*content_, "/scene/objects/a 'box' #1 50%?.glb"));
}

TEST_F(SceneContentTest, ServesNoOtherFileOfTheDisk) {
  for (const char* path :
       {"", "/", "/scene/scene.yaml", "/scene/../scene.yaml", "/scene/objects/../scene.glb",
        "/scene/objects/%2e%2e/scene.glb", "/etc/passwd", "/scene/lod/2.glb", "/scene/lod/-1.glb",
        "scene/lod/0.glb", "/scene/cloud.ply", "%", "/scene/%zz"}) {
    EXPECT_FALSE(has_path(*content_, path)) << path;
  }
}

TEST_F(SceneContentTest, HasTheSameBytesForAnyNumberOfThreads) {
  for (const int threads : {1, 4}) {
    const auto again = create(whole_->path(), threads);
    ASSERT_TRUE(again);
    for (const char* path :
         {"/api/scene.json", "/scene/lod/0.glb", "/scene/lod/1.glb", "/scene/cloud.bin",
          "/scene/occupancy.bin", "/scene/objects/box.glb"}) {
      EXPECT_TRUE(body_of(*again, path) == body_of(*content_, path)) << path;
    }
  }
}

TEST_F(SceneContentTest, CompressesMeshesAndKeepsThemInBase) {
  if (!packed_mesh(*read_file(whole_->path() / "objects/box.glb"), 30.0)) {
    GTEST_SKIP() << "needs gltfpack";
  }
  const std::string level = body_of(*content_, "/scene/lod/0.glb");
  EXPECT_LT(level.size(), fs::file_size(whole_->path() / "scene.glb") / 2);
  const auto text_size = load_value<std::uint32_t>(level.data(), 12);
  const nlohmann::json gltf = nlohmann::json::parse(level.substr(20, text_size));
  EXPECT_EQ(gltf["extensionsRequired"][0], "EXT_meshopt_compression");
  ASSERT_EQ(gltf["meshes"].size(), 1U);
  for (const nlohmann::json& node : gltf["nodes"]) EXPECT_FALSE(node.contains("rotation"));
}

TEST_F(SceneContentTest, ServesUncompressedMeshesWithoutGltfpackAndWarnsOnce) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  std::vector<std::string> lines;
  const Observer observer{.progress = {},
                          .warn = [&](std::string_view line) { lines.emplace_back(line); }};
  const auto content = create(whole_->path(), 2, observer);
  ::setenv("PATH", path.c_str(), 1);
  ASSERT_TRUE(content) << content.error().to_string();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("gltfpack"), std::string::npos) << lines[0];
  EXPECT_EQ(body_of(*content, "/scene/objects/box.glb"),
            *read_file(whole_->path() / "objects/box.glb"));
  EXPECT_TRUE(body_of(*content, "/scene/lod/0.glb").starts_with("glTF"));
}

TEST_F(SceneContentTest, NamesTheMissingOrTruncatedFile) {
  for (const char* file : {"scene.glb", "lod/static_mesh_1.glb", "cloud.ply", "occupancy.bt",
                           "objects/box.glb", "camera_trajectory.txt"}) {
    const TemporaryFolder folder;
    fs::copy(whole_->path(), folder.path(),
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    const std::string whole = *read_file(folder.path() / file);
    ASSERT_TRUE(write_file(folder.path() / file, whole.substr(0, whole.size() - 5)));
    const auto cut = create(folder.path());
    ASSERT_FALSE(cut) << file;
    EXPECT_NE(cut.error().to_string().find(file), std::string::npos) << cut.error().to_string();
    fs::remove(folder.path() / file);
    const auto missing = create(folder.path());
    ASSERT_FALSE(missing) << file;
    EXPECT_NE(missing.error().to_string().find(file), std::string::npos);
    EXPECT_FALSE(missing.error().hint.empty());
  }
}

TEST_F(SceneContentTest, ServesASceneWithoutSurfaces) {
  const TemporaryFolder folder;
  Scene nothing;
  nothing.voxel_size = 0.01;
  ASSERT_TRUE(write_scene(nothing, folder.path(), {1}));
  const auto content = create(folder.path());
  ASSERT_TRUE(content) << content.error().to_string();
  const nlohmann::json json = json_of(*content, "/api/scene.json");
  EXPECT_EQ(json["mesh"], nlohmann::json::array());
  EXPECT_EQ(json["cloud"]["points"], 0);
  EXPECT_EQ(json["occupancy"]["cells"], 0);
  EXPECT_EQ(body_of(*content, "/scene/cloud.bin").size(), 20U);
  EXPECT_FALSE(has_path(*content, "/scene/lod/0.glb"));
}

TEST(PercentEncoding, SurvivesARoundTrip) {
  std::string all;
  for (int byte = 0; byte < 256; ++byte) all += static_cast<char>(byte);
  EXPECT_EQ(percent_decoded(percent_encoded(all)), all);
  EXPECT_EQ(percent_decoded("100%"), "100%");
  EXPECT_EQ(percent_decoded("%4"), "%4");
  EXPECT_EQ(percent_decoded("%+1%-1% 1"), "%+1%-1% 1");
}

}  // namespace
}  // namespace pcavr
