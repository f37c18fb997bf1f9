// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "streamed_tiles.hpp"

#include <algorithm>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/mesh_octree.hpp"
#include "pcavr/perception/scene/single_glb.hpp"

namespace pcavr::detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kTilesFolder[] = "tiles";
constexpr char kBodies[] = "bodies";
/// Error of the first level above the scan [voxels]: no more than its noise.
constexpr double kFirstError = 0.5;

std::string tile_file(const std::string& name) {
  return std::string(kTilesFolder) + '/' + name + ".glb";
}

/// Centre and half axes. A flat box gets the least width that viewers can divide by.
Json bounding_volume(const Eigen::AlignedBox3f& box) {
  const Eigen::Vector3d centre = box.center().cast<double>();
  const Eigen::Vector3d half = (0.5 * box.sizes().cast<double>()).cwiseMax(1e-3);
  return {{"box",
           {centre.x(), centre.y(), centre.z(), half.x(), 0.0, 0.0, 0.0, half.y(), 0.0, 0.0, 0.0,
            half.z()}}};
}

Json tile_json(const Eigen::AlignedBox3f& box, double error, const std::string& name) {
  return {{"boundingVolume", bounding_volume(box)},
          {"geometricError", error},
          {"content", {{"uri", tile_file(name)}}}};
}

Json tile_tree(const OctreeTile& node) {
  Json json = tile_json(node.box, node.error, node.name);
  if (node.children.empty()) return json;
  json["children"] = Json::array();
  for (const OctreeTile& child : node.children) json["children"].push_back(tile_tree(child));
  return json;
}

Expected<Json> write_scan(const TriangleMesh& scan, double voxel_size,
                          const std::filesystem::path& folder) {
  OctreeOptions options;
  options.min_edge = 16.0 * voxel_size;
  options.error = kFirstError * voxel_size;
  const auto write = [&](const std::string& name, const TriangleMesh& mesh) -> Expected<void> {
    return write_file(folder / tile_file(name), format_single_glb("scan", mesh, true));
  };
  const Expected<OctreeTile> root = divide_mesh(scan, options, write);
  if (!root) return root.error();
  Json json = tile_tree(*root);
  json["refine"] = "REPLACE";
  return json;
}

}  // namespace

Expected<std::size_t> write_streamed_tiles(const TriangleMesh& scan, const TriangleMesh& bodies,
                                           double voxel_size, const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directory(folder / kTilesFolder, code);
  if (code) return Error{.message = code.message(), .file = (folder / kTilesFolder).string()};
  Json children = Json::array();
  Eigen::AlignedBox3f box;
  if (!scan.triangles.empty()) {
    Expected<Json> written = write_scan(scan, voxel_size, folder);
    if (!written) return written.error();
    children.push_back(*std::move(written));
    box.extend(bounds(scan.vertices));
  }
  if (!bodies.triangles.empty()) {
    const Expected<void> written =
        write_file(folder / tile_file(kBodies), format_single_glb(kBodies, bodies, false));
    if (!written) return written.error();
    const Eigen::AlignedBox3f around = bounds(bodies.vertices);
    children.push_back(tile_json(around, 0.0, kBodies));
    box.extend(around);
  }
  // Not to be drawn at all is as wrong as the scene is large.
  const double size = double{box.sizes().norm()};
  const Json tileset = {{"asset", {{"version", "1.1"}}},
                        {"geometricError", size},
                        {"root",
                         {{"boundingVolume", bounding_volume(box)},
                          {"geometricError", size},
                          {"refine", "ADD"},
                          {"children", children}}}};
  const Expected<void> written = write_file(folder / kTilesetFile, tileset.dump(1) + '\n');
  if (!written) return written.error();
  return scan.triangles.size() + bodies.triangles.size();
}

}  // namespace pcavr::detail
