// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_content.hpp"

#include <functional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/serve/scene_arm.hpp"

#include "content_text.hpp"
#include "packed_mesh.hpp"
#include "scene_json.hpp"
#include "scene_points.hpp"

namespace pcavr {
namespace {

constexpr char kTexturePath[] = "/scene/texture.jpg";
constexpr char kObjectsPath[] = "/scene/objects/";

/// One file of a page; independent of the others, so that several are created in parallel.
struct Item {
  std::string path;  ///< not percent-encoded
  std::function<Expected<void>(Item&)> make = {};
  std::shared_ptr<const Content> content = {};
  std::size_t bytes = 0;     ///< before gzip
  std::size_t count = 0;     ///< triangles, points or cells; 0: no file
  double edge = 0.0;         ///< [m] of an occupied cell
  std::string texture = {};  ///< of a level of detail or an object: a JPEG file
  std::optional<Error> error = {};
  std::optional<Error> warning = {};
};

void set_content(Item& item, const char* media_type, std::string body) {
  item.bytes = body.size();
  item.content = std::make_shared<const Content>(make_content(media_type, std::move(body)));
}

void set_mesh(Item& item, std::string glb, const ContentOptions& options) {
  Expected<std::string> packed = packed_mesh(glb, options.packing_timeout);
  if (!packed) item.warning = packed.error();
  set_content(item, kGlbMedia, packed ? std::move(*packed) : std::move(glb));
}

Expected<void> make_level(Item& item, const std::filesystem::path& file,
                          const ContentOptions& options) {
  Expected<NodeGlb> mesh = read_node_glb(file, kStaticMeshNode, "../texture.jpg");
  if (!mesh) return mesh.error();
  item.count = mesh->triangles;
  item.texture = std::move(mesh.value().texture);
  if (item.count > 0) set_mesh(item, std::move(mesh.value().bytes), options);
  return {};
}

/// The page gets no file if there is no node of this name.
Expected<void> make_unseen_support(Item& item, const std::filesystem::path& file,
                                   const ContentOptions& options) {
  Expected<NodeGlb> mesh = read_node_glb(file, kUnseenSupportNode, "texture.jpg");
  if (!mesh) return mesh.error();
  item.count = mesh->triangles;
  if (item.count > 0) set_mesh(item, std::move(mesh.value().bytes), options);
  return {};
}

/// The object with its texture, in the display file's node.
Expected<void> make_textured_object(Item& item, const std::filesystem::path& file,
                                    const std::string& name, const ContentOptions& options) {
  Expected<NodeGlb> mesh = read_node_glb(file, name, "texture.jpg");
  if (!mesh) return mesh.error();
  if (mesh->triangles == 0) {
    return Error{.message = "has no node '" + name + "'",
                 .file = file.string(),
                 .hint = "build the scene again"};
  }
  item.texture = std::move(mesh.value().texture);
  set_mesh(item, std::move(mesh.value().bytes), options);
  return {};
}

Expected<void> make_object(Item& item, const std::filesystem::path& file,
                           const ContentOptions& options) {
  const Expected<GlbContent> checked = read_glb(file);
  if (!checked) return checked.error();
  Expected<std::string> glb = read_file(file);
  if (!glb) return glb.error();
  set_mesh(item, std::move(*glb), options);
  return {};
}

Expected<void> make_cloud(Item& item, const std::filesystem::path& file,
                          const ContentOptions& options) {
  Expected<PageCloud> cloud = page_cloud(file, options);
  if (!cloud) return cloud.error();
  item.count = cloud->points;
  set_content(item, kBinaryMedia, std::move(cloud.value().bytes));
  return {};
}

Expected<void> make_occupancy(Item& item, const std::filesystem::path& file,
                              const ContentOptions& options) {
  Expected<PageOccupancy> occupancy = page_occupancy(file, options);
  if (!occupancy) return occupancy.error();
  item.count = occupancy->cells;
  item.edge = occupancy->edge;
  set_content(item, kBinaryMedia, std::move(occupancy.value().bytes));
  return {};
}

/// Levels of detail that the page gets: none where it gets tiles.
std::size_t level_count(const SceneManifest& scene, const ContentOptions& options) {
  return options.tiles.empty() ? scene.levels_of_detail.size() : 0;
}

/// Levels of detail first, then cloud, occupancy, unseen support, the objects and the arm's links.
std::vector<Item> items_of(const SceneManifest& scene, const ContentOptions& options) {
  std::vector<Item> items;
  const auto add = [&](const std::string& path, const std::filesystem::path& file, auto make) {
    items.push_back({.path = path, .make = [make, options, file = scene.folder / file](Item& item) {
                       return make(item, file, options);
                     }});
  };
  for (std::size_t level = 0; level < level_count(scene, options); ++level) {
    add("/scene/lod/" + std::to_string(level) + ".glb", scene.levels_of_detail[level], make_level);
  }
  add("/scene/cloud.bin", kCloudFile, make_cloud);
  add("/scene/occupancy.bin", kOccupancyFile, make_occupancy);
  add("/scene/unseen_support.glb", kDisplayFile, make_unseen_support);
  for (const SceneObjectEntry& object : scene.objects) {
    const std::string path = kObjectsPath + object.name + ".glb";
    if (object.texture) {
      add(path, kDisplayFile,
          [name = object.name](Item& item, const std::filesystem::path& file,
                               const ContentOptions& of) {
            return make_textured_object(item, file, name, of);
          });
    } else {
      add(path, object.mesh, make_object);
    }
  }
  if (!scene.robot) return items;
  for (std::size_t i = 0; i < scene.robot->links.size(); ++i) {
    add("/scene/" + link_file(i).string(), scene.robot->links[i].mesh, make_object);
  }
  return items;
}

/// All levels have the same texture, an object its own.
std::string texture_path(const Item& item) {
  if (!item.path.starts_with(kObjectsPath)) return kTexturePath;
  return item.path.substr(0, item.path.size() - std::string_view(".glb").size()) + ".jpg";
}

SceneFile scene_file(const Item& item) { return {item.path, item.bytes, item.count}; }

SceneFiles scene_files(const std::vector<Item>& items, const SceneManifest& scene,
                       std::size_t levels) {
  SceneFiles files;
  for (std::size_t i = 0; i < levels; ++i) {
    if (items[i].content) files.mesh.push_back(scene_file(items[i]));
  }
  files.cloud = scene_file(items[levels]);
  files.occupancy = scene_file(items[levels + 1]);
  files.occupancy_edge = items[levels + 1].edge;
  if (items[levels + 2].content) files.unseen_support = scene_file(items[levels + 2]);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    files.objects.push_back(scene_file(items[levels + 3 + i]));
    const std::string path = kObjectsPath + percent_encoded(scene.objects[i].name);
    files.objects.back().path = path + ".glb";
    if (!items[levels + 3 + i].texture.empty()) files.objects.back().texture = path + ".jpg";
  }
  for (std::size_t i = levels + 3 + scene.objects.size(); i < items.size(); ++i) {
    files.links.push_back(scene_file(items[i]));
  }
  return files;
}

/// The first Error, in the items' order. Warns of meshes that are not compressed, once per reason.
Expected<void> check(const std::vector<Item>& items, const Observer& observer) {
  std::set<std::string> reported;
  for (const Item& item : items) {
    if (item.error) return *item.error;
    if (!item.warning) continue;
    const std::string line = item.warning->to_string();
    if (reported.insert(line).second) {
      observer.on_warning("meshes are served without compression: " + line);
    }
  }
  return {};
}

}  // namespace

Expected<SceneContent> SceneContent::create(const SceneManifest& scene,
                                            const std::optional<ParameterTable>& parameters,
                                            const Observer& observer, Parallelism parallelism,
                                            const ContentOptions& options) {
  const Expected<Trajectory> camera = read_trajectory(scene.folder / kTrajectoryFile);
  if (!camera) return camera.error();
  const Expected<std::optional<SceneArm>> arm = read_scene_arm(scene);
  if (!arm) return arm.error();
  SceneContent content;
  if (!options.tiles.empty()) {
    Expected<TilesContent> tiles = TilesContent::create(options.tiles);
    if (!tiles) return tiles.error();
    content.tiles_ = std::move(*tiles);
  }
  std::vector<Item> items = items_of(scene, options);
  parallel_for(parallelism, items.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Expected<void> result = items[i].make(items[i]);
      if (!result) items[i].error = result.error();
    }
  });
  if (const auto checked = check(items, observer); !checked) return checked.error();
  Expected<nlohmann::ordered_json> guards = guards_json(scene);
  if (!guards) return guards.error();
  SceneFiles files = scene_files(items, scene, level_count(scene, options));
  if (content.tiles_) {
    files.tiles = {TilesContent::kTilesetPath, content.tiles_->bytes(), content.tiles_->tiles()};
  }
  nlohmann::ordered_json json = scene_json(scene, files, *arm, parameters, *camera);
  json["guards"] = std::move(*guards);
  const std::string text = json_text(json);
  content.contents_["/api/scene.json"] =
      std::make_shared<const Content>(make_content(kJsonMedia, text));
  for (Item& item : items) {
    const std::string texture = texture_path(item);
    if (!item.texture.empty() && !content.contents_.contains(texture)) {
      content.contents_[texture] =
          std::make_shared<const Content>(make_content(kJpegMedia, std::move(item.texture)));
    }
    if (item.content) content.contents_[item.path] = std::move(item.content);
  }
  return content;
}

Expected<std::shared_ptr<const Content>> SceneContent::find(std::string_view path) const {
  if (tiles_) {
    Expected<std::shared_ptr<const Content>> tile = tiles_->find(path);
    if (!tile || *tile) return tile;
  }
  auto found = contents_.find(path);
  if (found == contents_.end()) found = contents_.find(percent_decoded(path));
  return found == contents_.end() ? nullptr : found->second;
}

}  // namespace pcavr
