// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/tiles_content.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/serve/scene_content.hpp"

#include "scene/scene_builder.hpp"
#include "serve/decoded_content.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json tile(const std::string& file, const json& children = json::array()) {
  return {{"content", {{"uri", file}}}, {"geometricError", 0}, {"children", children}};
}

json tileset(const json& children) {
  return {{"asset", {{"version", "1.1"}}},
          {"geometricError", 1},
          {"root", {{"geometricError", 1}, {"children", children}}}};
}

/// A folder with a tileset, and with the files "a" and "b" of tiles and the bodies'.
class TilesContentTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_.path() / "tiles");
    for (const char* name : {"a", "b", "bodies"})
      write(std::string("tiles/") + name + ".glb", name);
    write("secret.txt", "secret");
    write("tiles/unnamed.glb", "unnamed");
  }
  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(write_file(folder_.path() / name, text));
  }
  Expected<TilesContent> create(const json& set) {
    write("tileset.json", set.dump());
    return TilesContent::create(folder_.path());
  }
  Expected<TilesContent> of_scan() {
    return create(tileset(json::array(
        {tile("tiles/a.glb", json::array({tile("tiles/b.glb")})), tile("tiles/bodies.glb")})));
  }

  TemporaryFolder folder_;
};

TEST_F(TilesContentTest, ServesTheTilesetsFilesAndNoOthers) {
  const Expected<TilesContent> content = of_scan();
  ASSERT_TRUE(content) << content.error().to_string();
  EXPECT_EQ(content->tiles(), 2U);
  EXPECT_EQ(content->bytes(), 2U);
  const auto found = content->find("/scene/tiles/tiles/b.glb");
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->body, "b");
  EXPECT_EQ((*found)->media_type, "model/gltf-binary");
  for (const char* path : {"/scene/tiles/secret.txt", "/scene/tiles/tiles/unnamed.glb",
                           "/scene/tiles/tiles/bodies.glb", "/scene/tiles/../secret.txt",
                           "/scene/tiles/", "/scene/lod/0.glb", "tiles/a.glb"}) {
    const auto other = content->find(path);
    EXPECT_TRUE(other && !*other) << path;
  }
}

TEST_F(TilesContentTest, LeavesOutTheBodies) {
  const Expected<TilesContent> content = of_scan();
  ASSERT_TRUE(content) << content.error().to_string();
  const json served = json_of(*content, TilesContent::kTilesetPath);
  ASSERT_EQ(served["root"]["children"].size(), 1U);
  EXPECT_EQ(served["root"]["children"][0]["content"]["uri"], "tiles/a.glb");
}

TEST_F(TilesContentTest, NamesATileThatIsGone) {
  const Expected<TilesContent> content = of_scan();
  ASSERT_TRUE(content) << content.error().to_string();
  fs::remove(folder_.path() / "tiles/b.glb");
  const auto gone = content->find("/scene/tiles/tiles/b.glb");
  ASSERT_FALSE(gone);
  EXPECT_NE(gone.error().to_string().find("b.glb"), std::string::npos);
  const auto again = of_scan();
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().file.find("b.glb"), std::string::npos);
}

TEST_F(TilesContentTest, RefusesTilesOutsideItsFolder) {
  for (const char* uri : {"../tiles/a.glb", "/etc/passwd", "tiles/../../a.glb", "https://x/a.glb",
                          "tiles/a.glb?x", ".hidden.glb", "tiles/.a.glb", "tileset.json"}) {
    const auto content = create(tileset(json::array({tile(uri)})));
    ASSERT_FALSE(content) << uri;
    EXPECT_EQ(content.error().place, "content.uri") << uri;
  }
}

TEST_F(TilesContentTest, RefusesWhatIsNoTilesetOfAScan) {
  EXPECT_FALSE(TilesContent::create(folder_.path())) << "no tileset.json";
  EXPECT_FALSE(TilesContent::create(folder_.path() / "absent"));
  json deep = tile("tiles/a.glb");
  for (int i = 0; i < 100; ++i) deep = json::object({{"children", json::array({deep})}});
  const json number = {{"content", {{"uri", 5}}}};
  const std::vector<json> bad_ones{json(3),
                                   json::object(),
                                   json::object({{"asset", 1}, {"root", 2}}),
                                   tileset(json::array({tile("tiles/bodies.glb")})),
                                   tileset(json::array()),
                                   tileset(json::array({number})),
                                   tileset(json::array({3})),
                                   tileset(json::array({deep}))};
  for (const json& bad : bad_ones) {
    const auto content = create(bad);
    ASSERT_FALSE(content) << bad;
    EXPECT_NE(content.error().file.find("tileset.json"), std::string::npos);
    EXPECT_FALSE(content.error().hint.empty()) << bad;
  }
}

TEST_F(TilesContentTest, AreInPlaceOfTheLevelsOfDetail) {
  ASSERT_TRUE(of_scan());
  const TemporaryFolder scene;
  ASSERT_TRUE(write_scene(a_box_on_a_table(), scene.path(), {1}));
  ContentOptions options;
  options.tiles = folder_.path();
  const auto content =
      SceneContent::create(read_scene_manifest(scene.path()).value(), {}, {}, {1}, options);
  ASSERT_TRUE(content) << content.error().to_string();
  const json served = json_of(*content, "/api/scene.json");
  EXPECT_TRUE(served["mesh"].empty());
  EXPECT_EQ(served["tiles"]["path"], TilesContent::kTilesetPath);
  EXPECT_EQ(served["tiles"]["tiles"], 2);
  EXPECT_EQ(served["objects"].size(), 1U);
  const auto found = content->find("/scene/tiles/tiles/a.glb");
  EXPECT_TRUE(found && *found);
}

}  // namespace
}  // namespace pcavr
